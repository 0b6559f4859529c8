/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read the numbers that the schema's triggers keep, and retire finished jobs. */
#include "store/operation.h"

#include "base/cleanup.h"
#include "store/row.h"

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

#define TOTAL(member) ROW_MEMBER(store_totals, member)
static const row_type totals_type =
    ROW_TYPE(store_totals, TOTAL(submitted), TOTAL(counted), TOTAL(duplicates), TOTAL(failed),
             TOTAL(cancelled), TOTAL(retired), TOTAL(attempts), TOTAL(interrupted),
             TOTAL(failures[STORE_NO_CLASS]), TOTAL(failures[STORE_TRANSIENT]),
             TOTAL(failures[STORE_DATA]), TOTAL(failures[STORE_BUG]), TOTAL(n_stamps),
             TOTAL(n_used), TOTAL(elapsed_us), TOTAL(fields), TOTAL(retracted));

int store_total(store *s, store_totals *totals, shear_error *err) {
    return row_get(query_on(s, SQL_TOTALS), &totals_type, totals, NULL, err);
}

/* Retire the oldest finished jobs, at most `n`, and add their number to *gone. */
static int retire_some(store *s, int64_t before_ms, int64_t n, int64_t *gone, shear_error *err) {
    if (n <= 0)
        return SHEAR_OK;
    TRY(query_run(QUERY(s, SQL_RETIRE, query_int(before_ms), query_int(n)), err));
    *gone += sqlite3_changes64(s->db);
    return SHEAR_OK;
}

static int retire(store *s, const store_retention *rule, int64_t *gone, shear_error *err) {
    store_counts counts;
    int64_t finished = 0;
    TRY(retire_some(s, rule->finished_before_ms, rule->batch, gone, err));
    if (rule->keep < 0)
        return SHEAR_OK;
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
