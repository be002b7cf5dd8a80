/* C written by `costate codegen` as a competitor; compiled together with the generated files.
 *
 *     cc -DPREFIX=ur5_hamiltonian [-DLAGRANGIAN] -DORDERS=3 generated.c hamiltonian_f.c ...
 *
 * PREFIX_f gives f, PREFIX_f_x f and f_x, PREFIX_y_f_xx all, row by row. */
#include "peer.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define JOIN2(a, b) a##b
#define JOIN(a, b) JOIN2(a, b)

#ifdef LAGRANGIAN
#define NAMES {"a:codegen", "a_z:codegen", "y_a_zz:codegen"}
enum { SECOND = 1, WIDTH = 3, HEIGHT = 1, COSTATE = 6 };
#else
#define NAMES {"F:codegen", "F_x:codegen", "y_F_xx:codegen"}
enum { SECOND = 2, WIDTH = 2, HEIGHT = 2, COSTATE = 5 };
#endif

#define IN const double *q, const double *p, const double *u
extern void JOIN(PREFIX, _f)(IN, double *f);
extern void JOIN(PREFIX, _f_x)(IN, double *f, double *f_x);
#ifdef LAGRANGIAN
extern void JOIN(PREFIX, _y_f_xx)(IN, const double *y, double *f, double *f_x, double *xx, double *uq);
#else
extern void JOIN(PREFIX, _y_f_xx)(IN, const double *y, double *f, double *f_x, double *y_f_xx);
#endif

static int n;
static double *out[4];

#define ARGUMENTS x, x + SECOND * n, x + 3 * n

static void run0(void *unused, const double *x) {
    (void)unused;
    JOIN(PREFIX, _f)(ARGUMENTS, out[0]);
}

static void values0(void *unused, double *to) {
    (void)unused;
    memcpy(to, out[0], (size_t)(HEIGHT * n) * sizeof *to);
}

#if ORDERS > 1
static void run1(void *unused, const double *x) {
    (void)unused;
    JOIN(PREFIX, _f_x)(ARGUMENTS, out[0], out[1]);
}

static void values1(void *unused, double *to) {
    (void)unused;
    memcpy(to, out[1], (size_t)(HEIGHT * WIDTH * n * n) * sizeof *to);
}
#endif

#if ORDERS > 2
static void run2(void *unused, const double *x) {
    (void)unused;
#ifdef LAGRANGIAN
    JOIN(PREFIX, _y_f_xx)(ARGUMENTS, x + COSTATE * n, out[0], out[1], out[2], out[3]);
#else
    JOIN(PREFIX, _y_f_xx)(ARGUMENTS, x + COSTATE * n, out[0], out[1], out[2]);
#endif
}

static void values2(void *unused, double *to) {
    (void)unused;
#ifdef LAGRANGIAN
    /* [ xx uq' ; uq 0 ], 3n x 3n */
    memset(to, 0, (size_t)(9 * n * n) * sizeof *to);
    for (int i = 0; i < 2 * n; i++) memcpy(to + 3 * n * i, out[2] + 2 * n * i, (size_t)(2 * n) * sizeof *to);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) to[3 * n * (2 * n + i) + j] = to[3 * n * j + 2 * n + i] = out[3][n * i + j];
#else
    memcpy(to, out[2], (size_t)(4 * n * n) * sizeof *to);
#endif
}
#endif

const struct peer *peer_open(const char *file, int joints) {
    (void)file;
    static const char *const names[3] = NAMES;
    static struct quantity quantities[3];
    static struct peer result;
    n = joints;
    for (int k = 0; k < 4; k++) {
        out[k] = calloc((size_t)(9 * n * n), sizeof **out);
        if (!out[k]) {
            fprintf(stderr, "generated: out of memory\n");
            return NULL;
        }
    }
    quantities[0] = (struct quantity){names[0], HEIGHT * n, run0, values0};
#if ORDERS > 1
    quantities[1] = (struct quantity){names[1], HEIGHT * WIDTH * n * n, run1, values1};
#endif
#if ORDERS > 2
    quantities[2] = (struct quantity){names[2], WIDTH * WIDTH * n * n, run2, values2};
#endif
    result = (struct peer){NULL, ORDERS, quantities};
    return &result;
}
