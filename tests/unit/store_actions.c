/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store_actions.h"
#include "test.h"

char *sums_1;
char *sums_2;

void fill(fixture *f) {
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    f->now = START_MS;
    FX_OK(store_begin(f->s, &err)); /* for speed */
    fx_done(f, "a", "c1", 1);
    const int64_t failed = fx_running(f, "a", "c2");
    const store_failure bad = fx_failure(f, STORE_DATA, STORE_NEVER);
    FX_OK(store_fail(f->s, failed, &bad, &end, &err));
    const int64_t waiting = fx_running(f, "a", "c3");
    const store_failure passing = fx_failure(f, STORE_TRANSIENT, INT64_MAX);
    FX_OK(store_fail(f->s, waiting, &passing, &end, &err));
    const int64_t running = fx_running(f, "a", "c4");
    FX_OK(fx_checkpoint(f->s, running, 2, sums_2, &err));
    fx_running(f, "new", "c5");
    fx_submit(f, "a");
    FX_OK(store_commit(f->s, &err));
}

static int submit_one(store *s, const char *digest, shear_error *err) {
    int64_t id = 0;
    bool known = false;
    const store_spec spec = {.field = "b",
                             .source = "/data/b.fits",
                             .settings = "{}",
                             .settings_digest = digest,
                             .key = digest,
                             .created_ms = 2000};
    const int code = store_submit(s, &spec, 100, &id, &known, err);
    assert_true((id != 0) == (code == SHEAR_OK));
    return code;
}

int act_submit(store *s, shear_error *err) {
    return submit_one(s, "new settings", err);
}

static int act_next(store *s, shear_error *err) {
    store_job job;
    const int code = store_next(s, 2000, &job, err);
    assert_true((job.id != 0) == (code == SHEAR_OK));
    store_job_deinit(&job);
    return code;
}

static int act_learn(store *s, shear_error *err) {
    int64_t of = 0;
    const store_input learned = {"c", "changed", 32};
    return store_set_input(s, 4, &learned, &of, err);
}

/* Any terms are as good as others: of the 14 stamps that sums_2 has used. */
static const unsigned char terms[14 * SHEAR_SYMMETRY_BYTES];

static int act_checkpoint(store *s, shear_error *err) {
    const store_progress progress = {0, 7, sums_1, terms, sizeof terms / 2};
    return store_checkpoint(s, 4, &progress, err);
}

static int finish(store *s, int64_t id, shear_error *err) {
    store_finished end;
    const store_work work = {.sums = sums_2,
                             .result = "{}",
                             .catalog = "/out/c.csv",
                             .elapsed_us = 5,
                             .now_ms = 2000,
                             .account = "{}",
                             .has_truth = true,
                             .true_g1 = 0.1,
                             .terms = terms,
                             .terms_size = sizeof terms};
    const int code = store_finish(s, id, &work, &end, err);
    assert_true((end.state == STORE_DONE) == (code == SHEAR_OK));
    return code;
}

static int act_finish(store *s, shear_error *err) {
    return finish(s, 4, err);
}

static int act_finish_new_field(store *s, shear_error *err) {
    return finish(s, 5, err);
}

static int act_fail(store *s, shear_error *err) {
    enum store_state end = STORE_QUEUED;
    const store_failure f = {STORE_TRANSIENT, "io", "no room", NULL, 9000, 2000};
    return store_fail(s, 4, &f, &end, err);
}

static int act_release(store *s, shear_error *err) {
    enum store_state end = STORE_QUEUED;
    return store_release(s, 4, 2000, &end, err);
}

static int act_cancel(store *s, shear_error *err) {
    enum store_state end = STORE_QUEUED;
    return store_cancel(s, 6, 2000, &end, err);
}

static int act_retry(store *s, shear_error *err) {
    return store_retry(s, 2, 100, err);
}

static int act_retire(store *s, shear_error *err) {
    int64_t gone = 0;
    const store_retention rule = {INT64_MAX, 0, 10};
    const int code = store_retire(s, &rule, &gone, err);
    assert_true((gone > 0) == (code == SHEAR_OK));
    return code;
}

static int act_retract(store *s, shear_error *err) {
    return store_retract(s, 1, err);
}

static int forget_new_field(store *s, shear_error *err) {
    store_forgotten gone;
    const int code = store_forget(s, "new", NULL, &gone, err);
    assert_true((gone.contributions == 1) == (code == SHEAR_OK));
    return code;
}

static int leave(store *s, shear_error *err) {
    store_removal next;
    int code = store_next_removal(s, &next, err);
    if (code == SHEAR_OK)
        code = store_remove(s, &next, true, err);
    store_removal_deinit(&next);
    return code;
}

/* A group that is given up at its first failure. */
static int act_in_group(store *s, const action *parts, size_t n, shear_error *err) {
    int code = store_begin(s, err);
    for (size_t i = 0; i < n && code == SHEAR_OK; i++) {
        code = parts[i](s, err);
        if (code != SHEAR_OK) {
            store_rollback(s);
            return code;
        }
    }
    return code == SHEAR_OK ? store_commit(s, err) : code;
}

static int act_group(store *s, shear_error *err) {
    static const action parts[] = {act_finish, act_submit, act_retry, act_finish_new_field,
                                   act_retire};
    return act_in_group(s, parts, sizeof parts / sizeof parts[0], err);
}

static int act_forget(store *s, shear_error *err) {
    static const action parts[] = {act_finish_new_field, forget_new_field, leave};
    return act_in_group(s, parts, sizeof parts / sizeof parts[0], err);
}

const action actions[N_ACTIONS] = {act_checkpoint, act_learn,  act_next,    act_submit,
                                   act_release,    act_cancel, act_retry,   act_fail,
                                   act_finish,     act_retire, act_retract, act_finish_new_field,
                                   act_forget,     act_group};
