/* One form of generated C (harness/symbolic.py) as a competitor; compiled together with the generated files.
 *
 *     cc -DFORM=expert_hamiltonian [-DLAGRANGIAN] casadi.c expert_hamiltonian_0.c expert_hamiltonian_1.c ...
 *
 * FORM_0 gives f, FORM_1 f and f_x, FORM_2 f, f_x and the contracted Hessian, dense, column by column. Work vectors are
 * there before anything is timed; arguments are pointers into the packed state. */
#include "peer.h"
#include <stdio.h>
#include <stdlib.h>

#define JOIN2(a, b) a##b
#define JOIN(a, b) JOIN2(a, b)
#define TEXT2(a) #a
#define TEXT(a) TEXT2(a)
#define ORDER0 JOIN(FORM, _0)
#define ORDER1 JOIN(FORM, _1)
#define ORDER2 JOIN(FORM, _2)

typedef int function(const double **arg, double **res, long long int *iw, double *w, int mem);
typedef int sizes(long long int *arg, long long int *res, long long int *iw, long long int *w);

extern function ORDER0;
extern sizes JOIN(ORDER0, _work);
#if ORDERS > 1
extern function ORDER1;
extern sizes JOIN(ORDER1, _work);
#endif
#if ORDERS > 2
extern function ORDER2;
extern sizes JOIN(ORDER2, _work);
#endif

#ifdef LAGRANGIAN
enum { SECOND = 1, WIDTH = 3, HEIGHT = 1 }; /* second argument v; derivatives in (q, v, u), one f a joint */
#define NAMES {"a:" TEXT(FORM), "a_z:" TEXT(FORM), "y_a_zz:" TEXT(FORM)}
#else
enum { SECOND = 2, WIDTH = 2, HEIGHT = 2 }; /* second argument p; derivatives in (q, p), two f a joint */
#define NAMES {"F:" TEXT(FORM), "F_x:" TEXT(FORM), "y_F_xx:" TEXT(FORM)}
#endif

static struct { int n; const double **arg; double **res; long long int *iw; double *w; double *out[3]; } c;

static void point(const double *state) {
    c.arg[0] = state;
    c.arg[1] = state + SECOND * c.n;
    c.arg[2] = state + 3 * c.n;
    c.arg[3] = state + 5 * c.n;
    for (int i = 0; i < 3; i++) c.res[i] = c.out[i];
}

static void run0(void *unused, const double *state) {
    (void)unused;
    point(state);
    ORDER0(c.arg, c.res, c.iw, c.w, 0);
}

static void values0(void *unused, double *out) {
    (void)unused;
    for (int i = 0; i < HEIGHT * c.n; i++) out[i] = c.out[0][i];
}

#if ORDERS > 1
static void by_rows(const double *columns, double *out, int rows, int width) {
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < width; j++) out[i * width + j] = columns[j * rows + i];
}

static void run1(void *unused, const double *state) {
    (void)unused;
    point(state);
    ORDER1(c.arg, c.res, c.iw, c.w, 0);
}

static void values1(void *unused, double *out) {
    (void)unused;
    by_rows(c.out[1], out, HEIGHT * c.n, WIDTH * c.n);
}
#endif

#if ORDERS > 2
static void run2(void *unused, const double *state) {
    (void)unused;
    point(state);
    ORDER2(c.arg, c.res, c.iw, c.w, 0);
}

static void values2(void *unused, double *out) {
    (void)unused;
    by_rows(c.out[2], out, WIDTH * c.n, WIDTH * c.n);
}
#endif

static void *zeros(long long int count, size_t size) {
    void *memory = calloc((size_t)count + 8, size);
    if (!memory) {
        fprintf(stderr, "casadi: out of memory\n");
        exit(1);
    }
    return memory;
}

const struct peer *peer_open(const char *file, int n) {
    (void)file;
    static struct quantity quantities[ORDERS];
    static const char *const names[3] = NAMES;
    long long int most[4] = {4, 3, 0, 0};
    sizes *const work[] = {JOIN(ORDER0, _work),
#if ORDERS > 1
                           JOIN(ORDER1, _work),
#endif
#if ORDERS > 2
                           JOIN(ORDER2, _work),
#endif
    };
    for (int k = 0; k < ORDERS; k++) {
        long long int needs[4];
        work[k](&needs[0], &needs[1], &needs[2], &needs[3]);
        for (int i = 0; i < 4; i++)
            if (needs[i] > most[i]) most[i] = needs[i];
    }
    c.n = n;
    c.arg = zeros(most[0], sizeof *c.arg);
    c.res = zeros(most[1], sizeof *c.res);
    c.iw = zeros(most[2], sizeof *c.iw);
    c.w = zeros(most[3], sizeof *c.w);
    for (int k = 0; k < 3; k++) c.out[k] = zeros(9LL * n * n, sizeof *c.out[k]);
    quantities[0] = (struct quantity){names[0], HEIGHT * n, run0, values0};
#if ORDERS > 1
    quantities[1] = (struct quantity){names[1], HEIGHT * WIDTH * n * n, run1, values1};
#endif
#if ORDERS > 2
    quantities[2] = (struct quantity){names[2], WIDTH * WIDTH * n * n, run2, values2};
#endif
    static struct peer result;
    result = (struct peer){NULL, ORDERS, quantities};
    return &result;
}
