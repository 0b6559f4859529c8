/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A job's way through its states, all but the end with a result (test_store_finish.c). */
#include "store_test.h"

#include <stdlib.h>
#include <string.h>

static int64_t submit_at(fixture *f, int priority) {
    shear_error err = {0};
    int64_t id = 0;
    bool known = false;
    store_spec spec = fx_spec(f, "a");
    spec.priority = priority;
    FX_OK(store_submit(f->s, &spec, 1000, &id, &known, &err));
    return id;
}

static store_job get(fixture *f, int64_t id) {
    shear_error err = {0};
    store_job job;
    FX_OK(store_job_get(f->s, id, &job, &err));
    return job;
}

static int fail_job(fixture *f, int64_t id, int64_t retry_at_ms) {
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    const store_failure failure = fx_failure(f, STORE_TRANSIENT, retry_at_ms);
    FX_OK(store_fail(f->s, id, &failure, &end, &err));
    assert_int_equal(end, fx_state(f, id));
    return (int)end;
}

static int cancel(fixture *f, int64_t id) {
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    FX_OK(store_cancel(f->s, id, fx_now(f), &end, &err));
    assert_int_equal(end, fx_state(f, id));
    return (int)end;
}

static void the_highest_and_then_the_oldest_runs(void **state) {
    fixture *f = *state;
    const int64_t low = submit_at(f, -1);
    const int64_t old = submit_at(f, 0);
    const int64_t young = submit_at(f, 0);
    const int64_t high = submit_at(f, 9);
    assert_int_equal(fx_next(f), high);
    assert_int_equal(fx_next(f), old);
    assert_int_equal(fx_next(f), young);
    assert_int_equal(fx_next(f), low);
    assert_int_equal(fx_next(f), 0);
}

static void next_opens_an_attempt(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    store_attempts list;
    const int64_t id = submit_at(f, 0);
    FX_OK(store_next(f->s, 5000, &job, &err));
    assert_int_equal(job.id, id);
    assert_int_equal(job.state, STORE_RUNNING);
    assert_int_equal(job.started_ms, 5000);
    assert_int_equal(job.attempts, 1);
    assert_int_equal(job.attempt, 1);
    assert_string_equal(job.settings, "{}");
    store_job_deinit(&job);
    FX_OK(store_attempts_get(f->s, id, &list, &err));
    assert_int_equal(list.n, 1);
    assert_int_equal(list.attempts[0].number, 1);
    assert_int_equal(list.attempts[0].started_ms, 5000);
    assert_int_equal(list.attempts[0].ended_ms, 0);
    assert_int_equal(list.attempts[0].outcome, STORE_ATTEMPT_OPEN);
    store_attempts_deinit(&list);
    FX_CODE(STORE_NOT_FOUND, store_attempts_get(f->s, 99, &list, &err));
    assert_int_equal(list.n, 0);
}

static void a_failure_that_may_pass_waits_for_its_time(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t due = 0;
    store_job job;
    const int64_t id = submit_at(f, 0);
    FX_OK(store_next_due(f->s, &due, &err));
    assert_true(due == INT64_MAX);
    fx_next(f);
    const int64_t at = f->now + 1000;
    assert_int_equal(fail_job(f, id, at), STORE_WAITING);
    FX_OK(store_next_due(f->s, &due, &err));
    assert_int_equal(due, at);

    job = get(f, id);
    assert_int_equal(job.not_before_ms, at);
    assert_int_equal(job.failure_class, STORE_TRANSIENT);
    assert_string_equal(job.code, "io");
    assert_string_equal(job.message, "the disk is full");
    assert_string_equal(job.advice, "make room");
    assert_int_equal(job.failures, 1);
    assert_int_equal(job.finished_ms, 0);
    store_job_deinit(&job);

    FX_OK(store_next(f->s, at - 1, &job, &err));
    assert_int_equal(job.id, 0);
    FX_OK(store_next(f->s, at, &job, &err));
    assert_int_equal(job.id, id);
    assert_int_equal(job.attempts, 2);
    assert_int_equal(job.not_before_ms, 0);
    store_job_deinit(&job);
}

