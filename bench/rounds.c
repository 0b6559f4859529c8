/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rounds.h"

#include "base/cleanup.h"
#include "floor.h"
#include "timer.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>

static const double round_seconds = 0.02; /* minimum duration of a timing */
static const double unit_pixels = 131072.0;

/* The memory for one round of a case. */
typedef struct timed_case {
    bench_data data;
    shear_workspace **ws; /* [threads] */
    shear_row *rows;      /* [threads][count] */
    floor_transform *floor;
    int threads, repeats;
} timed_case;

/* Return microseconds per pair with all threads at once on the same stamps, in each thread's own
 * processor time. So it includes the effect of threads on each other (caches, memory, false
 * sharing), but not that of other processes. */
static double time_threads(const timed_case *b) {
    const int repeats = b->repeats / b->data.count;
    double us = 0.0;
#pragma omp parallel num_threads(b->threads) reduction(+ : us)
    {
        const int t = omp_get_thread_num();
        const double start = timer_processor_us();
        bench_data_measure(&b->data, b->ws[t], repeats,
                           b->rows + (size_t)t * (size_t)b->data.count);
        us += timer_processor_us() - start;
    }
    return us / ((double)repeats * b->data.count * b->threads);
}

static double time_floor(floor_transform *f, int repeats) {
    const double start = timer_processor_us();
    for (int i = 0; i < repeats; i++)
        floor_run(f);
    return (timer_processor_us() - start) / repeats;
}

static int timed_case_init(timed_case *b, const bench_case *c, int threads, shear_error *err) {
    const int fine = c->side * c->oversample;
    *b = (timed_case){.floor = floor_new(fine, fine), .threads = threads};
    if (b->floor == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    time_floor(b->floor, 1);
    b->repeats = (int)fmax(4.0, ceil(1e6 * round_seconds / time_floor(b->floor, 3)));
    /* As many stamps as in a work unit of the pipeline: they are still in the cache after the
     * reader. */
    const int count = (int)fmax(1.0, fmin(b->repeats, unit_pixels / (2.0 * c->side * c->side)));
    TRY(bench_data_init(&b->data, c, count, err));
    b->ws = calloc((size_t)threads, sizeof(shear_workspace *));
    b->rows = calloc((size_t)threads * (size_t)count, sizeof *b->rows);
    if (b->ws == NULL || b->rows == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    for (int t = 0; t < threads; t++)
        TRY(shear_workspace_new(&b->ws[t], b->data.plan, err));
    return SHEAR_OK;
}

static void timed_case_deinit(timed_case *b) {
    for (int t = 0; b->ws != NULL && t < b->threads; t++)
        shear_workspace_free(b->ws[t]);
    free(b->ws);
    free(b->rows);
    bench_data_deinit(&b->data);
    floor_free(b->floor);
}

/* The values of all rounds. */
typedef struct record {
    double pair[ROUNDS_MAX], floor[ROUNDS_MAX], ratio[ROUNDS_MAX], speedup[ROUNDS_MAX];
    double stage[N_STAGES][ROUNDS_MAX];
} record;

static void one_round(const timed_case *b, record *r, int at) {
    assert(b->data.count > 0 && at < ROUNDS_MAX);
    const int repeats = b->repeats / b->data.count;
    double us[N_STAGES];
    r->pair[at] = bench_data_time_pairs(&b->data, b->ws[0], repeats);
    r->floor[at] = time_floor(b->floor, b->repeats);
    r->ratio[at] = r->pair[at] / r->floor[at];
    r->speedup[at] = b->threads * r->pair[at] / time_threads(b);
    stages_time(&b->data, b->ws[0], repeats, us);
    for (int i = 0; i < N_STAGES; i++)
        r->stage[i][at] = us[i];
}

int rounds_time_case(const bench_case *c, int rounds, int threads, timing *out, shear_error *err) {
    static record r;
    CLEANUP(timed_case_deinit) timed_case b = {0};
    TRY(timed_case_init(&b, c, threads, err));
    one_round(&b, &r, 0); /* warm-up */
    for (int i = 0; i < rounds; i++)
        one_round(&b, &r, i);
    *out = (timing){.pair_us = timer_median(r.pair, rounds),
                    .floor_us = timer_median(r.floor, rounds),
                    .ratio = timer_median(r.ratio, rounds),
                    .speedup = timer_median(r.speedup, rounds)};
    for (int i = 0; i < N_STAGES; i++)
        out->stage_us[i] = timer_median(r.stage[i], rounds);
    return SHEAR_OK;
}
