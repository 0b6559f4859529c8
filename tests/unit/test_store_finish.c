/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The end of a measured job: checkpoints, contributions, duplicates, and the exact sums of fields.
 */
#include "store_test.h"

#include <stdlib.h>
#include <string.h>

static store_finished finish(fixture *f, int64_t id, const char *sums) {
    shear_error err = {0};
    store_finished end;
    const store_work work = {.sums = sums,
                             .result = "{\"g1\":0.01}",
                             .catalog = "/out/a.csv",
                             .elapsed_us = 1500,
                             .now_ms = fx_now(f)};
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    return end;
}

static store_field_page get_field(fixture *f, const char *name) {
    shear_error err = {0};
    store_field_page page;
    FX_OK(store_field_get(f->s, name, &page, &err));
    return page;
}

static void a_finished_job_is_counted(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    store_attempts list;
    char *sums = fx_sums(4);
    const int64_t id = fx_running(f, "m31", "c");
    const store_finished end = finish(f, id, sums);
    assert_int_equal(end.state, STORE_DONE);
    assert_int_equal(end.outcome, STORE_COUNTED);
    assert_int_equal(end.duplicate_of, 0);

    FX_OK(store_job_get(f->s, id, &job, &err));
    assert_int_equal(job.state, STORE_DONE);
    assert_int_equal(job.outcome, STORE_COUNTED);
    assert_string_equal(job.result, "{\"g1\":0.01}");
    assert_string_equal(job.catalog, "/out/a.csv");
    assert_int_equal(job.elapsed_us, 1500);
    assert_int_equal(job.finished_ms, f->now);
    assert_int_equal(job.n_stamps, 16);
    assert_int_equal(job.n_used, 15); /* seed 4: one is flagged */
    store_job_deinit(&job);
    FX_OK(store_attempts_get(f->s, id, &list, &err));
    assert_int_equal(list.attempts[0].outcome, STORE_ATTEMPT_DONE);
    store_attempts_deinit(&list);

    store_field_page page = get_field(f, "m31");
    assert_int_equal(page.n, 1);
    assert_int_equal(page.unfinished, 0);
    assert_string_equal(page.fields[0].name, "m31");
    assert_string_equal(page.fields[0].settings_digest, "d0");
    assert_string_equal(page.fields[0].settings, "{}");
    assert_string_equal(page.fields[0].sums, sums);
    assert_int_equal(page.fields[0].jobs, 1);
    assert_int_equal(page.fields[0].n_stamps, 16);
    assert_int_equal(page.fields[0].n_used, 15);
    assert_int_equal(page.fields[0].updated_ms, f->now);
    store_field_page_deinit(&page);
    store_field_page_deinit(&page);
    free(sums);
}

/* Three jobs in two orders: the same text, that of the exact join. */
static void the_order_of_arrival_does_not_matter(void **state) {
    fixture *f = *state;
    char *sums[3] = {fx_sums(10), fx_sums(11), fx_sums(12)};
    char *joined = fx_join((const char *const *)sums, 3);
    static const char *const contents[] = {"c0", "c1", "c2"};
    static const int orders[2][3] = {{0, 1, 2}, {2, 0, 1}};
    static const char *const fields[] = {"first", "second"};
    for (int o = 0; o < 2; o++) {
        for (int i = 0; i < 3; i++) {
            const int which = orders[o][i];
            finish(f, fx_running(f, fields[o], contents[which]), sums[which]);
        }
        store_field_page page = get_field(f, fields[o]);
        assert_string_equal(page.fields[0].sums, joined);
        assert_int_equal(page.fields[0].jobs, 3);
        assert_int_equal(page.fields[0].n_stamps, 48);
        assert_int_equal(page.fields[0].n_used, 15 + 14 + 16);
        store_field_page_deinit(&page);
    }
    for (int i = 0; i < 3; i++)
        free(sums[i]);
    free(joined);
}

static void a_duplicate_is_not_counted(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    int64_t of = 0;
    char *sums = fx_sums(4);
    const int64_t first = fx_done(f, "a", "c", 4);
    const int64_t again = fx_submit(f, "a");
    const store_input learned = {"a", "c", 16};
    assert_int_equal(fx_next(f), again);
    FX_OK(store_set_input(f->s, again, &learned, &of, &err));
    assert_int_equal(of, first);
    /* Recognised early: no sums are needed. */
    const store_finished end = finish(f, again, NULL);
    assert_int_equal(end.state, STORE_DONE);
    assert_int_equal(end.outcome, STORE_DUPLICATE);
    assert_int_equal(end.duplicate_of, first);
    FX_OK(store_job_get(f->s, again, &job, &err));
    assert_int_equal(job.duplicate_of, first);
    assert_int_equal(job.n_stamps, 16);
    assert_int_equal(job.n_used, 15);
    store_job_deinit(&job);
    store_field_page page = get_field(f, "a");
    assert_int_equal(page.fields[0].jobs, 1);
    assert_string_equal(page.fields[0].sums, sums);
    store_field_page_deinit(&page);
    free(sums);
}

