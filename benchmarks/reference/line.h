/* One axis: a spring keeps the side that it has at t = 0. */

typedef struct { int none; } Frames;

static inline void turn(Frames *frames, const double *q) { (void)frames, (void)q; }

static inline void measure(const Model *m, Frames *frames, State *s, int j)
{
    int a = first_body[j], b = second_body[j];
    double side = m->places[j][4];
    (void)frames;
    s->d[j] = m->rest[j] - side * (s->q[b] + m->places[j][2] - s->q[a] - m->places[j][0]);
    s->w[j] = -side * (s->v[b] - s->v[a]);
}

static inline void push(const Model *m, const Frames *frames, const State *s, double *net, int j)
{
    double force = m->places[j][4] * s->f[j];
    (void)frames;
    net[first_body[j]] -= force;
    net[second_body[j]] += force;
}

static inline void measure_t(const Model *m, const Seeds *seeds, const Frames *frames, const State *s, Tangent *t, int j)
{
    int a = first_body[j], b = second_body[j];
    double side = m->places[j][4];
    (void)frames, (void)s;
    for (int c = 0; c < COLUMNS; c++) {
        t->d[j][c] = seeds->rest[j][c] - side * (t->q[b][c] - t->q[a][c]);
        t->w[j][c] = -side * (t->v[b][c] - t->v[a][c]);
    }
}

static inline void push_t(
    const Model *m, const Frames *frames, const State *s, const Tangent *t, double (*net)[COLUMNS], int j)
{
    double side = m->places[j][4];
    (void)frames, (void)s;
    for (int c = 0; c < COLUMNS; c++) {
        net[first_body[j]][c] -= side * t->f[j][c];
        net[second_body[j]][c] += side * t->f[j][c];
    }
}
