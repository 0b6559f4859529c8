/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retention: jobs are removed, their contributions stay. */
#include "store/database.h"
#include "store_audit.h"
#include "store_test.h"

#include <stdlib.h>

static int64_t retire(fixture *f, int64_t before_ms, int64_t keep, int64_t batch) {
    shear_error err = {0};
    int64_t gone = -1;
    const store_retention rule = {before_ms, keep, batch};
    FX_OK(store_retire(f->s, &rule, &gone, &err));
    return gone;
}

static bool exists(fixture *f, int64_t id) {
    shear_error err = {0};
    store_job job;
    const int code = store_job_get(f->s, id, &job, &err);
    store_job_deinit(&job);
    assert_true(code == SHEAR_OK || code == STORE_NOT_FOUND);
    return code == SHEAR_OK;
}

static void by_age(void **state) {
    fixture *f = *state;
    const int64_t one = fx_done(f, "a", "1", 1);
    const int64_t two = fx_done(f, "a", "2", 2);
    const int64_t at = f->now; /* two finished then */
    const int64_t three = fx_done(f, "a", "3", 3);
    assert_int_equal(retire(f, INT64_MIN, -1, 100), 0);
    assert_int_equal(retire(f, at, -1, 100), 1);
    assert_false(exists(f, one));
    assert_true(exists(f, two));
    assert_true(exists(f, three));
}

static void by_number_and_in_batches(void **state) {
    fixture *f = *state;
    int64_t ids[10];
    for (int i = 0; i < 10; i++) {
        char content[2] = {(char)('a' + i), '\0'};
        ids[i] = fx_done(f, "a", content, (unsigned)i);
    }
    assert_int_equal(retire(f, INT64_MIN, 10, 100), 0);
    assert_int_equal(retire(f, INT64_MIN, 4, 5), 5);
    assert_int_equal(retire(f, INT64_MIN, 4, 5), 1);
    assert_int_equal(retire(f, INT64_MIN, 4, 5), 0);
    for (int i = 0; i < 10; i++)
        assert_int_equal(exists(f, ids[i]), i >= 6);
    assert_int_equal(retire(f, INT64_MAX, 0, 0), 0);
    /* Both rules in one call share the batch. */
    assert_int_equal(retire(f, INT64_MAX, 0, 3), 3);
    assert_int_equal(retire(f, INT64_MIN, 0, 3), 1);
}

static void only_finished_ones(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    const int64_t waiting = fx_submit(f, "a");
    const store_failure passing = fx_failure(f, STORE_TRANSIENT, INT64_MAX);
    fx_next(f);
    FX_OK(store_fail(f->s, waiting, &passing, &end, &err));
    const int64_t failed = fx_submit(f, "a");
    const store_failure bad = fx_failure(f, STORE_DATA, STORE_NEVER);
    fx_next(f);
    FX_OK(store_fail(f->s, failed, &bad, &end, &err));
    const int64_t running = fx_submit(f, "a");
    fx_next(f);
    const int64_t cancelled = fx_submit(f, "a");
    FX_OK(store_cancel(f->s, cancelled, fx_now(f), &end, &err));
    const int64_t queued = fx_submit(f, "a");
    const int64_t done = fx_submit(f, "a");
    FX_OK(store_cancel(f->s, done, fx_now(f), &end, &err));
    assert_int_equal(retire(f, INT64_MAX, 0, 100), 3);
    assert_true(exists(f, waiting) && exists(f, running) && exists(f, queued));
    assert_false(exists(f, failed) || exists(f, cancelled) || exists(f, done));
}

static void what_they_contributed_stays(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_field_page page;
    store_contribution_page list;
    store_totals totals;
    char *sums = fx_sums(1);
    const int64_t first = fx_done(f, "a", "c", 1);
    assert_int_equal(retire(f, INT64_MAX, 0, 100), 1);
    FX_OK(store_field_get(f->s, "a", &page, &err));
    assert_int_equal(page.fields[0].jobs, 1);
    assert_string_equal(page.fields[0].sums, sums);
    assert_string_equal(page.fields[0].settings, "{}");
    store_field_page_deinit(&page);
    FX_OK(store_contributions(f->s, "a", "d0", 0, 10, &list, &err));
    assert_int_equal(list.n, 1);
    assert_int_equal(list.items[0].job, first);
    store_contribution_page_deinit(&list);
    /* The same file again is a duplicate of the job that is gone. */
    store_job job;
    FX_OK(store_job_get(f->s, fx_done(f, "a", "c", 1), &job, &err));
    assert_int_equal(job.outcome, STORE_DUPLICATE);
    assert_int_equal(job.duplicate_of, first);
    store_job_deinit(&job);
    FX_OK(store_total(f->s, &totals, &err));
    assert_int_equal(totals.retired, 1);
    assert_int_equal(totals.counted, 1);
    free(sums);
}

/* Settings that no job and no field has any more are forgotten: their digest may stand for another
 * text. */
static void unused_settings_go(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t id = 0;
    enum store_state end = STORE_QUEUED;
    bool known = false;
    store_spec spec = fx_spec(f, "a");
    spec.key = "k";
    FX_OK(store_submit(f->s, &spec, 10, &id, &known, &err));
    FX_OK(store_cancel(f->s, id, fx_now(f), &end, &err));
    spec.settings = "{other}";
    FX_CODE(SHEAR_E_INTERNAL,
            store_submit(
                f->s, &(store_spec){.source = "s", .settings = "{other}", .settings_digest = "d0"},
                10, &id, &known, &err));
    assert_int_equal(retire(f, INT64_MAX, -1, 10), 1);
    /* The key is free again as well. */
    FX_OK(store_submit(f->s, &spec, 10, &id, &known, &err));
    assert_false(known);
}

static int64_t rows_of_credentials(fixture *f) {
    shear_error err = {0};
    int64_t n = -1;
    FX_OK(database_number(f->s->db, "", "SELECT count(*) FROM credentials", &n, &err));
    return n;
}

/* Groups are kept once for all jobs that have the same, and go with the last of these. The same
 * key with other groups is the same request: people log in again. */
static void credentials_are_shared(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t ids[4] = {0};
    bool known = false;
    enum store_state end = STORE_QUEUED;
    const char *const groups[] = {"4 27", "4 27", "", NULL};
    for (int i = 0; i < 4; i++) {
        store_spec spec = fx_spec(f, "a");
        spec.gid = 5;
        spec.groups = groups[i];
        spec.key = i == 0 ? "k" : NULL;
        FX_OK(store_submit(f->s, &spec, 10, &ids[i], &known, &err));
    }
    assert_int_equal(rows_of_credentials(f), 2);
    store_spec again = fx_spec(f, "a");
    again.key = "k";
    again.groups = "99";
    int64_t id = 0;
    FX_OK(store_submit(f->s, &again, 10, &id, &known, &err));
    assert_true(known && id == ids[0]);
    assert_int_equal(rows_of_credentials(f), 2);
    for (int i = 0; i < 4; i++) {
        FX_OK(store_audit(f->s, &err));
        FX_OK(store_cancel(f->s, ids[i], fx_now(f), &end, &err));
        assert_int_equal(retire(f, INT64_MAX, -1, 10), 1);
        assert_int_equal(rows_of_credentials(f), i < 1 ? 2 : i < 2 ? 1 : 0);
    }
    FX_OK(store_audit(f->s, &err));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(by_age),
        STORE_TEST(by_number_and_in_batches),
        STORE_TEST(only_finished_ones),
        STORE_TEST(what_they_contributed_stays),
        STORE_TEST(unused_settings_go),
        STORE_TEST(credentials_are_shared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
