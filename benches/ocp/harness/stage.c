/* The functions of one interval of the program of staged.py; stage.py describes them, and writes above this text

     N, FREE, ROWS       joints, whether T is a state, torques and clearances of a point
     POINTS, ONCE, TWICE Radau's points, the integrals B and A
     JACOBIAN, HESSIAN   numbers of entries, and their rows and columns in jacobian_i, jacobian_j, hessian_i, hessian_j
     LIMITED, KEPT       numbers of rows that are kept among torques and clearances, and of z, listed in limited and kept

   and the functions of the points, value, jacobian and hessian. Matrices are stored by columns. The unit of time of rates and
   accelerations among the unknowns is given; the functions of the points are called with seconds. */

enum { Z = 3 * N, X = 2 * N + FREE, W = X + 3 * N, PATH = LIMITED + KEPT, ALL = X + 3 * PATH };

typedef struct {
    const double *w, *e, *scale, *par;
    double time, share, h;
    /* Of q, v and a in seconds. */
    double units[3];
    double *work;
    INT *integers;
} Given;

static Given given(const double **arg, INT *integers, double *work) {
    double rate = 1 / *arg[6];
    Given g = {arg[0], arg[3], arg[4], arg[5], *arg[1], *arg[2], *arg[1] * *arg[2], {1, rate, rate * rate}, work, integers};
    return g;
}

static int call(int (*function)(const double **, double **, INT *, double *, int), const Given *g, const double *z,
                const double *weights, double *result) {
    double own[Z];
    for (int i = 0; i < Z; i++) own[i] = g->units[i / N] * z[i];
    const double *arg[3 + EXTRA] = {own, g->par, weights};
    double *res[1 + EXTRA] = {result};
    return function(arg, res, g->integers, g->work, 0);
}

static int call_jacobian(const Given *g, const double *z, double *entries) {
    if (call(jacobian, g, z, 0, entries)) return 1;
    for (int k = 0; k < JACOBIAN; k++) entries[k] *= g->units[jacobian_j[k] / N];
    return 0;
}

static int call_hessian(const Given *g, const double *z, const double *weights, double *entries) {
    if (call(hessian, g, z, weights, entries)) return 1;
    for (int k = 0; k < HESSIAN; k++) entries[k] *= g->units[hessian_i[k] / N] * g->units[hessian_j[k] / N];
    return 0;
}

/* Factors of v in q, and of the accelerations in q and v of point j; those of the same by T. */
typedef struct { double v, a[3], b[3], v_time, a_time[3], b_time[3]; } Factors;

static Factors factors(const Given *g, int j) {
    Factors f = {.v = g->h * POINTS[j], .v_time = g->share * POINTS[j]};
    for (int r = 0; r < 3; r++) {
        f.a[r] = g->h * g->h * TWICE[j][r];
        f.b[r] = g->h * ONCE[j][r];
        f.a_time[r] = 2 * g->share * g->h * TWICE[j][r];
        f.b_time[r] = g->share * ONCE[j][r];
    }
    return f;
}

/* z of point j. */
static void motion(const Given *g, const Factors *f, int j, double *z) {
    const double *w = g->w, *a = w + X;
    for (int i = 0; i < N; i++) {
        z[i] = w[i] + f->v * w[N + i] + f->a[0] * a[i] + f->a[1] * a[N + i] + f->a[2] * a[2 * N + i];
        z[N + i] = w[N + i] + f->b[0] * a[i] + f->b[1] * a[N + i] + f->b[2] * a[2 * N + i];
        z[2 * N + i] = a[j * N + i];
    }
}

/* dz/dT, and the second derivative of q by T. */
static void by_time(const Given *g, const Factors *f, double *change, double *bend) {
    const double *w = g->w, *a = w + X;
    for (int i = 0; i < N; i++) {
        double twice = f->a_time[0] * a[i] + f->a_time[1] * a[N + i] + f->a_time[2] * a[2 * N + i];
        change[i] = f->v_time * w[N + i] + twice;
        change[N + i] = f->b_time[0] * a[i] + f->b_time[1] * a[N + i] + f->b_time[2] * a[2 * N + i];
        change[2 * N + i] = 0;
        bend[i] = twice / g->time;
    }
}

/* A gradient by z of point j, added to that by the unknowns. */
static void add_gradient(const Given *g, const Factors *f, int j, const double *by_z, double *result) {
    for (int i = 0; i < N; i++) {
        result[i] += by_z[i];
        result[N + i] += f->v * by_z[i] + by_z[N + i];
        for (int r = 0; r < 3; r++) result[X + r * N + i] += f->a[r] * by_z[i] + f->b[r] * by_z[N + i];
        result[X + j * N + i] += by_z[2 * N + i];
    }
    if (FREE) {
        double change[Z], bend[N];
        by_time(g, f, change, bend);
        for (int i = 0; i < 2 * N; i++) result[2 * N] += change[i] * by_z[i];
    }
}