/* What some waiting jobs wait for has come: they run now, and the others at their time. */
static void waiting_jobs_are_hurried(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    int64_t due = 0;
    const int64_t id = submit_at(f, 0);
    fx_next(f);
    const int64_t at = f->now + 1000;
    assert_int_equal(fail_job(f, id, at), STORE_WAITING);
    FX_OK(store_retry_waiting(f->s, "disk_full", f->now, &err));
    FX_OK(store_next_due(f->s, &due, &err));
    assert_int_equal(due, at);
    FX_OK(store_retry_waiting(f->s, "io", at + 1000, &err)); /* never later than it was to run */
    FX_OK(store_next_due(f->s, &due, &err));
    assert_int_equal(due, at);
    FX_OK(store_retry_waiting(f->s, "io", f->now, &err));
    FX_OK(store_next(f->s, f->now, &job, &err));
    assert_int_equal(job.id, id);
    store_job_deinit(&job);
}

/* A waiting job that is due takes its place by priority and age, not behind the queue. */
static void due_jobs_join_the_queue(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    const int64_t old = submit_at(f, 0);
    fx_next(f);
    fail_job(f, old, f->now + 1000);
    const int64_t young = submit_at(f, 0);
    const int64_t high = submit_at(f, 1);
    FX_OK(store_next(f->s, f->now + 5000, &job, &err));
    assert_int_equal(job.id, high);
    store_job_deinit(&job);
    assert_int_equal(fx_state(f, old), STORE_QUEUED);
    assert_int_equal(fx_next(f), old);
    assert_int_equal(fx_next(f), young);
}

static void a_failure_can_be_for_good(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_attempts list;
    const int64_t id = submit_at(f, 0);
    fx_next(f);
    assert_int_equal(fail_job(f, id, STORE_NEVER), STORE_FAILED);
    store_job job = get(f, id);
    assert_int_equal(job.finished_ms, f->now);
    store_job_deinit(&job);
    FX_OK(store_attempts_get(f->s, id, &list, &err));
    assert_int_equal(list.n, 1);
    assert_int_equal(list.attempts[0].outcome, STORE_ATTEMPT_FAILED);
    assert_int_equal(list.attempts[0].ended_ms, f->now);
    assert_int_equal(list.attempts[0].failure_class, STORE_TRANSIENT);
    assert_string_equal(list.attempts[0].code, "io");
    assert_string_equal(list.attempts[0].message, "the disk is full");
    store_attempts_deinit(&list);
}

static void a_failure_is_described(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    static char endless[STORE_MESSAGE_MAX + 2];
    const int64_t id = submit_at(f, 0);
    fx_next(f);
    const store_failure good = fx_failure(f, STORE_DATA, STORE_NEVER);
    store_failure bad = good;
    bad.failure_class = STORE_NO_CLASS;
    FX_CODE(SHEAR_E_INTERNAL, store_fail(f->s, id, &bad, &end, &err));
    bad.failure_class = STORE_BUG + 1;
    FX_CODE(SHEAR_E_INTERNAL, store_fail(f->s, id, &bad, &end, &err));
    bad = good;
    bad.code = NULL;
    FX_CODE(STORE_BAD_TEXT, store_fail(f->s, id, &bad, &end, &err));
    bad = good;
    memset(endless, 'x', sizeof endless - 1);
    bad.message = endless;
    FX_CODE(STORE_BAD_TEXT, store_fail(f->s, id, &bad, &end, &err));
    bad = good;
    bad.advice = endless;
    FX_CODE(STORE_BAD_TEXT, store_fail(f->s, id, &bad, &end, &err));
    assert_int_equal(fx_state(f, id), STORE_RUNNING);
    bad.advice = NULL;
    FX_OK(store_fail(f->s, id, &bad, &end, &err));
}

static void cancel_acts_at_once_or_asks(void **state) {
    fixture *f = *state;
    const int64_t queued = submit_at(f, 0);
    assert_int_equal(cancel(f, queued), STORE_CANCELLED);
    assert_int_equal(cancel(f, queued), STORE_CANCELLED);
    const int64_t waiting = submit_at(f, 0);
    assert_int_equal(fx_next(f), waiting);
    fail_job(f, waiting, f->now + 100);
    assert_int_equal(cancel(f, waiting), STORE_CANCELLED);
    store_job job = get(f, waiting);
    assert_int_equal(job.not_before_ms, 0);
    assert_int_equal(job.finished_ms, f->now);
    store_job_deinit(&job);

    const int64_t running = submit_at(f, 0);
    assert_int_equal(fx_next(f), running);
    assert_int_equal(cancel(f, running), STORE_RUNNING);
    job = get(f, running);
    assert_true(job.cancel_asked);
    store_job_deinit(&job);
    /* A failure ends it, even one that would have been retried. */
    assert_int_equal(fail_job(f, running, f->now + 100), STORE_CANCELLED);
    job = get(f, running);
    assert_false(job.cancel_asked);
    assert_int_equal(job.not_before_ms, 0);
    assert_int_equal(job.finished_ms, f->now);
    store_job_deinit(&job);
    assert_int_equal(fx_next(f), 0);
}

