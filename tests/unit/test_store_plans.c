/* SPDX-License-Identifier: GPL-3.0-or-later */
/* No statement reads a whole table, or sorts: SQLite's own plan of each says so. With triggers and
 * foreign keys, whose steps are in the program but not in the plan: those are looked at one by one.
 */
#include "store/database.h"
#include "store_test.h"

#include <stdio.h>
#include <string.h>

/* The tables and indices that have few rows however many jobs have finished: those of unfinished
 * jobs, and the six counts. */
static const char *const small[] = {"SCAN sqlite_sequence",
                                    "SCAN counts",
                                    "SCAN jobs USING INDEX jobs_queue",
                                    "SCAN jobs USING COVERING INDEX jobs_queue",
                                    "SCAN jobs USING INDEX jobs_waiting",
                                    "SCAN jobs USING COVERING INDEX jobs_waiting",
                                    "SCAN jobs USING COVERING INDEX jobs_pending",
                                    "SCAN w USING COVERING INDEX jobs_waiting_reason"};

static bool is_small(const char *step) {
    for (size_t i = 0; i < sizeof small / sizeof small[0]; i++) {
        if (strcmp(step, small[i]) == 0)
            return true;
    }
    return false;
}

static void check_plan(store *s, const char *sql) {
    char explain[4096];
    sqlite3_stmt *stmt = NULL;
    snprintf(explain, sizeof explain, "EXPLAIN QUERY PLAN %s", sql);
    assert_int_equal(sqlite3_prepare_v2(s->db, explain, -1, &stmt, NULL), SQLITE_OK);
    while (sqlite3_step(stmt) == SQLITE_ROW) {
        const char *step = (const char *)sqlite3_column_text(stmt, 3);
        const bool scans = strncmp(step, "SCAN", 4) == 0;
        const bool sorts = strstr(step, "TEMP B-TREE") != NULL || strstr(step, "AUTOMATIC") != NULL;
        if ((scans && !is_small(step)) || sorts)
            fail_msg("%s\n  %s", sql, step);
    }
    sqlite3_finalize(stmt);
}

static void fill(fixture *f) {
    static const char *const contents[] = {"1", "2", "3"};
    for (unsigned i = 0; i < 3; i++) {
        fx_done(f, "a", contents[i], i);
        fx_done(f, contents[i], contents[i], i);
    }
}

static void no_statement_scans(void **state) {
    fixture *f = *state;
    for (int i = 0; i < SQL_N; i++)
        check_plan(f->s, sql_texts[i]);
    /* Statistics must not talk SQLite into another plan. */
    fill(f);
    assert_int_equal(sqlite3_exec(f->s->db, "ANALYZE", NULL, NULL, NULL), SQLITE_OK);
    for (int i = 0; i < SQL_N; i++)
        check_plan(f->s, sql_texts[i]);
}

/* What the triggers of the schema run, and the children that foreign keys look for. */
static void no_trigger_scans(void **state) {
    static const char *const bodies[] = {
        "UPDATE counts SET n = n + 1 WHERE state = 0",
        "UPDATE totals SET submitted = submitted + 1 WHERE id = 1",
        "UPDATE settings SET uses = uses + 1 WHERE digest = 'd'",
        "DELETE FROM settings WHERE digest = 'd' AND uses = 0",
        "SELECT 1 FROM attempts WHERE job = 1",
        "SELECT 1 FROM checkpoints WHERE job = 1",
        "SELECT 1 FROM contributions WHERE field = 1",
    };
    fixture *f = *state;
    for (size_t i = 0; i < sizeof bodies / sizeof bodies[0]; i++)
        check_plan(f->s, bodies[i]);
}

/* The real proof: the steps of SQLite's machine that each operation takes do not grow with the
 * number of finished jobs. */
static int64_t steps_of(store *s) {
    int64_t steps = 0;
    for (int i = 0; i < SQL_N; i++) {
        if (s->statements[i] != NULL)
            steps += sqlite3_stmt_status(s->statements[i], SQLITE_STMTSTATUS_VM_STEP, 1);
    }
    return steps;
}

static void use_everything(fixture *f, const char *content) {
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    int64_t due = 0;
    store_counts counts;
    store_totals totals;
    store_job_page jobs;
    store_field_page fields;
    store_contribution_page list;
    store_attempts attempts;
    const int64_t done = fx_done(f, "a", content, 1);
    fx_done(f, "a", content, 1); /* a duplicate */
    const int64_t failed = fx_running(f, "a", "x");
    const store_failure failure = fx_failure(f, STORE_DATA, STORE_NEVER);
    FX_OK(store_fail(f->s, failed, &failure, &end, &err));
    FX_OK(store_retry(f->s, failed, 10, &err));
    FX_OK(store_cancel(f->s, failed, fx_now(f), &end, &err));
    FX_OK(store_next_due(f->s, &due, &err));
    FX_OK(store_count(f->s, &counts, &err));
    FX_OK(store_total(f->s, &totals, &err));
    FX_OK(store_attempts_get(f->s, done, &attempts, &err));
    store_attempts_deinit(&attempts);
    for (int i = 0; i < 4; i++) {
        const store_job_filter filter = {0, i & 1 ? "a" : NULL, (i & 2) != 0, 1000, 0};
        FX_OK(store_jobs(f->s, &filter, 1, &jobs, &err));
        store_job_page_deinit(&jobs);
    }
    FX_OK(store_field_get(f->s, "a", &fields, &err));
    store_field_page_deinit(&fields);
    const store_field_filter every = {0};
    FX_OK(store_fields(f->s, &every, 1, &fields, &err));
    store_field_page_deinit(&fields);
    FX_OK(store_contributions(f->s, "a", "d0", 0, 1, &list, &err));
    store_contribution_page_deinit(&list);
}

static void the_work_does_not_grow(void **state) {
    fixture *f = *state;
    char content[16];
    fx_done(f, "b", "warm", 1);
    use_everything(f, "warm 1");
    use_everything(f, "warm 2");
    steps_of(f->s);
    use_everything(f, "few");
    const int64_t few = steps_of(f->s);
    for (int i = 0; i < 300; i++) {
        snprintf(content, sizeof content, "c%d", i);
        fx_done(f, i % 2 ? "a" : content, content, (unsigned)i);
    }
    steps_of(f->s);
    use_everything(f, "many");
    const int64_t many = steps_of(f->s);
    assert_true(few > 100);
    assert_int_equal(many, few);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(no_statement_scans),
        STORE_TEST(no_trigger_scans),
        STORE_TEST(the_work_does_not_grow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