int cost(const double **arg, double **res, INT *integers, double *work, int memory) {
    Given g = given(arg, integers, work);
    double sum = 0, z[Z], value_of[ROWS];
    for (int j = 0; j < 3; j++) {
        Factors f = factors(&g, j);
        motion(&g, &f, j, z);
        if (call(value, &g, z, 0, value_of)) return 1;
        for (int i = 0; i < N; i++) sum += g.e[j * N + i] * value_of[i] * value_of[i];
    }
    res[0][0] = g.h * sum / 2;
    return 0;
}

int gradient(const double **arg, double **res, INT *integers, double *work, int memory) {
    Given g = given(arg, integers, work);
    double z[Z], value_of[ROWS], entries[JACOBIAN], by_z[Z], *result = res[0];
    for (int i = 0; i < W; i++) result[i] = 0;
    for (int j = 0; j < 3; j++) {
        Factors f = factors(&g, j);
        motion(&g, &f, j, z);
        if (call(value, &g, z, 0, value_of) || call_jacobian(&g, z, entries)) return 1;
        for (int i = 0; i < Z; i++) by_z[i] = 0;
        for (int k = 0; k < JACOBIAN; k++) {
            int i = jacobian_i[k];
            if (i < N) by_z[jacobian_j[k]] += g.h * g.e[j * N + i] * value_of[i] * entries[k];
        }
        add_gradient(&g, &f, j, by_z, result);
        if (FREE)
            for (int i = 0; i < N; i++) result[2 * N] += g.share * g.e[j * N + i] * value_of[i] * value_of[i] / 2;
    }
    return 0;
}

int rows(const double **arg, double **res, INT *integers, double *work, int memory) {
    Given g = given(arg, integers, work);
    double z[Z], value_of[ROWS], *result = res[0];
    for (int j = 0; j < 3; j++) {
        double *path = result + X + j * PATH;
        Factors f = factors(&g, j);
        motion(&g, &f, j, z);
        if (LIMITED && call(value, &g, z, 0, value_of)) return 1;
        for (int i = 0; i < LIMITED; i++) path[i] = g.scale[limited[i]] * value_of[limited[i]];
        for (int i = 0; i < KEPT; i++) path[LIMITED + i] = z[kept[i]];
    }
    /* The last point is the end of the interval. */
    for (int i = 0; i < 2 * N; i++) result[i] = z[i];
    if (FREE) result[2 * N] = g.time;
    return 0;
}

/* Columns by z (count rows, stored by columns) as columns by the unknowns. */
static void by_unknowns(const Given *g, const Factors *f, int j, int count, const double *by_z, double *result) {
    double change[Z], bend[N];
    by_time(g, f, change, bend);
    if (FREE)
        for (int k = 0; k < count; k++) result[2 * N * ALL + k] = 0;
    for (int i = 0; i < N; i++) {
        const double *q = by_z + i * count, *v = q + N * count, *a = v + N * count;
        double *column = result + i * ALL;
        for (int k = 0; k < count; k++) {
            column[k] = q[k];
            column[N * ALL + k] = f->v * q[k] + v[k];
        }
        for (int r = 0; r < 3; r++)
            for (int k = 0; k < count; k++)
                column[(X + r * N) * ALL + k] = f->a[r] * q[k] + f->b[r] * v[k] + (r == j ? a[k] : 0);
        if (FREE)
            for (int k = 0; k < count; k++) result[2 * N * ALL + k] += change[i] * q[k] + change[N + i] * v[k];
    }
}

int jacobian_of_rows(const double **arg, double **res, INT *integers, double *work, int memory) {
    Given g = given(arg, integers, work);
    double z[Z], entries[JACOBIAN], by_z[(PATH + 1) * Z], after[2 * N * Z], *result = res[0];
    int place[ROWS];
    for (int i = 0; i < ROWS; i++) place[i] = -1;
    for (int i = 0; i < LIMITED; i++) place[limited[i]] = i;
    for (int j = 0; j < 3; j++) {
        Factors f = factors(&g, j);
        if (PATH) {
            for (int i = 0; i < PATH * Z; i++) by_z[i] = 0;
            if (LIMITED) {
                motion(&g, &f, j, z);
                if (call_jacobian(&g, z, entries)) return 1;
                for (int k = 0; k < JACOBIAN; k++) {
                    int i = jacobian_i[k];
                    if (place[i] >= 0) by_z[jacobian_j[k] * PATH + place[i]] = g.scale[i] * entries[k];
                }
            }
            for (int i = 0; i < KEPT; i++) by_z[kept[i] * PATH + LIMITED + i] = 1;
            by_unknowns(&g, &f, j, PATH, by_z, result + X + j * PATH);
        }
        if (j == 2) {
            for (int i = 0; i < 2 * N * Z; i++) after[i] = 0;
            for (int i = 0; i < 2 * N; i++) after[i * 2 * N + i] = 1;
            by_unknowns(&g, &f, j, 2 * N, after, result);
        }
    }
    if (FREE)
        for (int i = 0; i < W; i++) result[i * ALL + 2 * N] = i == 2 * N;
    return 0;
}