static void release_queues_again(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    store_attempts list;
    const int64_t id = submit_at(f, 0);
    fx_next(f);
    FX_OK(store_release(f->s, id, fx_now(f), &end, &err));
    assert_int_equal(end, STORE_QUEUED);
    assert_int_equal(fx_next(f), id);
    FX_OK(store_attempts_get(f->s, id, &list, &err));
    assert_int_equal(list.n, 2);
    assert_int_equal(list.attempts[0].outcome, STORE_ATTEMPT_RELEASED);
    assert_int_equal(list.attempts[1].outcome, STORE_ATTEMPT_OPEN);
    store_attempts_deinit(&list);
    store_job job = get(f, id);
    assert_int_equal(job.attempts, 2);
    assert_int_equal(job.failures + job.interrupted, 0);
    store_job_deinit(&job);
    cancel(f, id);
    FX_OK(store_release(f->s, id, fx_now(f), &end, &err));
    assert_int_equal(end, STORE_CANCELLED);
}

static void retry_starts_over(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    const int64_t id = submit_at(f, 0);
    fx_next(f);
    fail_job(f, id, STORE_NEVER);
    FX_OK(store_retry(f->s, id, 10, &err));
    store_job job = get(f, id);
    assert_int_equal(job.state, STORE_QUEUED);
    assert_int_equal(job.attempts + job.failures, 0);
    assert_int_equal(job.attempt, 1); /* its history is kept */
    assert_int_equal(job.finished_ms, 0);
    assert_int_equal(job.failure_class, STORE_NO_CLASS);
    assert_null(job.code);
    assert_null(job.message);
    assert_null(job.advice);
    store_job_deinit(&job);
    assert_int_equal(fx_next(f), id);
    job = get(f, id);
    assert_int_equal(job.attempts, 1);
    assert_int_equal(job.attempt, 2);
    store_job_deinit(&job);
}

static void only_the_last_attempts_are_kept(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    store_attempts list;
    const int64_t id = submit_at(f, 0);
    for (int i = 0; i < STORE_ATTEMPTS_KEPT + 10; i++) {
        assert_int_equal(fx_next(f), id);
        FX_OK(store_release(f->s, id, fx_now(f), &end, &err));
    }
    FX_OK(store_attempts_get(f->s, id, &list, &err));
    assert_int_equal(list.n, STORE_ATTEMPTS_KEPT);
    assert_int_equal(list.attempts[0].number, 11);
    assert_int_equal(list.attempts[list.n - 1].number, STORE_ATTEMPTS_KEPT + 10);
    store_attempts_deinit(&list);
}