/* Two with the same identity run side by side: whoever comes second is the duplicate. */
static void of_two_at_once_one_is_counted(void **state) {
    fixture *f = *state;
    char *sums = fx_sums(4);
    const int64_t one = fx_running(f, "a", "c");
    const int64_t two = fx_running(f, "a", "c");
    assert_int_equal(finish(f, two, sums).outcome, STORE_COUNTED);
    const store_finished end = finish(f, one, sums);
    assert_int_equal(end.outcome, STORE_DUPLICATE);
    assert_int_equal(end.duplicate_of, two);
    store_field_page page = get_field(f, "a");
    assert_string_equal(page.fields[0].sums, sums);
    store_field_page_deinit(&page);
    free(sums);
}

static void another_identity_is_counted(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t id = 0;
    int64_t of = 0;
    bool known = false;
    char *sums = fx_sums(4);
    fx_done(f, "a", "c", 4);
    assert_int_equal(finish(f, fx_running(f, "b", "c"), sums).outcome, STORE_COUNTED);
    assert_int_equal(finish(f, fx_running(f, "a", "d"), sums).outcome, STORE_COUNTED);
    store_spec spec = fx_spec(f, "a");
    spec.settings = "{\"beta\":5}";
    spec.settings_digest = "d1";
    FX_OK(store_submit(f->s, &spec, 100, &id, &known, &err));
    assert_int_equal(fx_next(f), id);
    const store_input learned = {"a", "c", 16};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    assert_int_equal(of, 0);
    assert_int_equal(finish(f, id, sums).outcome, STORE_COUNTED);
    /* Kept apart by settings. */
    store_field_page page = get_field(f, "a");
    assert_int_equal(page.n, 2);
    assert_string_equal(page.fields[0].settings_digest, "d0");
    assert_int_equal(page.fields[0].jobs, 2);
    assert_string_equal(page.fields[1].settings_digest, "d1");
    assert_string_equal(page.fields[1].settings, "{\"beta\":5}");
    assert_int_equal(page.fields[1].jobs, 1);
    store_field_page_deinit(&page);
    free(sums);
}

static void force_counts_again(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t id = 0;
    int64_t of = 1;
    bool known = false;
    char *sums = fx_sums(4);
    const int64_t first = fx_done(f, "a", "c", 4);
    store_spec spec = fx_spec(f, "a");
    spec.force = true;
    FX_OK(store_submit(f->s, &spec, 100, &id, &known, &err));
    assert_int_equal(fx_next(f), id);
    const store_input learned = {"a", "c", 16};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    assert_int_equal(of, 0);
    assert_int_equal(finish(f, id, sums).outcome, STORE_COUNTED);
    const char *twice[] = {sums, sums};
    char *joined = fx_join(twice, 2);
    store_field_page page = get_field(f, "a");
    assert_int_equal(page.fields[0].jobs, 2);
    assert_string_equal(page.fields[0].sums, joined);
    store_field_page_deinit(&page);
    /* A plain one after that is a duplicate of the first. */
    assert_int_equal(finish(f, fx_running(f, "a", "c"), sums).duplicate_of, first);
    free(joined);
    free(sums);
}

static void finish_wants_all_it_needs(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_finished end;
    int64_t of = 0;
    char *sums = fx_sums(4);
    store_work work = {.sums = sums, .now_ms = fx_now(f)};
    const int64_t id = fx_submit(f, NULL);
    fx_next(f);
    FX_CODE(STORE_WRONG_STATE, store_finish(f->s, id, &work, &end, &err));
    store_input learned = {"a", NULL, -1};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    FX_CODE(STORE_WRONG_STATE, store_finish(f->s, id, &work, &end, &err));
    learned = (store_input){NULL, "c", -1};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    work.sums = NULL;
    FX_CODE(STORE_WRONG_STATE, store_finish(f->s, id, &work, &end, &err));
    work.sums = "shear-sums 1 nonsense";
    FX_CODE(SHEAR_E_INTERNAL, store_finish(f->s, id, &work, &end, &err));
    work.sums = "";
    FX_CODE(STORE_BAD_TEXT, store_finish(f->s, id, &work, &end, &err));
    char *endless = calloc(1, STORE_RESULT_MAX + 2);
    memset(endless, 'x', STORE_RESULT_MAX + 1);
    work.sums = endless;
    FX_CODE(STORE_BAD_TEXT, store_finish(f->s, id, &work, &end, &err));
    work.sums = sums;
    work.result = endless;
    FX_CODE(STORE_BAD_TEXT, store_finish(f->s, id, &work, &end, &err));
    work.result = NULL;
    work.catalog = endless;
    FX_CODE(STORE_BAD_TEXT, store_finish(f->s, id, &work, &end, &err));
    assert_int_equal(fx_state(f, id), STORE_RUNNING);
    work.catalog = NULL;
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    free(endless);
    free(sums);
}

