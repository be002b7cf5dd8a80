/* What every competitor offers: a shared library that opens a robot and runs its quantities on packed states.
 *
 * A state is q (nq numbers), v, p, u, a (n numbers each), y (2n numbers): nq + 6n doubles. nq is n, and one more for
 * each joint with a quaternion. */
#ifndef PEER_H
#define PEER_H

#ifdef __cplusplus
extern "C" {
#endif

struct quantity {
    const char *name;
    int length;                                     /* how many numbers values() writes */
    void (*run)(void *context, const double *state);   /* what is timed */
    void (*values)(void *context, double *out);        /* copies the result of the last run; not timed */
};

struct peer {
    void *context;
    int count;
    const struct quantity *quantities;
};

/* Builds every workspace for the robot described in a file; NULL with a message on stderr where it cannot. */
const struct peer *peer_open(const char *file, int n);

#ifdef __cplusplus
}
#endif

#endif
