/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear-bench: microseconds a stamp pair, beside two plain FFTW r2c transforms of the same fine
 * size (F) in the same run. The two are timed in turns (A B A B ...) and their medians compared, so
 * that the machine's noise cancels. */
#include "cases.h"
#include "floor.h"
#include "timer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_ROUNDS = 1001 };
static const double round_seconds = 0.02; /* the shortest a timing may be */
static const double turn_pixels = 131072.0;

typedef struct timing {
    double pair_us, floor_us, ratio;
} timing;

static void time_pairs(const bench_data *d, shear_workspace *ws, int repeats, double *us) {
    const double start = timer_now_us();
    shear_error err;
    for (int i = 0; i < repeats; i++) {
        if (shear_measure_range(d->plan, ws, &d->stamps, 0, d->count, d->rows, &err) != SHEAR_OK) {
            fprintf(stderr, "shear-bench: %s\n", err.message);
            exit(1);
        }
    }
    *us = (timer_now_us() - start) / ((double)repeats * d->count);
}

static void time_floor(floor_transform *f, int repeats, double *us) {
    const double start = timer_now_us();
    for (int i = 0; i < repeats; i++) {
        floor_run(f);
    }
    *us = (timer_now_us() - start) / repeats;
}

static int time_case(const bench_case *c, int rounds, timing *out) {
    static double pair[MAX_ROUNDS];
    static double plain[MAX_ROUNDS];
    static double ratio[MAX_ROUNDS];
    shear_error err = {0};
    bench_data d;
    shear_workspace *ws = NULL;
    const int fine = c->side * c->oversample;
    floor_transform *f = floor_new(fine, fine);
    double guess = 1.0;
    time_floor(f, 1, &guess);
    time_floor(f, 3, &guess);
    const int repeats = (int)fmax(4.0, ceil(1e6 * round_seconds / guess));
    /* As many stamps as a turn of the pipeline has: what the reader has just left in the cache. */
    const int count = (int)fmax(1.0, fmin(repeats, turn_pixels / (2.0 * c->side * c->side)));
    int code = bench_data_new(&d, c, count, &err);
    if (code == SHEAR_OK) {
        code = shear_workspace_new(&ws, d.plan, &err);
    }
    if (code != SHEAR_OK) {
        fprintf(stderr, "shear-bench: %s: %s\n", c->name, err.message);
    }
    for (int r = -1; r < rounds && code == SHEAR_OK; r++) { /* round -1 warms up */
        const int at = r < 0 ? 0 : r;
        time_pairs(&d, ws, repeats / count, &pair[at]);
        time_floor(f, repeats, &plain[at]);
        ratio[at] = pair[at] / plain[at];
    }
    if (code == SHEAR_OK) {
        *out = (timing){timer_median(pair, rounds), timer_median(plain, rounds),
                        timer_median(ratio, rounds)};
    }
    shear_workspace_free(ws);
    bench_data_free(&d);
    floor_free(f);
    return code;
}

static void print_row(const bench_case *c, const timing *t, bool json) {
    /* A PSF a stamp is one more transform that anyone would compute. */
    const double transforms = c->psf_per_stamp ? 3.0 : 2.0;
    const double ratio = t->ratio * 2.0 / transforms;
    if (json) {
        printf("{\"case\":\"%s\",\"pair_us\":%.3f,\"transforms\":%.0f,\"floor_us\":%.3f,\"ratio\":%"
               ".4f}\n",
               c->name, t->pair_us, transforms, t->floor_us * transforms / 2.0, ratio);
    } else {
        printf("| %-28s | %9.1f | %.0f | %9.1f | %5.2f |\n", c->name, t->pair_us, transforms,
               t->floor_us * transforms / 2.0, ratio);
    }
}

int main(int argc, char **argv) {
    bool json = false;
    int rounds = 21;
    const char *only = "";
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--json") == 0) {
            json = true;
        } else if (strcmp(argv[i], "--rounds") == 0 && i + 1 < argc) {
            rounds = atoi(argv[++i]);
        } else if (strcmp(argv[i], "--only") == 0 && i + 1 < argc) {
            only = argv[++i];
        } else {
            fprintf(stderr, "usage: shear-bench [--rounds N] [--json] [--only CASE]\n");
            return 2;
        }
    }
    if (rounds < 1 || rounds > MAX_ROUNDS) {
        fprintf(stderr, "shear-bench: --rounds must be 1 to %d\n", MAX_ROUNDS);
        return 2;
    }
    if (!json) {
        printf(
            "| case, one thread              | us a pair | transforms | us for them | ratio |\n");
        printf("|---|---|---|---|---|\n");
    }
    for (int i = 0; i < bench_n_cases; i++) {
        timing t;
        if (only[0] != 0 && strcmp(bench_cases[i].name, only) != 0) {
            continue;
        }
        if (time_case(&bench_cases[i], rounds, &t) != SHEAR_OK) {
            return 1;
        }
        print_row(&bench_cases[i], &t, json);
    }
    return 0;
}
