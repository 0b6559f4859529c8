/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the store keeps of every file that was counted, and what it reports about the jobs that
 * wait. */
#include "store/database.h"
#include "store/schema.h"
#include "store_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int64_t count_truth(fixture *f, const char *content, bool known, double g1, double g2) {
    shear_error err = {0};
    store_finished end;
    char *sums = fx_sums(1);
    char account[64];
    const int64_t id = fx_running(f, "a", content);
    snprintf(account, sizeof account, "{\"of\":\"%s\"}", content);
    const store_work work = {.sums = sums,
                             .elapsed_us = 1500,
                             .now_ms = fx_now(f),
                             .account = account,
                             .has_truth = known,
                             .true_g1 = g1,
                             .true_g2 = g2};
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    free(sums);
    return id;
}

static store_truth truth(fixture *f) {
    shear_error err = {0};
    store_truth t;
    FX_OK(store_field_truth(f->s, "a", "d0", &t, &err));
    return t;
}

static void accounts_are_kept_when_jobs_are_gone(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_contribution_page page;
    store_field_page fields;
    int64_t retired = 0;
    count_truth(f, "x", false, 0, 0);
    count_truth(f, "y", false, 0, 0);
    const store_retention all = {.finished_before_ms = INT64_MAX, .keep = -1, .batch = 10};
    FX_OK(store_retire(f->s, &all, &retired, &err));
    assert_int_equal(retired, 2);
    FX_OK(store_contributions(f->s, "a", "d0", 0, 10, &page, &err));
    assert_int_equal(page.n, 2);
    assert_string_equal(page.items[0].account, "{\"of\":\"x\"}");
    assert_string_equal(page.items[1].account, "{\"of\":\"y\"}");
    store_contribution_page_deinit(&page);
    FX_OK(store_field_get(f->s, "a", &fields, &err));
    assert_int_equal(fields.fields[0].elapsed_us, 3000);
    store_field_page_deinit(&fields);
}

/* The largest of all, the first of equals by the stamp's number, with its file's account. */
static void the_stamp_that_counts_most(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    shear_influence top;
    char *account = NULL;
    FX_CODE(STORE_NOT_FOUND, store_field_top(f->s, "a", "d0", &top, &account, &err));
    assert_null(account);
    shear_influence expected = {.size = 0.0};
    for (unsigned seed = 0; seed < 9; seed++) {
        store_finished end;
        char content[8];
        char *sums = fx_sums(seed);
        snprintf(content, sizeof content, "c%u", seed);
        const int64_t id = fx_running(f, "a", content);
        const store_work work = {.sums = sums, .now_ms = fx_now(f), .account = content};
        FX_OK(store_finish(f->s, id, &work, &end, &err));
        free(sums);
        const shear_influence one = fx_top(seed);
        if (one.size > expected.size || (one.size == expected.size && one.stamp < expected.stamp))
            expected = one;
        FX_OK(store_field_top(f->s, "a", "d0", &top, &account, &err));
        assert_true(top.size == expected.size);
        assert_int_equal(top.stamp, expected.stamp);
        const shear_influence its = fx_top((unsigned)(account[1] - '0'));
        assert_true(its.size == expected.size && its.stamp == expected.stamp);
        free(account);
    }
    assert_true(fx_top(1).size == fx_top(8).size && fx_top(1).stamp != fx_top(8).stamp);
}

static void truth_is_known_where_all_agree(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_truth t;
    FX_CODE(STORE_NOT_FOUND, store_field_truth(f->s, "a", "d0", &t, &err));
    count_truth(f, "1", true, 0.02, -0.01);
    assert_true(truth(f).known);
    count_truth(f, "2", true, 0.02, -0.01);
    assert_true(truth(f).known);
    assert_true(truth(f).g1 == 0.02 && truth(f).g2 == -0.01);
    count_truth(f, "3", true, 0.02, 0.03); /* the other component alone */
    assert_false(truth(f).known);
}

static void one_without_a_truth_is_enough(void **state) {
    fixture *f = *state;
    count_truth(f, "1", true, 0.02, -0.01);
    count_truth(f, "2", false, 0, 0);
    count_truth(f, "3", true, 0.02, -0.01);
    assert_false(truth(f).known);
}

