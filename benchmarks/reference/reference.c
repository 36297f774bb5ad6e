/* The classical Runge-Kutta rule of fourth order, by plain steps or by steps that keep to their branches and land on crossings,
   with forward sensitivities. Everything is of a size that the compiler knows, and nothing is allocated. */
#include "model.h"
#include "law.h"
#if AXES == 1
#include "line.h"
#else
#include "plane.h"
#endif

typedef struct {
    const Model *m;
    const Seeds *seeds;
    Branch branch[JOINTS];
    State stage[5];              /* of a step: its start, three inner stages, its end */
    Tangent stage_t[4];
    long steps, trials;
    int live;                    /* branches are chosen at every stage */
} Run;

static void accelerate(Run *r, State *s)
{
    const Model *m = r->m;
    double net[ALL] = {0};
    Frames frames;
    turn(&frames, s->q);
    for (int j = 0; j < JOINTS; j++) {
        Branch *b = &r->branch[j];
        measure(m, &frames, s, j);
        if (r->live)
            choose(b, m->p[j], r->seeds->p[j], s->d[j], s->d[j] >= b->d_max);
        s->f[j] = (b->c0 + b->c1 * s->d[j]) * (1.0 + b->side * m->p[j][RATE] * s->w[j]);
        push(m, &frames, s, net, j);
    }
    for (int i = 0; i < N; i++)
        s->a[i] = m->inverse_mass[i] * net[i];
}

static void accelerate_t(Run *r, State *s, Tangent *t)
{
    const Model *m = r->m;
    double net[ALL] = {0}, net_t[ALL][COLUMNS];
    Frames frames;
    memset(net_t, 0, sizeof net_t);
    turn(&frames, s->q);
    for (int j = 0; j < JOINTS; j++) {
        Branch *b = &r->branch[j];
        double d, w, rate = m->p[j][RATE], factor, line;
        measure(m, &frames, s, j);
        measure_t(m, r->seeds, &frames, s, t, j);
        d = s->d[j], w = s->w[j];
        if (r->live)
            choose(b, m->p[j], r->seeds->p[j], d, d >= b->d_max);
        factor = 1.0 + b->side * rate * w, line = b->c0 + b->c1 * d;
        for (int c = 0; c < COLUMNS; c++) {
            double line_t = b->c0_t[c] + b->c1_t[c] * d + b->c1 * t->d[j][c];
            t->f[j][c] = line_t * factor + line * b->side * (r->seeds->p[j][RATE][c] * w + rate * t->w[j][c]);
        }
        push(m, &frames, s, net, j);
        push_t(m, &frames, s, t, net_t, j);
    }
    for (int i = 0; i < N; i++)
        for (int c = 0; c < COLUMNS; c++)
            t->a[i][c] = m->inverse_mass[i] * net_t[i][c] + r->seeds->inverse_mass[i][c] * net[i];
}

static void step(Run *r, double h)
{
    State *s = r->stage;
    const double part[] = {0.0, 0.5 * h, 0.5 * h, h};
    for (int k = 1; k < 4; k++) {
        for (int i = 0; i < N; i++) {
            s[k].q[i] = s[0].q[i] + part[k] * s[k - 1].v[i];
            s[k].v[i] = s[0].v[i] + part[k] * s[k - 1].a[i];
        }
        accelerate(r, &s[k]);
    }
    for (int i = 0; i < N; i++) {
        s[4].q[i] = s[0].q[i] + h / 6.0 * (s[0].v[i] + 2.0 * (s[1].v[i] + s[2].v[i]) + s[3].v[i]);
        s[4].v[i] = s[0].v[i] + h / 6.0 * (s[0].a[i] + 2.0 * (s[1].a[i] + s[2].a[i]) + s[3].a[i]);
    }
    accelerate(r, &s[4]);
    r->trials++;
}

static void step_t(Run *r, double h)
{
    Tangent *t = r->stage_t;
    const double part[] = {0.0, 0.5 * h, 0.5 * h, h};
    for (int k = 1; k < 4; k++) {
        for (int i = 0; i < N; i++)
            for (int c = 0; c < COLUMNS; c++) {
                t[k].q[i][c] = t[0].q[i][c] + part[k] * t[k - 1].v[i][c];
                t[k].v[i][c] = t[0].v[i][c] + part[k] * t[k - 1].a[i][c];
            }
        accelerate_t(r, &r->stage[k], &t[k]);
    }
    for (int i = 0; i < N; i++)
        for (int c = 0; c < COLUMNS; c++) {
            t[0].q[i][c] += h / 6.0 * (t[0].v[i][c] + 2.0 * (t[1].v[i][c] + t[2].v[i][c]) + t[3].v[i][c]);
            t[0].v[i][c] += h / 6.0 * (t[0].a[i][c] + 2.0 * (t[1].a[i][c] + t[2].a[i][c]) + t[3].a[i][c]);
        }
}

/* The crossing that a straight line through the guards puts first: its joint, or -1, and the end of its branch. */
static int first_crossing(const Run *r, int *end)
{
    const State *s = &r->stage[0], *e = &r->stage[4];
    int first = -1;
    double least = 2.0;
    for (int j = 0; j < JOINTS; j++)
        for (int k = LOW; k < ENDS; k++) {
            double after = guard(&r->branch[j], k, e->d[j], e->w[j]);
            if (after < -LANDED) {
                double before = fmax(0.0, guard(&r->branch[j], k, s->d[j], s->w[j]));
                if (before / (before - after) < least)
                    first = j, *end = k, least = before / (before - after);
            }
        }
    return first;
}

