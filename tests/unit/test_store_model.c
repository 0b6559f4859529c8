/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random sequences of every operation, groups and restarts among them, on the store and on a model
 * of it: same replies, same state. */
#include "store_audit.h"
#include "store_model.h"
#include "store_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 4000, COMPARE_EVERY = 150, MAX_UNFINISHED = 25 };

static const char *const fields[] = {"alpha", "beta", "gamma"};
static const char *const contents[] = {"c0", "c1", "c2", "c3", "c4", "c5", "c6", "c7"};
static const char *const settings[] = {"{0}", "{1}"};
static const char *const digests[] = {"d0", "d1"};
static const char *const keys[] = {"k0", "k1", "k2", "k3", "k4"};
enum { FIELDS = 3, CONTENTS = 8, SETTINGS = 2, KEYS = 5 };

typedef struct pair {
    fixture f;
    model *m;     /* as it is */
    model *saved; /* as it was when the group began */
    bool in_group;
    uint64_t random;
    char *sums[CONTENTS][SETTINGS];
} pair;

static int64_t draw(pair *p, int64_t n) {
    uint64_t z = p->random += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (int64_t)((z ^ (z >> 31)) % (uint64_t)n);
}

/* MODEL_NONE once in a while. */
static int draw_or_none(pair *p, int n) {
    return draw(p, 5) == 0 ? MODEL_NONE : (int)draw(p, n);
}

static const char *name_of(const char *const *names, int which) {
    return which == MODEL_NONE ? NULL : names[which];
}

/* A job in the wanted state mostly; else any id, or one that does not exist. */
static int64_t pick(pair *p, int state) {
    const int64_t start = 1 + draw(p, p->m->n_jobs + 2);
    if (draw(p, 10) == 0)
        return start;
    for (int64_t i = 0; i <= p->m->n_jobs; i++) {
        const int64_t id = 1 + (start + i) % (p->m->n_jobs + 1);
        if (id <= p->m->n_jobs && p->m->jobs[id].kept && p->m->jobs[id].state == state)
            return id;
    }
    return start;
}

static void do_submit(pair *p) {
    shear_error err = {0};
    int64_t id[2];
    bool known[2];
    const model_job job = {.priority = (int)draw(p, 3) - 1,
                           .owner = (int)draw(p, 2),
                           .asked = draw_or_none(p, FIELDS),
                           .settings = (int)draw(p, SETTINGS),
                           .key = draw(p, 3) == 0 ? (int)draw(p, KEYS) : MODEL_NONE,
                           .force = draw(p, 10) == 0};
    const store_spec spec = {.field = name_of(fields, job.asked),
                             .source = "/data/a.fits",
                             .settings = settings[job.settings],
                             .settings_digest = digests[job.settings],
                             .key = name_of(keys, job.key),
                             .priority = job.priority,
                             .force = job.force,
                             .owner = (uint32_t)job.owner,
                             .created_ms = fx_now(&p->f)};
    const int code = model_submit(p->m, &job, &id[0], &known[0]);
    FX_CODE(code, store_submit(p->f.s, &spec, MAX_UNFINISHED, &id[1], &known[1], &err));
    assert_int_equal(id[0], id[1]);
    assert_int_equal(known[0], known[1]);
}

static void do_next(pair *p) {
    shear_error err = {0};
    store_job job;
    const int64_t now = fx_now(&p->f);
    const int64_t id = model_next(p->m, now);
    FX_OK(store_next(p->f.s, now, &job, &err));
    assert_int_equal(job.id, id);
    store_job_deinit(&job);
}

static void do_learn(pair *p) {
    shear_error err = {0};
    int64_t of[2];
    const int64_t id = pick(p, STORE_RUNNING);
    const int field = draw_or_none(p, FIELDS);
    const int content = draw_or_none(p, CONTENTS);
    const store_input learned = {name_of(fields, field), name_of(contents, content), 16};
    FX_CODE(model_learn(p->m, id, field, content, &of[0]),
            store_set_input(p->f.s, id, &learned, &of[1], &err));
    assert_int_equal(of[0], of[1]);
}

