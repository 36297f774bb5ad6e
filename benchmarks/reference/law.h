/* The law: elastic up to a crush force, a plateau, densification; its own slope for unloading and reloading.

   F = (c0 + c1 d)(1 + side a ddot), where a branch gives c0 and c1, and side (1 where it pushes, -1 where it pulls), and holds for
   low < d < high; rates stay below 1 / a. A joint with an unloading slope also changes its branch when it turns around while it
   is loaded. */

typedef struct {
    double c0, c1, side, low, high, d_max;
    int loading;                 /* the rate must stay positive: at its zero the largest deformation is remembered */
    double c0_t[COLUMNS], c1_t[COLUMNS], d_max_t[COLUMNS];
} Branch;

/* The loading curve at a deformation. */
static inline void load(Branch *b, const double *p, const double (*p_t)[COLUMNS], double d)
{
    double alpha = p[STIFFNESS], delta = p[CRUSH_FORCE], gap = p[CLEARANCE], knee = delta / alpha;
    int buckled = p[DENSIFICATION] > knee;
    double end = buckled ? p[DENSIFICATION] : knee, x = d - gap;
    b->side = x >= 0.0 ? 1.0 : -1.0;
    if (x >= end) {
        double beta = p[DENSE_STIFFNESS];
        b->c0 = delta - beta * (gap + end), b->c1 = beta, b->low = gap + end, b->high = INFINITY;
        for (int c = 0; c < COLUMNS; c++) {
            double knee_t = (p_t[CRUSH_FORCE][c] - knee * p_t[STIFFNESS][c]) / alpha;
            double end_t = buckled ? p_t[DENSIFICATION][c] : knee_t;
            b->c0_t[c] = p_t[CRUSH_FORCE][c] - p_t[DENSE_STIFFNESS][c] * (gap + end) - beta * (p_t[CLEARANCE][c] + end_t);
            b->c1_t[c] = p_t[DENSE_STIFFNESS][c];
        }
    } else if (x >= knee) {
        b->c0 = delta, b->c1 = 0.0, b->low = gap + knee, b->high = gap + end;
        for (int c = 0; c < COLUMNS; c++)
            b->c0_t[c] = p_t[CRUSH_FORCE][c], b->c1_t[c] = 0.0;
    } else if (x >= 0.0 || p[TENSION] != 0.0) {
        b->c0 = -alpha * gap, b->c1 = alpha, b->low = x >= 0.0 ? gap : -INFINITY, b->high = x >= 0.0 ? gap + knee : gap;
        for (int c = 0; c < COLUMNS; c++) {
            b->c0_t[c] = -p_t[STIFFNESS][c] * gap - alpha * p_t[CLEARANCE][c];
            b->c1_t[c] = p_t[STIFFNESS][c];
        }
    } else {
        b->c0 = 0.0, b->c1 = 0.0, b->low = -INFINITY, b->high = gap;
        for (int c = 0; c < COLUMNS; c++)
            b->c0_t[c] = b->c1_t[c] = 0.0;
    }
}

/* The unloading line from the largest deformation; slack where it ends. */
static inline void unload(Branch *b, const double *p, const double (*p_t)[COLUMNS], double d)
{
    double k = p[UNLOADING], top, slack;
    load(b, p, p_t, b->d_max);
    top = b->c0 + b->c1 * b->d_max;
    if (top <= 0.0)              /* never crushed beyond its clearance: the elastic line, which is negative there */
        top = p[STIFFNESS] * (b->d_max - p[CLEARANCE]);
    slack = b->d_max - top / k;
    b->side = d >= slack ? 1.0 : -1.0;
    b->low = d >= slack ? slack : -INFINITY, b->high = d >= slack ? b->d_max : fmin(slack, b->d_max);
    if (d >= slack || p[TENSION] != 0.0) {
        for (int c = 0; c < COLUMNS; c++) {
            double top_t = b->c0_t[c] + b->c1_t[c] * b->d_max + b->c1 * b->d_max_t[c];
            b->c0_t[c] = top_t - p_t[UNLOADING][c] * b->d_max - k * b->d_max_t[c];
            b->c1_t[c] = p_t[UNLOADING][c];
        }
        b->c0 = top - k * b->d_max, b->c1 = k;
    } else {
        b->c0 = 0.0, b->c1 = 0.0;
        for (int c = 0; c < COLUMNS; c++)
            b->c0_t[c] = b->c1_t[c] = 0.0;
    }
}

static inline void choose(Branch *b, const double *p, const double (*p_t)[COLUMNS], double d, int loading)
{
    b->loading = loading && p[UNLOADING] > 0.0;
    if (loading || p[UNLOADING] == 0.0)
        load(b, p, p_t, d);
    else
        unload(b, p, p_t, d);
    if (b->loading)
        b->low = -INFINITY;
}

/* How far a branch is from one of its ends, negative beyond it. */
enum { LOW, HIGH, TURN, ENDS };

static inline double guard(const Branch *b, int end, double d, double w)
{
    return end == LOW ? d - b->low : end == HIGH ? b->high - d : b->loading ? w : INFINITY;
}