/* Shorten a step to a crossing, by secants. */
static double land(Run *r, int j, int k, double high)
{
    const Branch *b = &r->branch[j];
    const State *s = &r->stage[0], *e = &r->stage[4];
    double low = 0.0, h0 = 0.0, h1 = high, g0 = guard(b, k, s->d[j], s->w[j]), g1 = guard(b, k, e->d[j], e->w[j]);
    if (g0 <= 0.0) {                     /* crossed together with another joint, where this step begins */
        step(r, 0.0);
        return 0.0;
    }
    while (high - low > SHORTEST && fabs(g1) > LANDED) {
        double h = h1 - g1 * (h1 - h0) / (g1 - g0);
        if (!(low < h && h < high))
            h = 0.5 * (low + high);
        step(r, h);
        h0 = h1, g0 = g1, h1 = h, g1 = guard(b, k, e->d[j], e->w[j]);
        if (g1 > 0.0) low = h; else high = h;
    }
    return h1;
}

/* Take the branch beyond the end of the present one. */
static void cross(Run *r, int j, int end)
{
    Branch *b = &r->branch[j];
    double d = r->stage[0].d[j], beyond = d + (end == HIGH ? BEYOND : end == LOW ? -BEYOND : 0.0);
    if (end == TURN) {
        b->d_max = d;
        for (int c = 0; c < COLUMNS; c++)
            b->d_max_t[c] = r->stage_t[0].d[j][c];
    }
    choose(b, r->m->p[j], r->seeds->p[j], beyond, end != TURN && (b->loading || beyond >= b->d_max));
}

static void begin(Run *r)
{
    const Model *m = r->m;
    memset(r->stage_t, 0, sizeof r->stage_t);
    for (int k = 0; k < 5; k++) {
        memcpy(r->stage[k].q, m->start[0], sizeof m->start[0]);
        memcpy(r->stage[k].v, m->start[1], sizeof m->start[1]);
    }
    memcpy(r->stage_t[0].q, r->seeds->start[0], sizeof r->seeds->start[0]);
    memcpy(r->stage_t[0].v, r->seeds->start[1], sizeof r->seeds->start[1]);
    accelerate(r, r->stage);
    accelerate_t(r, r->stage, r->stage_t);
    for (int j = 0; j < JOINTS; j++) {
        double d = r->stage[0].d[j];
        Branch *b = &r->branch[j];
        b->d_max = fmax(0.0, d);
        for (int c = 0; c < COLUMNS; c++)
            b->d_max_t[c] = d > 0.0 ? r->stage_t[0].d[j][c] : 0.0;
        choose(b, m->p[j], r->seeds->p[j], d, d >= b->d_max && r->stage[0].w[j] > 0.0);
    }
    accelerate(r, r->stage);
}

/* Plain steps: the largest deformations are those at the ends of steps. */
static void remember(Run *r)
{
    for (int j = 0; j < JOINTS; j++) {
        Branch *b = &r->branch[j];
        if (r->stage[0].d[j] > b->d_max) {
            b->d_max = r->stage[0].d[j];
            for (int c = 0; c < COLUMNS; c++)
                b->d_max_t[c] = r->stage_t[0].d[j][c];
        }
    }
}

static void record(const Run *r, double *values, double *tangents)
{
    const State *s = r->stage;
    const Tangent *t = r->stage_t;
    memcpy(values, s->q, N * sizeof(double));
    memcpy(values + N, s->v, N * sizeof(double));
    memcpy(values + 2 * N, s->a, N * sizeof(double));
    memcpy(values + 3 * N, s->f, JOINTS * sizeof(double));
    if (COLUMNS) {
        memcpy(tangents, t->q, N * sizeof t->q[0]);
        memcpy(tangents + N * COLUMNS, t->v, N * sizeof t->v[0]);
        memcpy(tangents + 2 * N * COLUMNS, t->a, N * sizeof t->a[0]);
        memcpy(tangents + 3 * N * COLUMNS, t->f, JOINTS * sizeof t->f[0]);
    }
}

/* From t = 0 through `count` times; writes positions, velocities, accelerations and forces there, and their derivatives.
   Returns the number of steps, with those that were tried in `trials`, or -1 where it does not get on. */
long integrate(const Model *m, const Seeds *seeds, int plain, const double *times, long count, double longest,
               double *values, double *tangents, long *trials)
{
    Run run = {.m = m, .seeds = seeds, .live = plain}, *r = &run;
    const long width = 3 * N + JOINTS;
    double t = 0.0;
    begin(r);
    for (long k = 0; r->steps < 100000000; r->steps++) {
        double left, h;
        int j, end, crossed = -1, crossed_end = LOW;
        if (COLUMNS)
            accelerate_t(r, r->stage, r->stage_t);
        if (plain)
            remember(r);
        if (times[k] - t <= 1e-12 * longest) {
            t = times[k];
            record(r, values + k * width, tangents + k * width * COLUMNS);
            if (++k == count) {
                *trials = r->trials;
                return r->steps;
            }
        }
        left = times[k] - t;
        h = left / fmax(1.0, ceil(left / longest - 1e-6));
        step(r, h);
        while (!plain && (j = first_crossing(r, &end)) >= 0)
            h = land(r, crossed = j, crossed_end = end, h);
        if (COLUMNS)
            step_t(r, h);
        r->stage[0] = r->stage[4];
        t += h;
        if (crossed >= 0) {
            if (COLUMNS)
                accelerate_t(r, r->stage, r->stage_t);
            cross(r, crossed, crossed_end);
        }
    }
    return -1;
}

/* Many runs, of which only the end is kept. */
long integrate_many(const Model *models, long runs, const Seeds *seeds, int plain, double end, double longest, double *values)
{
    long trials, steps = 0;
    for (long i = 0; i < runs; i++)
        steps += integrate(&models[i], seeds, plain, &end, 1, longest, values + i * (3 * N + JOINTS), 0, &trials);
    return steps;
}
