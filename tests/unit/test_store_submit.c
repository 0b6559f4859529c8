/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a job is submitted: its record, its limits, its key, the queue's bound. */
#include "store_test.h"

#include <stdlib.h>
#include <string.h>

enum { MANY = 1000000 };

static int64_t submit(fixture *f, const store_spec *spec, int wanted, bool want_known) {
    shear_error err = {0};
    int64_t id = -1;
    bool known = !want_known;
    FX_CODE(wanted, store_submit(f->s, spec, MANY, &id, &known, &err));
    assert_int_equal(known, want_known);
    assert_true((id > 0) == (wanted == SHEAR_OK));
    return id;
}

static void keeps_what_was_asked(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    const store_spec spec = {.field = "f",
                             .source = "/data/\xff odd 'name'; --",
                             .settings = "{\"beta\":4}",
                             .settings_digest = "digest",
                             .key = "k",
                             .origin = STORE_SPOOL,
                             .priority = -7,
                             .force = true,
                             .owner = 4294967295u,
                             .gid = 4294967294u,
                             .groups = "0 1 4294967294",
                             .created_ms = 123456789012345};
    const int64_t id = submit(f, &spec, SHEAR_OK, false);
    fx_close(f);
    fx_open(f);
    FX_OK(store_job_get(f->s, id, &job, &err));
    assert_int_equal(job.id, id);
    assert_int_equal(job.state, STORE_QUEUED);
    assert_int_equal(job.outcome, STORE_NO_OUTCOME);
    assert_string_equal(job.field, spec.field);
    assert_string_equal(job.source, spec.source);
    assert_string_equal(job.settings, spec.settings);
    assert_string_equal(job.settings_digest, spec.settings_digest);
    assert_string_equal(job.key, spec.key);
    assert_int_equal(job.origin, spec.origin);
    assert_int_equal(job.priority, spec.priority);
    assert_true(job.force);
    assert_false(job.cancel_asked);
    assert_true(job.owner == spec.owner);
    assert_true(job.gid == spec.gid);
    assert_string_equal(job.groups, spec.groups);
    assert_true(job.created_ms == spec.created_ms);
    assert_int_equal(job.attempts + job.failures + job.interrupted + job.attempt, 0);
    assert_int_equal(job.started_ms + job.finished_ms + job.not_before_ms, 0);
    assert_int_equal(job.n_stamps, -1);
    assert_int_equal(job.n_used, -1);
    assert_int_equal(job.failure_class, STORE_NO_CLASS);
    assert_null(job.content);
    assert_null(job.code);
    assert_null(job.message);
    assert_null(job.advice);
    assert_null(job.result);
    assert_null(job.catalog);
    store_job_deinit(&job);
    store_job_deinit(&job); /* twice is allowed */
}

static void a_field_and_a_key_may_be_missing(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    FX_OK(store_job_get(f->s, fx_submit(f, NULL), &job, &err));
    assert_null(job.field);
    assert_null(job.key);
    store_job_deinit(&job);
    FX_CODE(STORE_NOT_FOUND, store_job_get(f->s, 99, &job, &err));
    assert_null(job.source);
}

static void ids_grow_and_never_return(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state last_state = STORE_QUEUED;
    int64_t gone = 0;
    const int64_t first = fx_submit(f, "a");
    const int64_t second = fx_submit(f, "a");
    assert_true(second > first);
    FX_OK(store_cancel(f->s, second, fx_now(f), &last_state, &err));
    const store_retention all = {INT64_MAX, -1, 100};
    FX_OK(store_retire(f->s, &all, &gone, &err));
    assert_int_equal(gone, 1);
    fx_close(f);
    fx_open(f);
    assert_true(fx_submit(f, "a") > second);
}

/* A text of n letters. */
static const char *letters(size_t n) {
    static char text[STORE_RESULT_MAX + 2];
    memset(text, 'x', n);
    text[n] = '\0';
    return text;
}

static void texts_have_limits(void **state) {
    fixture *f = *state;
    for (int longer = 0; longer <= 1; longer++) {
        const size_t more = (size_t)longer;
        const int wanted = longer != 0 ? STORE_BAD_TEXT : SHEAR_OK;
        store_spec spec = fx_spec(f, letters(STORE_FIELD_MAX + more));
        submit(f, &spec, wanted, false);
        spec = fx_spec(f, "a");
        spec.source = letters(STORE_SOURCE_MAX + more);
        submit(f, &spec, wanted, false);
        spec = fx_spec(f, "a");
        spec.settings_digest = "long";
        spec.settings = letters(STORE_SETTINGS_MAX + more);
        submit(f, &spec, wanted, false);
        spec = fx_spec(f, "a");
        spec.settings_digest = letters(STORE_DIGEST_MAX + more);
        submit(f, &spec, wanted, false);
        spec = fx_spec(f, "a");
        spec.key = letters(STORE_KEY_MAX + more);
        submit(f, &spec, wanted, false);
    }
}

static void texts_are_not_empty(void **state) {
    fixture *f = *state;
    const store_spec good = fx_spec(f, "a");
    store_spec spec = good;
    spec.field = "";
    submit(f, &spec, STORE_BAD_TEXT, false);
    spec = good;
    spec.source = "";
    submit(f, &spec, STORE_BAD_TEXT, false);
    spec.source = NULL;
    submit(f, &spec, STORE_BAD_TEXT, false);
    spec = good;
    spec.settings = NULL;
    submit(f, &spec, STORE_BAD_TEXT, false);
    spec = good;
    spec.settings_digest = "";
    submit(f, &spec, STORE_BAD_TEXT, false);
    spec = good;
    spec.key = "";
    submit(f, &spec, STORE_BAD_TEXT, false);
}