/* A job of version 3 has told all of this in its result; one that was retired then has not. */
static void accounts_of_before_are_taken_from_results(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    sqlite3 *db = NULL;
    store_contribution_page page;
    fx_close(f);
    unlink(f->path);
    assert_int_equal(sqlite3_open(f->path, &db), SQLITE_OK);
    FX_OK(database_exec(db, f->path, "BEGIN", &err));
    FX_OK(schema_migrate(db, f->path, schema_steps, 0, 3, &err));
    FX_OK(database_exec(
        db, f->path,
        "INSERT INTO settings(digest, text) VALUES ('d0', '{}');"
        "INSERT INTO fields VALUES (1, 'a', 'd0', 2, 32, 32, 5, '');"
        "INSERT INTO jobs(owner, source, settings, field, field_asked, origin, priority, forced,"
        " created_ms) VALUES (7, '/a', 'd0', 'a', 'a', 1, 3, 0, 5);"
        "UPDATE jobs SET state = 3, outcome = 1, n_stamps = 16, n_used = 16, elapsed_us = 700,"
        " result = '{\"files\":[{\"path\":\"/a\",\"n\":1.5}],\"truth\":{\"g1\":0.1,\"g2\":-0.2}}';"
        "INSERT INTO contributions VALUES (1, 1, 1, 'c', 16, 16, 5, ''),"
        " (2, 1, 99, 'd', 16, 16, 5, ''); UPDATE totals SET counted = 2; COMMIT",
        &err));
    sqlite3_close(db);
    fx_open(f);
    FX_OK(store_contributions(f->s, "a", "d0", 0, 10, &page, &err));
    assert_int_equal(page.n, 2);
    assert_string_equal(page.items[0].account, "{\"path\":\"/a\",\"n\":1.5}");
    assert_null(page.items[1].account);
    store_contribution_page_deinit(&page);
    assert_false(truth(f).known); /* of the second one it is not known */
    fx_close(f);
    unlink(f->path); /* its made-up sums are none: the audit after the test would say so */
    fx_open(f);
}

static int64_t wait_until(fixture *f, const char *code, const char *message, int64_t at_ms) {
    shear_error err = {0};
    enum store_state state = STORE_QUEUED;
    store_failure failure = fx_failure(f, STORE_TRANSIENT, at_ms);
    failure.code = code;
    failure.message = message;
    fx_submit(f, "a");
    const int64_t id = fx_next(f);
    FX_OK(store_fail(f->s, id, &failure, &state, &err));
    assert_int_equal(state, STORE_WAITING);
    return id;
}

static void waiting_jobs_are_told_by_reason(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_waiting w[4];
    size_t n = 9;
    FX_OK(store_waiting_reasons(f->s, w, 4, &n, &err));
    assert_int_equal(n, 0);
    const int64_t far = f->now + 1000000;
    wait_until(f, "io", "later", far + 50);
    wait_until(f, "io", "sooner", far + 10);
    wait_until(f, "disk_full", "no space", far + 30);
    FX_OK(store_waiting_reasons(f->s, w, 4, &n, &err));
    assert_int_equal(n, 2);
    assert_string_equal(w[0].code, "disk_full");
    assert_int_equal(w[0].jobs, 1);
    assert_string_equal(w[1].code, "io");
    assert_int_equal(w[1].jobs, 2);
    assert_int_equal(w[1].attempts, 1);
    assert_int_equal(w[1].next_ms, far + 10);
    assert_string_equal(w[1].message, "sooner");
    FX_OK(store_waiting_reasons(f->s, w, 1, &n, &err));
    assert_int_equal(n, 1);
}

static void a_set_clock_moves_what_waits(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    const int64_t far = f->now + 1000000;
    const int64_t done = fx_done(f, "b", "c", 1);
    const int64_t a = wait_until(f, "io", "x", far + 10);
    const int64_t b = wait_until(f, "io", "x", far + 500);
    const store_clock back = {.delta_ms = -900000, .latest_ms = far - 900000 + 100, .now_ms = 77};
    FX_OK(store_set_clock(f->s, &back, &err));
    FX_OK(store_job_get(f->s, a, &job, &err));
    assert_int_equal(job.not_before_ms, far + 10 - 900000);
    store_job_deinit(&job);
    FX_OK(store_job_get(f->s, b, &job, &err));
    assert_int_equal(job.not_before_ms, far - 900000 + 100); /* not beyond the latest */
    store_job_deinit(&job);
    FX_OK(store_job_get(f->s, done, &job, &err));
    assert_int_equal(job.finished_ms, 77);
    store_job_deinit(&job);
    const store_clock on = {.delta_ms = 5, .latest_ms = INT64_MAX, .now_ms = INT64_MAX};
    FX_OK(store_set_clock(f->s, &on, &err));
    FX_OK(store_job_get(f->s, a, &job, &err));
    assert_int_equal(job.not_before_ms, far + 15 - 900000);
    store_job_deinit(&job);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(accounts_are_kept_when_jobs_are_gone),
        STORE_TEST(the_stamp_that_counts_most),
        STORE_TEST(truth_is_known_where_all_agree),
        STORE_TEST(one_without_a_truth_is_enough),
        STORE_TEST(accounts_of_before_are_taken_from_results),
        STORE_TEST(waiting_jobs_are_told_by_reason),
        STORE_TEST(a_set_clock_moves_what_waits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