static void do_checkpoint(pair *p) {
    shear_error err = {0};
    const int64_t id = pick(p, STORE_RUNNING);
    const int64_t block = draw(p, 100);
    FX_CODE(model_checkpoint(p->m, id, block),
            fx_checkpoint(p->f.s, id, block, p->sums[0][0], &err));
}

static void do_finish(pair *p) {
    shear_error err = {0};
    store_finished end[2];
    const int64_t id = pick(p, STORE_RUNNING);
    const bool given = draw(p, 10) != 0;
    const model_job *job = &p->m->jobs[id <= p->m->n_jobs ? id : 0];
    const int content = job->content > 0 ? job->content : 0;
    const int64_t now = fx_now(&p->f);
    const store_work work = {
        .sums = given ? p->sums[content][job->settings] : NULL, .elapsed_us = 7, .now_ms = now};
    FX_CODE(model_finish(p->m, id, given, now, &end[0]),
            store_finish(p->f.s, id, &work, &end[1], &err));
    assert_memory_equal(&end[0], &end[1], sizeof end[0]);
}

static void do_fail(pair *p) {
    shear_error err = {0};
    enum store_state end[2];
    const int64_t id = pick(p, STORE_RUNNING);
    const int64_t retry = draw(p, 2) == 0 ? STORE_NEVER : p->f.now + draw(p, 30);
    const int class = 1 + (int)draw(p, 3);
    const store_failure failure = fx_failure(&p->f, class, retry);
    FX_CODE(model_fail(p->m, id, class, retry, failure.now_ms, &end[0]),
            store_fail(p->f.s, id, &failure, &end[1], &err));
    assert_int_equal(end[0], end[1]);
}

static void do_release(pair *p) {
    shear_error err = {0};
    enum store_state end[2];
    const int64_t id = pick(p, STORE_RUNNING);
    const int64_t now = fx_now(&p->f);
    FX_CODE(model_put_back(p->m, id, false, now, &end[0]),
            store_release(p->f.s, id, now, &end[1], &err));
    assert_int_equal(end[0], end[1]);
}

static void do_cancel(pair *p) {
    shear_error err = {0};
    enum store_state end[2];
    const int64_t id = pick(p, (int)draw(p, STORE_N_STATES));
    const int64_t now = fx_now(&p->f);
    FX_CODE(model_cancel(p->m, id, now, &end[0]), store_cancel(p->f.s, id, now, &end[1], &err));
    assert_int_equal(end[0], end[1]);
}

static void do_retry(pair *p) {
    shear_error err = {0};
    const int64_t id = pick(p, draw(p, 2) == 0 ? STORE_FAILED : STORE_CANCELLED);
    FX_CODE(model_retry(p->m, id), store_retry(p->f.s, id, MAX_UNFINISHED, &err));
}

static void do_retract(pair *p) {
    shear_error err = {0};
    const int64_t id = pick(p, draw(p, 8) == 0 ? STORE_RETRACTED : STORE_DONE);
    FX_CODE(model_retract(p->m, id), store_retract(p->f.s, id, &err));
}

static void do_forget(pair *p) {
    shear_error err = {0};
    model_forgotten wanted;
    store_forgotten gone;
    const int field = (int)draw(p, FIELDS);
    const int which = draw_or_none(p, SETTINGS);
    FX_CODE(model_forget(p->m, field, which, &wanted),
            store_forget(p->f.s, fields[field], name_of(digests, which), &gone, &err));
    assert_int_equal(gone.rows, wanted.rows);
    assert_int_equal(gone.contributions, wanted.contributions);
    assert_int_equal(fx_leave(&p->f, INT64_MAX), wanted.jobs);
}

