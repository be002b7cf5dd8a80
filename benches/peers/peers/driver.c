/* Times the quantities of several competitors on the same states, batch by batch in turn, in one process.
 *
 *     driver STATES NQ N BATCHES NANOSECONDS QUANTITIES LABEL=LIBRARY:FILE...
 *
 * STATES holds NQ + 6 N numbers a line (peer.h). A batch is as many whole sweeps over the states as take NANOSECONDS. One
 * sweep that is not timed goes before each batch. Lines out: "values LABEL QUANTITY STATE numbers" and
 * "time LABEL QUANTITY BATCH nanoseconds-a-call". */
#define _POSIX_C_SOURCE 200809L
#include "peer.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct entry {
    const char *label;
    void *context;
    const struct quantity *quantity;
    long sweeps;
};

/* Time of this thread on a processor: what other programs take of it does not count. */
static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void fail(const char *what, const char *detail) {
    fprintf(stderr, "driver: %s: %s\n", what, detail);
    exit(1);
}

static double *read_states(const char *path, int width, int *count) {
    FILE *file = fopen(path, "r");
    if (!file) fail("cannot read the states", path);
    double *states = NULL;
    long read = 0, room = 0;
    double number;
    while (fscanf(file, "%lf", &number) == 1) {
        if (read == room) {
            room = room ? 2 * room : 1024;
            states = realloc(states, (size_t)room * sizeof *states);
            if (!states) fail("out of memory", path);
        }
        states[read++] = number;
    }
    fclose(file);
    if (read == 0 || read % width) fail("states of another length", path);
    *count = (int)(read / width);
    return states;
}

/* Nanoseconds a call. */
static double batch(const struct entry *entry, const double *states, int count, int width) {
    void (*run)(void *, const double *) = entry->quantity->run;
    void *context = entry->context;
    for (int k = 0; k < count; k++) run(context, states + (long)k * width);
    double start = now();
    for (long s = 0; s < entry->sweeps; s++)
        for (int k = 0; k < count; k++) run(context, states + (long)k * width);
    return (now() - start) / (double)(entry->sweeps * count);
}

static void print_values(const struct entry *entry, const double *states, int count, int width) {
    double *out = malloc((size_t)entry->quantity->length * sizeof *out);
    if (!out) fail("out of memory", entry->label);
    for (int k = 0; k < count; k++) {
        entry->quantity->run(entry->context, states + (long)k * width);
        entry->quantity->values(entry->context, out);
        printf("values %s %s %d", entry->label, entry->quantity->name, k);
        for (int i = 0; i < entry->quantity->length; i++) printf(" %.17g", out[i]);
        putchar('\n');
    }
    free(out);
}

/* Whether the quantity, `name:way`, is one of those in `wanted`, a list with commas; "-" means all. */
static int is_wanted(const char *name, const char *wanted) {
    size_t length = strcspn(name, ":");
    if (!strcmp(wanted, "-")) return 1;
    for (const char *at = wanted; *at; at += strcspn(at, ","), at += *at == ',')
        if (strcspn(at, ",") == length && !strncmp(at, name, length)) return 1;
    return 0;
}

int main(int argc, char **argv) {
    if (argc < 8) fail("usage", "driver STATES NQ N BATCHES NANOSECONDS QUANTITIES LABEL=LIBRARY:FILE...");
    int n = atoi(argv[3]), width = atoi(argv[2]) + 6 * n, batches = atoi(argv[4]), count, used = 0;
    double span = atof(argv[5]);
    double *states = read_states(argv[1], width, &count);
    struct entry entries[512];
    for (int i = 7; i < argc; i++) {
        char *library = strchr(argv[i], '='), *file = strrchr(argv[i], ':');
        if (!library || !file) fail("not LABEL=LIBRARY:FILE", argv[i]);
        *library++ = *file++ = '\0';
        void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
        if (!handle) fail("cannot load", dlerror());
        const struct peer *(*open)(const char *, int);
        *(void **)&open = dlsym(handle, "peer_open");
        if (!open) fail("no peer_open in", library);
        const struct peer *peer = open(file, n);
        if (!peer) fail("cannot open the robot", argv[i]);
        for (int j = 0; j < peer->count && used < 512; j++)
            if (is_wanted(peer->quantities[j].name, argv[6]))
                entries[used++] = (struct entry){argv[i], peer->context, &peer->quantities[j], 1};
    }
    for (int i = 0; i < used; i++) {
        print_values(&entries[i], states, count, width);
        double once = batch(&entries[i], states, count, width) * count;
        entries[i].sweeps = once < span ? (long)(span / once) + 1 : 1;
    }
    for (int b = 0; b < batches; b++)
        for (int i = 0; i < used; i++)
            printf("time %s %s %d %.3f\n", entries[i].label, entries[i].quantity->name, b,
                   batch(&entries[i], states, count, width));
    return 0;
}
