/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rounds.h"

#include "floor.h"
#include "timer.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

static const double round_seconds = 0.02; /* the shortest a timing may be */
static const double turn_pixels = 131072.0;

/* What one round of a case needs. */
typedef struct bench {
    bench_data data;
    shear_workspace **ws; /* [threads] */
    shear_row *rows;      /* [threads][count] */
    floor_transform *floor;
    int threads, repeats;
} bench;

static void measure(const bench_data *d, shear_workspace *ws, int repeats, shear_row *rows) {
    shear_error err;
    for (int i = 0; i < repeats; i++) {
        if (shear_measure_range(d->plan, ws, &d->stamps, 0, d->count, rows, &err) != SHEAR_OK) {
            fprintf(stderr, "shear-bench: %s\n", err.message);
            exit(1);
        }
    }
}

double rounds_time_pairs(const bench_data *d, shear_workspace *ws, int repeats) {
    const double start = timer_processor_us();
    measure(d, ws, repeats, d->rows);
    return (timer_processor_us() - start) / ((double)repeats * d->count);
}

/* The same on all threads at once, all with the same stamps: each thread's own processor time, so
 * that it tells what they cost each other (caches, memory, false sharing), not what else runs on
 * the machine. */
static double time_threads(const bench *b) {
    const int repeats = b->repeats / b->data.count;
    double us = 0.0;
#pragma omp parallel num_threads(b->threads) reduction(+ : us)
    {
        const int t = omp_get_thread_num();
        const double start = timer_processor_us();
        measure(&b->data, b->ws[t], repeats, b->rows + (size_t)t * (size_t)b->data.count);
        us += timer_processor_us() - start;
    }
    return us / ((double)repeats * b->data.count * b->threads);
}

static double time_floor(floor_transform *f, int repeats) {
    const double start = timer_processor_us();
    for (int i = 0; i < repeats; i++) {
        floor_run(f);
    }
    return (timer_processor_us() - start) / repeats;
}

static int bench_init(bench *b, const bench_case *c, int threads, shear_error *err) {
    const int fine = c->side * c->oversample;
    *b = (bench){.floor = floor_new(fine, fine), .threads = threads};
    time_floor(b->floor, 1);
    b->repeats = (int)fmax(4.0, ceil(1e6 * round_seconds / time_floor(b->floor, 3)));
    /* As many stamps as a turn of the pipeline has: what the reader has just left in the cache. */
    const int count = (int)fmax(1.0, fmin(b->repeats, turn_pixels / (2.0 * c->side * c->side)));
    int code = bench_data_new(&b->data, c, count, err);
    b->ws = calloc((size_t)threads, sizeof(shear_workspace *));
    b->rows = calloc((size_t)threads * (size_t)count, sizeof *b->rows);
    if (code == SHEAR_OK && (b->ws == NULL || b->rows == NULL)) {
        code = shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    }
    for (int t = 0; t < threads && code == SHEAR_OK; t++) {
        code = shear_workspace_new(&b->ws[t], b->data.plan, err);
    }
    return code;
}

static void bench_deinit(bench *b) {
    for (int t = 0; b->ws != NULL && t < b->threads; t++) {
        shear_workspace_free(b->ws[t]);
    }
    free(b->ws);
    free(b->rows);
    bench_data_free(&b->data);
    floor_free(b->floor);
}

/* The values of all rounds. */
typedef struct record {
    double pair[ROUNDS_MAX], floor[ROUNDS_MAX], ratio[ROUNDS_MAX], speedup[ROUNDS_MAX];
    double stage[N_STAGES][ROUNDS_MAX];
} record;

static void one_round(const bench *b, record *r, int at) {
    const int repeats = b->repeats / b->data.count;
    double us[N_STAGES];
    r->pair[at] = rounds_time_pairs(&b->data, b->ws[0], repeats);
    r->floor[at] = time_floor(b->floor, b->repeats);
    r->ratio[at] = r->pair[at] / r->floor[at];
    r->speedup[at] = b->threads * r->pair[at] / time_threads(b);
    stages_time(&b->data, b->ws[0], repeats, us);
    for (int i = 0; i < N_STAGES; i++) {
        r->stage[i][at] = us[i];
    }
}

int rounds_time_case(const bench_case *c, int rounds, int threads, timing *out, shear_error *err) {
    static record r;
    bench b;
    const int code = bench_init(&b, c, threads, err);
    if (code == SHEAR_OK) {
        one_round(&b, &r, 0); /* warms up */
        for (int i = 0; i < rounds; i++) {
            one_round(&b, &r, i);
        }
        *out = (timing){.pair_us = timer_median(r.pair, rounds),
                        .floor_us = timer_median(r.floor, rounds),
                        .ratio = timer_median(r.ratio, rounds),
                        .speedup = timer_median(r.speedup, rounds)};
        for (int i = 0; i < N_STAGES; i++) {
            out->stage_us[i] = timer_median(r.stage[i], rounds);
        }
    }
    bench_deinit(&b);
    return code;
}