/* The Hessian by z of one point, what the cost spends included, the gradient, and the derivative by T of what is spent. */
static int second_of_point(const Given *g, int j, const double *z, double weight, const double *lam, const double *nu,
                           double hessian_of[Z][Z], double *first, double *spent) {
    double value_of[ROWS], entries[JACOBIAN], seconds[HESSIAN], weights[ROWS], own[N][Z];
    if (call(value, g, z, 0, value_of) || call_jacobian(g, z, entries)) return 1;
    for (int i = 0; i < ROWS; i++) weights[i] = g->scale[i] * lam[i];
    for (int i = 0; i < N; i++) weights[i] += weight * g->h * g->e[j * N + i] * value_of[i];
    if (call_hessian(g, z, weights, seconds)) return 1;
    for (int i = 0; i < Z; i++) {
        first[i] = nu[i];
        spent[i] = 0;
        for (int k = 0; k < Z; k++) hessian_of[i][k] = 0;
    }
    for (int i = 0; i < N; i++)
        for (int k = 0; k < Z; k++) own[i][k] = 0;
    for (int k = 0; k < JACOBIAN; k++) {
        int i = jacobian_i[k], c = jacobian_j[k];
        first[c] += weights[i] * entries[k];
        if (i < N) {
            own[i][c] = entries[k];
            spent[c] += weight * g->share * g->e[j * N + i] * value_of[i] * entries[k];
        }
    }
    for (int k = 0; k < HESSIAN; k++)
        hessian_of[hessian_i[k]][hessian_j[k]] = hessian_of[hessian_j[k]][hessian_i[k]] = seconds[k];
    for (int i = 0; i < N; i++) {
        double size = weight * g->h * g->e[j * N + i];
        if (size != 0)
            for (int c = 0; c < Z; c++) {
                double factor = size * own[i][c];
                if (factor != 0)
                    for (int k = 0; k < Z; k++) hessian_of[c][k] += factor * own[i][k];
            }
    }
    return 0;
}

int second(const double **arg, double **res, INT *integers, double *work, int memory) {
    Given g = given(arg, integers, work);
    double weight = *arg[7], hessian_of[Z][Z], right[Z][W], z[Z], first[Z], spent[Z], change[Z], bend[N];
    double (*result)[W] = (double (*)[W]) res[0];
    for (int i = 0; i < W; i++)
        for (int k = 0; k < W; k++) result[i][k] = 0;
    for (int j = 0; j < 3; j++) {
        Factors f = factors(&g, j);
        motion(&g, &f, j, z);
        if (second_of_point(&g, j, z, weight, arg[8] + j * ROWS, arg[9] + j * Z, hessian_of, first, spent)) return 1;
        by_time(&g, &f, change, bend);
        for (int i = 0; i < Z; i++) {
            const double *q = hessian_of[i], *v = q + N, *a = v + N;
            double *row = right[i];
            for (int k = 0; k < N; k++) {
                row[k] = q[k];
                row[N + k] = f.v * q[k] + v[k];
            }
            for (int r = 0; r < 3; r++)
                for (int k = 0; k < N; k++) row[X + r * N + k] = f.a[r] * q[k] + f.b[r] * v[k];
            for (int k = 0; k < N; k++) row[X + j * N + k] += a[k];
            if (FREE) {
                row[2 * N] = spent[i];
                for (int k = 0; k < 2 * N; k++) row[2 * N] += q[k] * change[k];
            }
        }
        for (int i = 0; i < N; i++) {
            const double *q = right[i], *v = right[N + i], *a = right[2 * N + i];
            for (int k = 0; k < W; k++) {
                result[i][k] += q[k];
                result[N + i][k] += f.v * q[k] + v[k];
            }
            for (int r = 0; r < 3; r++)
                for (int k = 0; k < W; k++) result[X + r * N + i][k] += f.a[r] * q[k] + f.b[r] * v[k];
            for (int k = 0; k < W; k++) result[X + j * N + i][k] += a[k];
        }
        if (FREE)
            for (int i = 0; i < N; i++) {
                double *corner = &result[2 * N][2 * N];
                *corner += change[i] * (right[i][2 * N] + spent[i]) + bend[i] * first[i];
                *corner += change[N + i] * (right[N + i][2 * N] + spent[N + i]);
                result[N + i][2 * N] += f.v_time * first[i];
                for (int r = 0; r < 3; r++)
                    result[X + r * N + i][2 * N] += f.a_time[r] * first[i] + f.b_time[r] * first[N + i];
            }
    }
    if (FREE)
        for (int k = 0; k < W; k++) result[2 * N][k] = result[k][2 * N];
    return 0;
}
