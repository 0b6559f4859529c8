/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear-bench: times the measurement in microseconds per stamp pair, as a ratio to F (two plain
 * FFTW r2c transforms of the same fine size) in the same run; also the speed-up of threads, and the
 * stages of a pair. */
#include "rounds.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum format { TABLE, STAGES, JSON };

typedef struct options {
    enum format format;
    int rounds, threads;
    const char *only;
} options;

/* Return the number of transforms: a PSF per stamp needs one more. */
static double transforms(const bench_case *c) {
    return c->psf_per_stamp ? 3.0 : 2.0;
}

static void print_head(const options *o) {
    if (o->format == TABLE) {
        printf(
            "| case, one thread             | us per pair | pairs per second | transforms | us for "
            "them | ratio | %d threads |\n"
            "|---|---|---|---|---|---|---|\n",
            o->threads);
    }
    if (o->format == STAGES) {
        printf("| us per pair                    |");
        for (int i = 0; i < N_STAGES; i++)
            printf(" %s |", stage_names[i]);
        printf("\n|---|---|---|---|---|---|---|---|\n");
    }
}

static void print_json(const bench_case *c, const timing *t, int threads) {
    const double n = transforms(c);
    printf("{\"case\":\"%s\",\"pair_us\":%.3f,\"pairs_per_s\":%.0f,\"transforms\":%.0f,\"floor_"
           "us\":%.3f,\"ratio\":%.4f,"
           "\"threads\":%d,\"speedup\":%.3f,\"stages_us\":{",
           c->name, t->pair_us, 1e6 / t->pair_us, n, t->floor_us * n / 2.0, t->ratio * 2.0 / n,
           threads, t->speedup);
    for (int i = 0; i < N_STAGES; i++)
        printf("%s\"%s\":%.3f", i > 0 ? "," : "", stage_names[i], t->stage_us[i]);
    printf("}}\n");
}

static void print_case(const bench_case *c, const timing *t, const options *o) {
    const double n = transforms(c);
    switch (o->format) {
    case JSON:
        print_json(c, t, o->threads);
        break;
    case STAGES:
        printf("| %-28s |", c->name);
        for (int i = 0; i < N_STAGES; i++)
            printf(" %.1f |", t->stage_us[i]);
        printf("\n");
        break;
    default:
        printf("| %-28s | %9.1f | %9.0f | %.0f | %9.1f | %5.2f | %.2f |\n", c->name, t->pair_us,
               1e6 / t->pair_us, n, t->floor_us * n / 2.0, t->ratio * 2.0 / n, t->speedup);
        break;
    }
    fflush(stdout);
}

static void usage(void) {
    fprintf(stderr,
            "usage: shear-bench [--rounds N (1 to %d)] [--threads N] [--stages | --json] [--only "
            "CASE]\n",
            ROUNDS_MAX);
    exit(2);
}

static options parse(int argc, char **argv) {
    options o = {.format = TABLE, .rounds = 21, .threads = omp_get_max_threads(), .only = ""};
    for (int i = 1; i < argc; i++) {
        const bool has_value = i + 1 < argc;
        if (strcmp(argv[i], "--json") == 0) {
            o.format = JSON;
        } else if (strcmp(argv[i], "--stages") == 0) {
            o.format = STAGES;
        } else if (strcmp(argv[i], "--rounds") == 0 && has_value) {
            o.rounds = (int)strtol(argv[++i], NULL, 10);
        } else if (strcmp(argv[i], "--threads") == 0 && has_value) {
            o.threads = (int)strtol(argv[++i], NULL, 10);
        } else if (strcmp(argv[i], "--only") == 0 && has_value) {
            o.only = argv[++i];
        } else {
            usage();
        }
    }
    if (o.rounds < 1 || o.rounds > ROUNDS_MAX || o.threads < 1 || o.threads > 1024)
        usage();
    return o;
}

int main(int argc, char **argv) {
    const options o = parse(argc, argv);
    print_head(&o);
    for (int i = 0; i < bench_n_cases; i++) {
        timing t;
        shear_error err = {0};
        if (o.only[0] != '\0' && strcmp(bench_cases[i].name, o.only) != 0)
            continue;
        if (rounds_time_case(&bench_cases[i], o.rounds, o.threads, &t, &err) != SHEAR_OK) {
            fprintf(stderr, "shear-bench: %s: %s\n", bench_cases[i].name, err.message);
            return 1;
        }
        print_case(&bench_cases[i], &t, &o);
    }
    return 0;
}