static void do_retire(pair *p) {
    shear_error err = {0};
    int64_t gone = 0;
    const store_retention rule = {draw(p, 2) == 0 ? INT64_MIN : p->f.now - draw(p, 2000),
                                  draw(p, 2) == 0 ? -1 : draw(p, 100), draw(p, 8)};
    const int64_t wanted = model_retire(p->m, &rule);
    FX_OK(store_retire(p->f.s, &rule, &gone, &err));
    assert_int_equal(gone, wanted);
}

static void do_group(pair *p) {
    shear_error err = {0};
    if (!p->in_group) {
        FX_OK(store_begin(p->f.s, &err));
        *p->saved = *p->m;
    } else if (draw(p, 3) != 0) {
        FX_OK(store_commit(p->f.s, &err));
    } else {
        store_rollback(p->f.s);
        *p->m = *p->saved;
    }
    p->in_group = !p->in_group;
}

static void do_restart(pair *p) {
    fx_close(&p->f);
    if (p->in_group) {
        *p->m = *p->saved;
        p->in_group = false;
    }
    fx_open(&p->f);
    model_restart(p->m, p->f.now);
}

typedef struct weighed {
    void (*action)(pair *p);
    int weight; /* in 1000 */
} weighed;

static const weighed actions[] = {
    {do_submit, 220}, {do_next, 195},   {do_learn, 170},  {do_checkpoint, 40}, {do_finish, 130},
    {do_fail, 65},    {do_release, 20}, {do_cancel, 40},  {do_retry, 35},      {do_retire, 20},
    {do_group, 41},   {do_restart, 4},  {do_retract, 18}, {do_forget, 2},
};

static void step(pair *p) {
    int64_t dice = draw(p, 1000);
    const weighed *w = actions;
    while (dice >= w->weight) {
        dice -= w->weight;
        w++;
    }
    w->action(p);
}

static void compare_text(const char *text, const char *wanted) {
    assert_int_equal(text == NULL, wanted == NULL);
    if (text != NULL)
        assert_string_equal(text, wanted);
}

static void compare_checkpoint(pair *p, int64_t id, const model_job *wanted) {
    shear_error err = {0};
    int64_t block = 0;
    char *sums = NULL;
    const bool there = wanted->kept && wanted->checkpoint != MODEL_NONE;
    FX_CODE(there ? SHEAR_OK : STORE_NOT_FOUND,
            store_checkpoint_load(p->f.s, id, &block, &sums, &err));
    if (there) {
        assert_int_equal(block, wanted->checkpoint);
        assert_string_equal(sums, p->sums[0][0]);
    }
    free(sums);
}

static void compare_job(pair *p, int64_t id) {
    shear_error err = {0};
    store_job job;
    const model_job *w = &p->m->jobs[id];
    FX_CODE(w->kept ? SHEAR_OK : STORE_NOT_FOUND, store_job_get(p->f.s, id, &job, &err));
    if (w->kept) {
        assert_int_equal(job.state, w->state);
        assert_int_equal(job.outcome, w->outcome);
        assert_int_equal(job.cancel_asked, w->cancel_asked);
        assert_int_equal(job.attempts, w->attempts);
        assert_int_equal(job.failures, w->failures);
        assert_int_equal(job.interrupted, w->interrupted);
        assert_int_equal(job.attempt, w->attempt);
        assert_int_equal(job.started_ms, w->started_ms);
        assert_int_equal(job.finished_ms, w->finished_ms);
        assert_int_equal(job.not_before_ms, w->not_before_ms);
        assert_int_equal(job.duplicate_of, w->duplicate_of);
        compare_text(job.field, name_of(fields, w->field));
        compare_text(job.content, name_of(contents, w->content));
        compare_text(job.settings, settings[w->settings]);
    }
    store_job_deinit(&job);
    compare_checkpoint(p, id, w);
}

