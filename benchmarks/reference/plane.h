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

/* Derivatives of n, and of the second point's place against the first. */
#define POINTS_T(c)                                                                                          \
    double ta = t->q[a + 2][c], tb = t->q[b + 2][c];                                                         \
    double dx_t = t->q[b][c] - tb * f->by[j] - t->q[a][c] + ta * f->ay[j];                                   \
    double dy_t = t->q[b + 1][c] + tb * f->bx[j] - t->q[a + 1][c] - ta * f->ax[j];                           \
    double along = nx * dx_t + ny * dy_t;                                                                    \
    double nx_t = face ? -ta * ny : (dx_t - nx * along) * inverse, ny_t = face ? ta * nx : (dy_t - ny * along) * inverse;

static inline void measure_t(const Model *m, const Seeds *seeds, const Frames *f, const State *s, Tangent *t, int j)
{
    int a = 3 * first_body[j], b = 3 * second_body[j], face = is_face[j];
    double nx = f->nx[j], ny = f->ny[j], dx = f->dx[j], dy = f->dy[j], wa = s->v[a + 2], wb = s->v[b + 2];
    double inverse = 1.0 / f->length[j];
    (void)m;
    for (int c = 0; c < COLUMNS; c++) {
        POINTS_T(c)
        double vx_t = t->v[b][c] - t->v[b + 2][c] * f->by[j] - wb * tb * f->bx[j];
        double vy_t = t->v[b + 1][c] + t->v[b + 2][c] * f->bx[j] - wb * tb * f->by[j];
        vx_t -= t->v[a][c] - t->v[a + 2][c] * f->ay[j] - wa * ta * f->ax[j];
        vy_t -= t->v[a + 1][c] + t->v[a + 2][c] * f->ax[j] - wa * ta * f->ay[j];
        double w_t = -(nx_t * f->vx[j] + ny_t * f->vy[j] + nx * vx_t + ny * vy_t), length_t = along;
        if (face) {
            length_t += nx_t * dx + ny_t * dy;
            w_t -= t->v[a + 2][c] * (nx * dy - ny * dx) + wa * (nx_t * dy - ny_t * dx + nx * dy_t - ny * dx_t);
        }
        t->d[j][c] = seeds->rest[j][c] - length_t;
        t->w[j][c] = w_t;
    }
}

static inline void push_t(const Model *m, const Frames *f, const State *s, const Tangent *t, double (*net)[COLUMNS], int j)
{
    int a = 3 * first_body[j], b = 3 * second_body[j], face = is_face[j];
    double nx = f->nx[j], ny = f->ny[j], fx = s->f[j] * nx, fy = s->f[j] * ny, inverse = 1.0 / f->length[j];
    double ax = f->ax[j] + (face ? f->dx[j] : 0.0), ay = f->ay[j] + (face ? f->dy[j] : 0.0);
    (void)m;
    for (int c = 0; c < COLUMNS; c++) {
        POINTS_T(c)
        double fx_t = t->f[j][c] * nx + s->f[j] * nx_t, fy_t = t->f[j][c] * ny + s->f[j] * ny_t;
        double ax_t = -ta * f->ay[j] + (face ? dx_t : 0.0), ay_t = ta * f->ax[j] + (face ? dy_t : 0.0);
        net[a][c] -= fx_t, net[a + 1][c] -= fy_t;
        net[a + 2][c] -= ax_t * fy - ay_t * fx + ax * fy_t - ay * fx_t;
        net[b][c] += fx_t, net[b + 1][c] += fy_t;
        net[b + 2][c] += -tb * f->by[j] * fy - tb * f->bx[j] * fx + f->bx[j] * fy_t - f->by[j] * fx_t;
    }
}