static void a_key_finds_its_job_again(void **state) {
    fixture *f = *state;
    store_spec spec = fx_spec(f, "a");
    spec.key = "k1";
    const int64_t id = submit(f, &spec, SHEAR_OK, false);
    spec.created_ms += 1000; /* a repeated request comes later */
    assert_int_equal(submit(f, &spec, SHEAR_OK, true), id);
    fx_next(f);
    fx_close(f);
    fx_open(f);
    assert_int_equal(submit(f, &spec, SHEAR_OK, true), id);

    spec.owner++; /* another owner's key is another key */
    const int64_t other = submit(f, &spec, SHEAR_OK, false);
    assert_int_not_equal(other, id);
    spec.key = "k2";
    assert_int_not_equal(submit(f, &spec, SHEAR_OK, false), other);
    spec.key = NULL;
    submit(f, &spec, SHEAR_OK, false);
    submit(f, &spec, SHEAR_OK, false);
}

static void a_key_is_for_one_request(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_totals totals;
    store_spec spec = fx_spec(f, "a");
    spec.key = "k";
    submit(f, &spec, SHEAR_OK, false);
    const store_spec same = spec;
    spec.field = NULL;
    submit(f, &spec, STORE_KEY_REUSED, false);
    spec = same;
    spec.field = "b";
    submit(f, &spec, STORE_KEY_REUSED, false);
    spec = same;
    spec.source = "/data/b.fits";
    submit(f, &spec, STORE_KEY_REUSED, false);
    spec = same;
    spec.settings_digest = "d1";
    spec.settings = "{1}";
    submit(f, &spec, STORE_KEY_REUSED, false);
    spec = same;
    spec.priority = 1;
    submit(f, &spec, STORE_KEY_REUSED, false);
    spec = same;
    spec.origin = STORE_SPOOL;
    submit(f, &spec, STORE_KEY_REUSED, false);
    spec = same;
    spec.force = true;
    submit(f, &spec, STORE_KEY_REUSED, false);
    submit(f, &same, SHEAR_OK, true);
    FX_OK(store_total(f->s, &totals, &err));
    assert_int_equal(totals.submitted, 1);
}

/* What is learned later does not make the same request another one. */
static void a_key_compares_what_was_asked(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t duplicate_of = 0;
    store_spec spec = fx_spec(f, NULL);
    spec.key = "k";
    const int64_t id = submit(f, &spec, SHEAR_OK, false);
    const store_input learned = {"a", "c", 16};
    assert_int_equal(fx_next(f), id);
    FX_OK(store_set_input(f->s, id, &learned, &duplicate_of, &err));
    assert_int_equal(submit(f, &spec, SHEAR_OK, true), id);
    spec.field = "a";
    submit(f, &spec, STORE_KEY_REUSED, false);
}

static void a_digest_stands_for_one_text(void **state) {
    fixture *f = *state;
    store_spec spec = fx_spec(f, "a");
    submit(f, &spec, SHEAR_OK, false);
    spec.settings = "{other}";
    submit(f, &spec, SHEAR_E_INTERNAL, false);
    spec.settings_digest = "d1";
    submit(f, &spec, SHEAR_OK, false);
}

static void the_queue_is_bounded(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t id = 0;
    bool known = false;
    enum store_state end = STORE_QUEUED;
    store_spec spec = fx_spec(f, "a");
    spec.key = "k0";
    FX_OK(store_submit(f->s, &spec, 3, &id, &known, &err));
    const store_spec first = spec;
    spec.key = NULL;
    FX_OK(store_submit(f->s, &spec, 3, &id, &known, &err));
    const int64_t running = fx_next(f);
    FX_OK(store_submit(f->s, &spec, 3, &id, &known, &err));
    /* One running, two queued; then one waiting. */
    FX_CODE(STORE_QUEUE_FULL, store_submit(f->s, &spec, 3, &id, &known, &err));
    const store_failure failure = fx_failure(f, STORE_TRANSIENT, f->now + 100);
    FX_OK(store_fail(f->s, running, &failure, &end, &err));
    FX_CODE(STORE_QUEUE_FULL, store_submit(f->s, &spec, 3, &id, &known, &err));
    assert_int_equal(id, 0);
    /* A known job is found in a full queue, too. */
    FX_OK(store_submit(f->s, &first, 3, &id, &known, &err));
    assert_true(known);
    assert_int_equal(id, running);
    FX_OK(store_cancel(f->s, running, fx_now(f), &end, &err));
    FX_CODE(STORE_QUEUE_FULL, store_retry(f->s, running, 2, &err));
    FX_OK(store_retry(f->s, running, 3, &err));
    FX_CODE(STORE_QUEUE_FULL, store_submit(f->s, &spec, 3, &id, &known, &err));
    FX_CODE(STORE_QUEUE_FULL, store_submit(f->s, &spec, 0, &id, &known, &err));
    FX_OK(store_submit(f->s, &spec, 4, &id, &known, &err));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(keeps_what_was_asked),         STORE_TEST(a_field_and_a_key_may_be_missing),
        STORE_TEST(ids_grow_and_never_return),    STORE_TEST(texts_have_limits),
        STORE_TEST(texts_are_not_empty),          STORE_TEST(a_key_finds_its_job_again),
        STORE_TEST(a_key_is_for_one_request),     STORE_TEST(a_key_compares_what_was_asked),
        STORE_TEST(a_digest_stands_for_one_text), STORE_TEST(the_queue_is_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
