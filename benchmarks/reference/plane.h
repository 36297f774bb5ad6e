/* Plane motion. A spring pushes along n: from its first point to its second, or along the normal of a face. */

typedef struct {
    double c[MOVING + FIXED], s[MOVING + FIXED];                 /* of the bodies' angles */
    double ax[JOINTS], ay[JOINTS], bx[JOINTS], by[JOINTS];       /* from the centres of mass to the points */
    double dx[JOINTS], dy[JOINTS], length[JOINTS];               /* from the first point to the second, along n */
    double nx[JOINTS], ny[JOINTS], vx[JOINTS], vy[JOINTS];       /* n, and the velocity of the second against the first */
} Frames;

static inline void turn(Frames *frames, const double *q)
{
    for (int body = 0; body < MOVING + FIXED; body++) {
        frames->c[body] = cos(q[3 * body + 2]);
        frames->s[body] = sin(q[3 * body + 2]);
    }
}

static inline void measure(const Model *m, Frames *f, State *s, int j)
{
    int a = first_body[j], b = second_body[j];
    const double *p = m->places[j], *qa = s->q + 3 * a, *qb = s->q + 3 * b, *va = s->v + 3 * a, *vb = s->v + 3 * b;
    double ax = f->c[a] * p[0] - f->s[a] * p[1], ay = f->s[a] * p[0] + f->c[a] * p[1];
    double bx = f->c[b] * p[2] - f->s[b] * p[3], by = f->s[b] * p[2] + f->c[b] * p[3];
    double dx = qb[0] + bx - qa[0] - ax, dy = qb[1] + by - qa[1] - ay;
    double vx = vb[0] - vb[2] * by - va[0] + va[2] * ay, vy = vb[1] + vb[2] * bx - va[1] - va[2] * ax;
    double nx, ny, length, w;
    if (is_face[j]) {
        nx = f->c[a] * p[4] - f->s[a] * p[5], ny = f->s[a] * p[4] + f->c[a] * p[5];
        length = nx * dx + ny * dy;
        w = -(nx * vx + ny * vy) - va[2] * (nx * dy - ny * dx);
    } else {
        double inverse;
        length = sqrt(dx * dx + dy * dy), inverse = 1.0 / length;
        nx = dx * inverse, ny = dy * inverse;
        w = -(nx * vx + ny * vy);
    }
    s->d[j] = m->rest[j] - length;
    s->w[j] = w;
    f->ax[j] = ax, f->ay[j] = ay, f->bx[j] = bx, f->by[j] = by, f->dx[j] = dx, f->dy[j] = dy;
    f->nx[j] = nx, f->ny[j] = ny, f->vx[j] = vx, f->vy[j] = vy, f->length[j] = length;
}

static inline void push(const Model *m, const Frames *f, const State *s, double *net, int j)
{
    double fx = s->f[j] * f->nx[j], fy = s->f[j] * f->ny[j], *a = net + 3 * first_body[j], *b = net + 3 * second_body[j];
    double ax = f->ax[j], ay = f->ay[j];
    (void)m;
    if (is_face[j])
        ax += f->dx[j], ay += f->dy[j];
    a[0] -= fx, a[1] -= fy, a[2] -= ax * fy - ay * fx;
    b[0] += fx, b[1] += fy, b[2] += f->bx[j] * fy - f->by[j] * fx;
}

/* Derivatives of the second point's place against the first, of their distance and of n. Without branches, for vectors: `face` is 0
   or 1. */
#define POINTS_T(c)                                                                                          \
    double ta = t->q[a + 2][c], tb = t->q[b + 2][c];                                                         \
    double dx_t = t->q[b][c] - tb * by - t->q[a][c] + ta * ay;                                               \
    double dy_t = t->q[b + 1][c] + tb * bx - t->q[a + 1][c] - ta * ax;                                       \
    double along = nx * dx_t + ny * dy_t;                                                                    \
    double nx_t = turning * (dx_t - nx * along) - face * ta * ny;                                            \
    double ny_t = turning * (dy_t - ny * along) + face * ta * nx;

static inline void measure_t(const Model *m, const Seeds *seeds, const Frames *f, const State *s, Tangent *t, int j)
{
    int a = 3 * first_body[j], b = 3 * second_body[j];
    double nx = f->nx[j], ny = f->ny[j], vx = f->vx[j], vy = f->vy[j], wa = s->v[a + 2], wb = s->v[b + 2];
    double ax = f->ax[j], ay = f->ay[j], bx = f->bx[j], by = f->by[j], face = is_face[j], turning = (1.0 - face) / f->length[j];
    double dx = face * f->dx[j], dy = face * f->dy[j], turned = nx * dy - ny * dx;
    (void)m;
#pragma omp simd
    for (int c = 0; c < COLUMNS; c++) {
        POINTS_T(c)
        double wa_t = t->v[a + 2][c], wb_t = t->v[b + 2][c];
        double vx_t = t->v[b][c] - wb_t * by - wb * tb * bx - t->v[a][c] + wa_t * ay + wa * ta * ax;
        double vy_t = t->v[b + 1][c] + wb_t * bx - wb * tb * by - t->v[a + 1][c] - wa_t * ax + wa * ta * ay;
        double turned_t = nx_t * dy - ny_t * dx + face * (nx * dy_t - ny * dx_t);
        t->d[j][c] = seeds->rest[j][c] - along - nx_t * dx - ny_t * dy;
        t->w[j][c] = -(nx_t * vx + ny_t * vy + nx * vx_t + ny * vy_t) - wa_t * turned - wa * turned_t;
    }
}

static inline void push_t(const Model *m, const Frames *f, const State *s, const Tangent *t, double (*net)[COLUMNS], int j)
{
    int a = 3 * first_body[j], b = 3 * second_body[j];
    double nx = f->nx[j], ny = f->ny[j], force = s->f[j], fx = force * nx, fy = force * ny;
    double ax = f->ax[j], ay = f->ay[j], bx = f->bx[j], by = f->by[j], face = is_face[j], turning = (1.0 - face) / f->length[j];
    double arm_x = ax + face * f->dx[j], arm_y = ay + face * f->dy[j];
    (void)m;
#pragma omp simd
    for (int c = 0; c < COLUMNS; c++) {
        POINTS_T(c)
        double fx_t = t->f[j][c] * nx + force * nx_t, fy_t = t->f[j][c] * ny + force * ny_t;
        double arm_x_t = face * dx_t - ta * ay, arm_y_t = face * dy_t + ta * ax;
        net[a][c] -= fx_t;
        net[a + 1][c] -= fy_t;
        net[a + 2][c] -= arm_x_t * fy - arm_y_t * fx + arm_x * fy_t - arm_y * fx_t;
        net[b][c] += fx_t;
        net[b + 1][c] += fy_t;
        net[b + 2][c] += bx * fy_t - by * fx_t - tb * (by * fy + bx * fx);
    }
}