static void learning_has_limits(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t of = 0;
    static char endless[STORE_FIELD_MAX + 2];
    memset(endless, 'x', sizeof endless - 1);
    const int64_t id = fx_running(f, "a", "c");
    store_input learned = {endless, NULL, 0};
    FX_CODE(STORE_BAD_TEXT, store_set_input(f->s, id, &learned, &of, &err));
    learned = (store_input){NULL, "", 0};
    FX_CODE(STORE_BAD_TEXT, store_set_input(f->s, id, &learned, &of, &err));
    learned = (store_input){NULL, endless, 0};
    FX_CODE(STORE_BAD_TEXT, store_set_input(f->s, id, &learned, &of, &err));
    learned = (store_input){NULL, NULL, 77};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    store_job job;
    FX_OK(store_job_get(f->s, id, &job, &err));
    assert_string_equal(job.field, "a");
    assert_string_equal(job.content, "c");
    assert_int_equal(job.n_stamps, 77);
    store_job_deinit(&job);
}

static void cancel_while_running_counts_nothing(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end_state = STORE_QUEUED;
    store_attempts list;
    store_field_page page;
    int64_t block = 0;
    char *loaded = NULL;
    char *sums = fx_sums(4);
    const int64_t id = fx_running(f, "a", "c");
    FX_OK(fx_checkpoint(f->s, id, 3, sums, &err));
    FX_OK(store_cancel(f->s, id, fx_now(f), &end_state, &err));
    const store_finished end = finish(f, id, sums);
    assert_int_equal(end.state, STORE_CANCELLED);
    assert_int_equal(end.outcome, STORE_NO_OUTCOME);
    assert_int_equal(fx_state(f, id), STORE_CANCELLED);
    FX_OK(store_attempts_get(f->s, id, &list, &err));
    assert_int_equal(list.attempts[0].outcome, STORE_ATTEMPT_CANCELLED);
    store_attempts_deinit(&list);
    FX_CODE(STORE_NOT_FOUND, store_field_get(f->s, "a", &page, &err));
    FX_CODE(STORE_NOT_FOUND, store_checkpoint_load(f->s, id, &block, &loaded, &err));
    /* And it can still be counted, once. */
    FX_OK(store_retry(f->s, id, 10, &err));
    assert_int_equal(fx_next(f), id);
    assert_int_equal(finish(f, id, sums).outcome, STORE_COUNTED);
    free(sums);
}

static void a_checkpoint_is_replaced_and_goes_with_the_end(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t block = -1;
    char *loaded = NULL;
    char *one = fx_sums(1);
    char *two = fx_sums(2);
    const int64_t id = fx_running(f, "a", "c");
    FX_CODE(STORE_NOT_FOUND, store_checkpoint_load(f->s, id, &block, &loaded, &err));
    assert_int_equal(block, 0);
    FX_OK(fx_checkpoint(f->s, id, 5, one, &err));
    FX_OK(fx_checkpoint(f->s, id, 9, two, &err));
    FX_OK(store_checkpoint_load(f->s, id, &block, &loaded, &err));
    assert_int_equal(block, 9);
    assert_string_equal(loaded, two);
    free(loaded);
    finish(f, id, one);
    FX_CODE(STORE_NOT_FOUND, store_checkpoint_load(f->s, id, &block, &loaded, &err));
    assert_null(loaded);
    free(one);
    free(two);
}

static void a_checkpoint_belongs_to_a_content(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t block = 0;
    int64_t of = 0;
    char *loaded = NULL;
    char *sums = fx_sums(1);
    const int64_t id = fx_submit(f, "a");
    fx_next(f);
    FX_CODE(STORE_WRONG_STATE, fx_checkpoint(f->s, id, 5, sums, &err));
    store_input learned = {"a", "c", 160};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    FX_OK(fx_checkpoint(f->s, id, 5, sums, &err));
    FX_OK(store_set_input(f->s, id, &learned, &of, &err)); /* the same file again */
    FX_OK(store_checkpoint_load(f->s, id, &block, &loaded, &err));
    free(loaded);
    learned.content = "d"; /* the file was changed */
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    FX_CODE(STORE_NOT_FOUND, store_checkpoint_load(f->s, id, &block, &loaded, &err));
    free(sums);
}

