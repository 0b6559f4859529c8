/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read the numbers that the schema's triggers keep, and retire finished jobs. */
#include "store/operation.h"

#include "base/cleanup.h"
#include "store/query.h"

int store_count(store *s, store_counts *counts, shear_error *err) {
    bool row = false;
    *counts = (store_counts){0};
    CLEANUP(query_end) query q = query_on(s, SQL_COUNTS);
    int code = query_step(&q, &row, err);
    while (row) {
        const int64_t state = query_get_int(&q);
        const int64_t n = query_get_int(&q);
        if (state >= 0 && state < STORE_N_STATES) {
            counts->jobs[state] = n;
            counts->unfinished += state <= STORE_WAITING ? n : 0;
        }
        code = query_step(&q, &row, err);
    }
    if (code != SHEAR_OK)
        *counts = (store_counts){0};
    return code;
}

static void read_totals(query *q, store_totals *t) {
    t->submitted = query_get_int(q);
    t->counted = query_get_int(q);
    t->duplicates = query_get_int(q);
    t->failed = query_get_int(q);
    t->cancelled = query_get_int(q);
    t->retired = query_get_int(q);
    t->attempts = query_get_int(q);
    t->interrupted = query_get_int(q);
    for (int i = STORE_NO_CLASS; i <= STORE_BUG; i++)
        t->failures[i] = query_get_int(q);
    t->n_stamps = query_get_int(q);
    t->n_used = query_get_int(q);
    t->elapsed_us = query_get_int(q);
    t->fields = query_get_int(q);
    t->retracted = query_get_int(q);
}

int store_total(store *s, store_totals *totals, shear_error *err) {
    bool row = false;
    *totals = (store_totals){0};
    CLEANUP(query_end) query q = query_on(s, SQL_TOTALS);
    const int code = query_step(&q, &row, err);
    if (row)
        read_totals(&q, totals);
    return code;
}

/* Retire the oldest finished jobs, at most `n`, and add their number to *gone. */
static int retire_some(store *s, int64_t before_ms, int64_t n, int64_t *gone, shear_error *err) {
    if (n <= 0)
        return SHEAR_OK;
    query q = query_on(s, SQL_RETIRE);
    query_int(&q, before_ms);
    query_int(&q, n);
    const int code = query_run(&q, err);
    *gone += code == SHEAR_OK ? sqlite3_changes64(s->db) : 0;
    return code;
}

static int retire(store *s, const store_retention *rule, int64_t *gone, shear_error *err) {
    store_counts counts;
    int64_t finished = 0;
    int code = retire_some(s, rule->finished_before_ms, rule->batch, gone, err);
    if (code != SHEAR_OK || rule->keep < 0)
        return code;
    TRY(store_count(s, &counts, err));
    for (enum store_state state = STORE_DONE; state < STORE_N_STATES; state++)
        finished += counts.jobs[state];
    const int64_t excess = finished - rule->keep;
    const int64_t left = rule->batch - *gone;
    return retire_some(s, INT64_MAX, excess < left ? excess : left, gone, err);
}

int store_retire(store *s, const store_retention *rule, int64_t *retired, shear_error *err) {
    *retired = 0;
    const int code = OPERATION(s, retire(s, rule, retired, err), err);
    *retired = code == SHEAR_OK ? *retired : 0;
    return code;
}