/* Each operation in each state: allowed exactly where the header's diagram has an arrow. */
static void wrong_states_are_refused(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_RUNNING;
    int64_t duplicate_of = 0;
    store_finished finished;
    char *sums = fx_sums(1);
    const store_input learned = {"a", "c", 1};
    const store_work work = {.sums = sums, .now_ms = fx_now(f)};
    const store_failure failure = fx_failure(f, STORE_DATA, STORE_NEVER);

    const int64_t done = fx_done(f, "a", "c0", 7);
    const int64_t failed = submit_at(f, 0);
    fx_next(f);
    fail_job(f, failed, STORE_NEVER);
    const int64_t waiting = submit_at(f, 0);
    fx_next(f);
    fail_job(f, waiting, INT64_MAX);
    const int64_t cancelled = submit_at(f, 0);
    cancel(f, cancelled);
    const int64_t running = submit_at(f, 0);
    fx_next(f);
    const int64_t queued = submit_at(f, 0);

    const int64_t idle[] = {queued, waiting, done, failed, cancelled};
    for (size_t i = 0; i < sizeof idle / sizeof idle[0]; i++) {
        FX_CODE(STORE_WRONG_STATE, store_set_input(f->s, idle[i], &learned, &duplicate_of, &err));
        FX_CODE(STORE_WRONG_STATE, fx_checkpoint(f->s, idle[i], 1, sums, &err));
        FX_CODE(STORE_WRONG_STATE, store_finish(f->s, idle[i], &work, &finished, &err));
        assert_int_equal(finished.state, 0);
        FX_CODE(STORE_WRONG_STATE, store_fail(f->s, idle[i], &failure, &end, &err));
        FX_CODE(STORE_WRONG_STATE, store_release(f->s, idle[i], 1, &end, &err));
        assert_int_equal(end, 0);
    }
    FX_CODE(STORE_WRONG_STATE, store_cancel(f->s, done, 1, &end, &err));
    FX_CODE(STORE_WRONG_STATE, store_cancel(f->s, failed, 1, &end, &err));
    FX_CODE(STORE_WRONG_STATE, store_retry(f->s, done, 100, &err));
    FX_CODE(STORE_WRONG_STATE, store_retry(f->s, queued, 100, &err));
    FX_CODE(STORE_WRONG_STATE, store_retry(f->s, running, 100, &err));
    FX_CODE(STORE_WRONG_STATE, store_retry(f->s, waiting, 100, &err));

    FX_CODE(STORE_NOT_FOUND, store_set_input(f->s, 99, &learned, &duplicate_of, &err));
    FX_CODE(STORE_NOT_FOUND, fx_checkpoint(f->s, 99, 1, sums, &err));
    FX_CODE(STORE_NOT_FOUND, store_finish(f->s, 99, &work, &finished, &err));
    FX_CODE(STORE_NOT_FOUND, store_fail(f->s, 99, &failure, &end, &err));
    FX_CODE(STORE_NOT_FOUND, store_release(f->s, 99, 1, &end, &err));
    FX_CODE(STORE_NOT_FOUND, store_cancel(f->s, 99, 1, &end, &err));
    FX_CODE(STORE_NOT_FOUND, store_retry(f->s, 99, 100, &err));
    free(sums);
}

static void a_restart_queues_what_ran(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t block = 0;
    char *loaded = NULL;
    store_attempts list;
    char *sums = fx_sums(3);
    const int64_t running = fx_running(f, "a", "c");
    FX_OK(fx_checkpoint(f->s, running, 12, sums, &err));
    const int64_t asked = submit_at(f, 0);
    fx_next(f);
    cancel(f, asked);
    const int64_t waiting = submit_at(f, 0);
    fx_next(f);
    fail_job(f, waiting, INT64_MAX);
    const int64_t queued = submit_at(f, 0);
    fx_close(f);
    fx_open(f);
    assert_int_equal(store_opened(f->s)->requeued, 1);
    assert_int_equal(store_opened(f->s)->cancelled, 1);
    assert_int_equal(fx_state(f, running), STORE_QUEUED);
    assert_int_equal(fx_state(f, asked), STORE_CANCELLED);
    assert_int_equal(fx_state(f, waiting), STORE_WAITING);
    assert_int_equal(fx_state(f, queued), STORE_QUEUED);

    FX_OK(store_attempts_get(f->s, running, &list, &err));
    assert_int_equal(list.n, 1);
    assert_int_equal(list.attempts[0].outcome, STORE_ATTEMPT_INTERRUPTED);
    assert_int_equal(list.attempts[0].ended_ms, f->now);
    store_attempts_deinit(&list);
    store_job job = get(f, running);
    assert_int_equal(job.interrupted, 1);
    assert_string_equal(job.content, "c");
    store_job_deinit(&job);
    FX_OK(store_checkpoint_load(f->s, running, &block, &loaded, &err));
    assert_int_equal(block, 12);
    assert_string_equal(loaded, sums);
    free(loaded);
    free(sums);
    assert_int_equal(fx_next(f), running);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(the_highest_and_then_the_oldest_runs),
        STORE_TEST(next_opens_an_attempt),
        STORE_TEST(a_failure_that_may_pass_waits_for_its_time),
        STORE_TEST(waiting_jobs_are_hurried),
        STORE_TEST(due_jobs_join_the_queue),
        STORE_TEST(a_failure_can_be_for_good),
        STORE_TEST(a_failure_is_described),
        STORE_TEST(cancel_acts_at_once_or_asks),
        STORE_TEST(release_queues_again),
        STORE_TEST(retry_starts_over),
        STORE_TEST(only_the_last_attempts_are_kept),
        STORE_TEST(wrong_states_are_refused),
        STORE_TEST(a_restart_queues_what_ran),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