static void compare_field(pair *p, int field, int which) {
    shear_error err = {0};
    store_field_page page;
    const char *texts[MODEL_JOBS];
    size_t n = 0;
    for (int64_t i = 0; i < p->m->n_contributions; i++) {
        const model_contribution *c = &p->m->contributions[i];
        if (c->field == field && c->settings == which)
            texts[n++] = p->sums[c->content][which];
    }
    if (n == 0)
        return;
    FX_OK(store_field_get(p->f.s, fields[field], &page, &err));
    const store_field *f = page.fields;
    while (strcmp(f->settings_digest, digests[which]) != 0) {
        f++;
        assert_true(f < page.fields + page.n);
    }
    char *joined = fx_join(texts, n);
    assert_string_equal(f->sums, joined);
    assert_int_equal(f->jobs, n);
    free(joined);
    store_field_page_deinit(&page);
}

static void compare_numbers(pair *p) {
    shear_error err = {0};
    store_counts counts;
    store_totals t;
    const store_totals *w = &p->m->totals;
    int64_t jobs[STORE_N_STATES] = {0};
    for (int64_t id = 1; id <= p->m->n_jobs; id++)
        jobs[p->m->jobs[id].state] += p->m->jobs[id].kept;
    FX_OK(store_count(p->f.s, &counts, &err));
    assert_memory_equal(counts.jobs, jobs, sizeof jobs);
    FX_OK(store_total(p->f.s, &t, &err));
    assert_int_equal(t.submitted, w->submitted);
    assert_int_equal(t.counted, w->counted);
    assert_int_equal(t.duplicates, w->duplicates);
    assert_int_equal(t.failed, w->failed);
    assert_int_equal(t.cancelled, w->cancelled);
    assert_int_equal(t.retired, w->retired);
    assert_int_equal(t.attempts, w->attempts);
    assert_int_equal(t.interrupted, w->interrupted);
    assert_int_equal(t.retracted, w->retracted);
    assert_memory_equal(t.failures, w->failures, sizeof t.failures);
}

static void compare(pair *p) {
    shear_error err = {0};
    for (int64_t id = 1; id <= p->m->n_jobs; id++)
        compare_job(p, id);
    for (int field = 0; field < FIELDS; field++) {
        for (int which = 0; which < SETTINGS; which++)
            compare_field(p, field, which);
    }
    compare_numbers(p);
    FX_OK(store_audit(p->f.s, &err));
}

static pair *pair_new(fixture *f, uint64_t seed) {
    pair *p = calloc(1, sizeof *p);
    p->f = *f;
    p->m = calloc(1, sizeof *p->m);
    p->saved = calloc(1, sizeof *p->saved);
    p->m->max_unfinished = MAX_UNFINISHED;
    p->random = seed;
    for (int c = 0; c < CONTENTS; c++) {
        for (int s = 0; s < SETTINGS; s++)
            p->sums[c][s] = fx_sums((unsigned)(10 * c + s));
    }
    return p;
}

static void pair_free(pair *p, fixture *f) {
    *f = p->f;
    for (int c = 0; c < CONTENTS; c++) {
        for (int s = 0; s < SETTINGS; s++)
            free(p->sums[c][s]);
    }
    free(p->m);
    free(p->saved);
    free(p);
}

/* A walk that stays in a corner proves nothing: everything must have happened. */
static void check_variety(const model *m) {
    const store_totals *t = &m->totals;
    assert_true(t->counted > 50 && t->duplicates > 20 && t->failed > 20 && t->cancelled > 20);
    assert_true(t->retired > 20 && t->interrupted > 5 && t->retracted > 10);
    assert_true(t->failures[1] > 10 && t->failures[2] > 10 && t->failures[3] > 10);
}

static void walk(void **state, uint64_t seed) {
    pair *p = pair_new(*state, seed);
    for (int i = 1; i <= STEPS; i++) {
        step(p);
        if (i % COMPARE_EVERY == 0)
            compare(p);
    }
    check_variety(p->m);
    do_restart(p);
    compare(p);
    pair_free(p, *state);
}

static void walk_1(void **state) {
    walk(state, 1);
}

static void walk_2(void **state) {
    walk(state, 20260101);
}

int main(void) {
    const struct CMUnitTest tests[] = {STORE_TEST(walk_1), STORE_TEST(walk_2)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