static void bad_checkpoints_are_refused(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    char *sums = fx_sums(1);
    const int64_t id = fx_running(f, "a", "c");
    FX_CODE(SHEAR_E_INTERNAL, fx_checkpoint(f->s, id, -1, sums, &err));
    FX_CODE(SHEAR_E_INTERNAL, fx_checkpoint(f->s, id, 1, "nonsense", &err));
    FX_CODE(STORE_BAD_TEXT, fx_checkpoint(f->s, id, 1, NULL, &err));
    free(sums);
}

static void the_file_names_the_field(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t of = 0;
    store_field_page page;
    char *sums = fx_sums(1);
    const int64_t id = fx_submit(f, NULL);
    fx_next(f);
    const store_input learned = {"learned", "c", 16};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    /* Known, unfinished, nothing counted yet. */
    page = get_field(f, "learned");
    assert_int_equal(page.n, 0);
    assert_int_equal(page.unfinished, 1);
    store_field_page_deinit(&page);
    finish(f, id, sums);
    fx_submit(f, "learned");
    page = get_field(f, "learned");
    assert_int_equal(page.n, 1);
    assert_int_equal(page.unfinished, 1);
    assert_int_equal(page.fields[0].unfinished, 1);
    store_field_page_deinit(&page);
    free(sums);
}

static void totals_follow(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    store_totals t;
    store_counts c;
    char *sums = fx_sums(4);
    finish(f, fx_running(f, "a", "c"), sums);
    finish(f, fx_running(f, "a", "c"), sums);
    const int64_t failed = fx_running(f, "a", "d");
    const store_failure bug = fx_failure(f, STORE_BUG, STORE_NEVER);
    FX_OK(store_fail(f->s, failed, &bug, &end, &err));
    const int64_t retried = fx_running(f, "b", "e");
    const store_failure passing = fx_failure(f, STORE_TRANSIENT, 1);
    FX_OK(store_fail(f->s, retried, &passing, &end, &err));
    assert_int_equal(fx_next(f), retried);
    finish(f, retried, sums);
    FX_OK(store_cancel(f->s, fx_submit(f, "a"), fx_now(f), &end, &err));
    fx_running(f, "a", "g");
    fx_close(f);
    fx_open(f);
    fx_submit(f, "a");
    FX_OK(store_total(f->s, &t, &err));
    assert_int_equal(t.submitted, 7);
    assert_int_equal(t.counted, 2);
    assert_int_equal(t.duplicates, 1);
    assert_int_equal(t.failed, 1);
    assert_int_equal(t.cancelled, 1);
    assert_int_equal(t.retired, 0);
    assert_int_equal(t.attempts, 6);
    assert_int_equal(t.interrupted, 1);
    assert_int_equal(t.failures[STORE_TRANSIENT], 1);
    assert_int_equal(t.failures[STORE_DATA], 0);
    assert_int_equal(t.failures[STORE_BUG], 1);
    assert_int_equal(t.n_stamps, 32);
    assert_int_equal(t.n_used, 30);
    assert_int_equal(t.elapsed_us, 4500);
    assert_int_equal(t.fields, 2);
    FX_OK(store_count(f->s, &c, &err));
    assert_int_equal(c.jobs[STORE_DONE], 3);
    assert_int_equal(c.jobs[STORE_FAILED], 1);
    assert_int_equal(c.jobs[STORE_CANCELLED], 1);
    assert_int_equal(c.jobs[STORE_QUEUED], 2);
    assert_int_equal(c.unfinished, 2);
    free(sums);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_finished_job_is_counted),
        STORE_TEST(the_order_of_arrival_does_not_matter),
        STORE_TEST(a_duplicate_is_not_counted),
        STORE_TEST(of_two_at_once_one_is_counted),
        STORE_TEST(another_identity_is_counted),
        STORE_TEST(force_counts_again),
        STORE_TEST(finish_wants_all_it_needs),
        STORE_TEST(learning_has_limits),
        STORE_TEST(cancel_while_running_counts_nothing),
        STORE_TEST(a_checkpoint_is_replaced_and_goes_with_the_end),
        STORE_TEST(a_checkpoint_belongs_to_a_content),
        STORE_TEST(bad_checkpoints_are_refused),
        STORE_TEST(the_file_names_the_field),
        STORE_TEST(totals_follow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
