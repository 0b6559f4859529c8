/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A service is killed at random moments, again and again, over one database. Whatever it had
 * acknowledged is there afterwards; every done job is counted once; every field is the exact join
 * of what was counted. */
#include "store_audit.h"
#include "store_test.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LIVES = 40, ACKS_A_LIFE = 60, CONTENTS = 400, FIELDS = 4, IDS = 20000 };

/* What the service tells its clients: a job was accepted, or is done. */
typedef struct acknowledgement {
    int64_t id;
    int64_t outcome; /* STORE_NO_OUTCOME: accepted */
} acknowledgement;

typedef struct service {
    fixture *f;
    int to_clients;
    uint64_t random;
    acknowledgement pending[64]; /* told when the group is on disk */
    int n_pending;
    bool in_group;
} service;

static uint64_t draw(service *v, uint64_t n) {
    uint64_t z = v->random += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (z ^ (z >> 31)) % n;
}

/* The child must not return into the test: any error ends it in a way that its parent sees. */
static void must(int code) {
    if (code != SHEAR_OK)
        _exit(3);
}

static void tell(service *v, int64_t id, int outcome) {
    v->pending[v->n_pending++] = (acknowledgement){id, outcome};
    if (!v->in_group || v->n_pending == 64) {
        if (v->in_group) {
            must(store_commit(v->f->s, NULL));
            v->in_group = false;
        }
        const size_t size = (size_t)v->n_pending * sizeof v->pending[0];
        if (write(v->to_clients, v->pending, size) != (ssize_t)size)
            _exit(4);
        v->n_pending = 0;
    }
}

static void name_content(char out[16], uint64_t which) {
    snprintf(out, 16, "c%u", (unsigned)which);
}

static void serve_submit(service *v) {
    char source[16];
    char field[2] = {(char)('a' + draw(v, FIELDS)), '\0'};
    int64_t id = 0;
    bool known = false;
    name_content(source, draw(v, CONTENTS)); /* a job's source is its content here */
    store_spec spec = fx_spec(v->f, field);
    spec.source = source;
    spec.force = draw(v, 8) == 0;
    must(store_submit(v->f->s, &spec, 1000000, &id, &known, NULL));
    tell(v, id, STORE_NO_OUTCOME);
}

static void serve_finish(service *v, const store_job *job) {
    store_finished end;
    char *sums = fx_sums((unsigned)atoi(job->source + 1));
    const store_work work = {.sums = sums, .elapsed_us = 1, .now_ms = fx_now(v->f)};
    must(store_finish(v->f->s, job->id, &work, &end, NULL));
    free(sums);
    tell(v, job->id, (int)end.outcome);
}

static void serve_next(service *v) {
    store_job job;
    int64_t of = 0;
    enum store_state end = STORE_QUEUED;
    must(store_next(v->f->s, fx_now(v->f), &job, NULL));
    if (job.id == 0)
        return;
    const store_input learned = {NULL, job.source, 16};
    must(store_set_input(v->f->s, job.id, &learned, &of, NULL));
    if (draw(v, 4) == 0) {
        char *sums = fx_sums(0);
        must(fx_checkpoint(v->f->s, job.id, 1, sums, NULL));
        free(sums);
    }
    if (draw(v, 6) == 0) {
        must(store_release(v->f->s, job.id, fx_now(v->f), &end, NULL));
    } else if (draw(v, 10) != 0) { /* else it runs until the service dies */
        serve_finish(v, &job);
    }
    store_job_deinit(&job);
}

/* Until it is killed. */
static void serve(fixture *f, int to_clients, uint64_t seed) {
    service v = {.f = f, .to_clients = to_clients, .random = seed};
    must(store_open(&f->s, f->path, &f->options, fx_now(f), NULL));
    for (;;) {
        if (!v.in_group && draw(&v, 5) == 0) {
            must(store_begin(f->s, NULL));
            v.in_group = true;
        }
        if (draw(&v, 2) == 0) {
            serve_submit(&v);
        } else {
            serve_next(&v);
        }
        if (v.in_group && draw(&v, 6) == 0) {
            must(store_commit(f->s, NULL));
            v.in_group = false;
        }
    }
}

/* What the clients were told, over all lives. */
static signed char told[IDS]; /* -1: nothing; else the last outcome */
static int64_t highest;

static void listen_to(int from, int n) {
    acknowledgement a;
    for (int i = 0; i < n && read(from, &a, sizeof a) == (ssize_t)sizeof a; i++) {
        assert_true(a.id > 0 && a.id < IDS);
        assert_true(told[a.id] <= STORE_NO_OUTCOME); /* nobody is told twice that it is done */
        told[a.id] = (signed char)a.outcome;
        highest = a.id > highest ? a.id : highest;
    }
}

static void one_life(fixture *f, uint64_t seed) {
    int pipe_ends[2];
    int status = 0;
    assert_int_equal(pipe(pipe_ends), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        close(pipe_ends[0]);
        serve(f, pipe_ends[1], seed);
    }
    close(pipe_ends[1]);
    listen_to(pipe_ends[0], 1 + (int)(seed * 7919 % ACKS_A_LIFE));
    usleep((useconds_t)(seed * 104729 % 3000));
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    listen_to(pipe_ends[0], 1000000); /* what it still had said */
    close(pipe_ends[0]);
}

static void check_told(fixture *f) {
    shear_error err = {0};
    for (int64_t id = 1; id <= highest; id++) {
        if (told[id] >= 0) {
            store_job job;
            FX_OK(store_job_get(f->s, id, &job, &err));
            if (told[id] > STORE_NO_OUTCOME) {
                assert_int_equal(job.state, STORE_DONE);
                assert_int_equal(job.outcome, told[id]);
            }
            assert_int_not_equal(job.state, STORE_RUNNING);
            store_job_deinit(&job);
        }
    }
}

/* The field's sums against a join made here, of the sums that each counted job must have had. */
static int64_t check_field(fixture *f, const char *name) {
    shear_error err = {0};
    store_field_page page;
    store_contribution_page list = {.more = true};
    static char *texts[IDS];
    static bool counted[IDS];
    size_t n = 0;
    int64_t after = 0;
    while (list.more) {
        FX_OK(store_contributions(f->s, name, "d0", after, 100, &list, &err));
        for (size_t i = 0; i < list.n; i++) {
            const int64_t job = list.items[i].job;
            assert_false(counted[job]); /* once, in one field */
            counted[job] = true;
            texts[n++] = fx_sums((unsigned)atoi(list.items[i].content + 1));
            after = list.items[i].id;
        }
        const bool more = list.more;
        store_contribution_page_deinit(&list);
        list.more = more;
    }
    char *joined = fx_join((const char *const *)texts, n);
    FX_OK(store_field_get(f->s, name, &page, &err));
    assert_string_equal(page.fields[0].sums, joined);
    assert_int_equal(page.fields[0].jobs, n);
    store_field_page_deinit(&page);
    free(joined);
    for (size_t i = 0; i < n; i++)
        free(texts[i]);
    return (int64_t)n;
}

static void survives_being_killed(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_counts counts;
    store_totals totals;
    int64_t contributions = 0;
    memset(told, -1, sizeof told);
    fx_close(f);
    for (uint64_t life = 1; life <= LIVES; life++) {
        one_life(f, life);
        fx_open(f);
        FX_OK(store_check(f->s, &err));
        FX_OK(store_audit(f->s, &err));
        check_told(f);
        FX_OK(store_count(f->s, &counts, &err));
        assert_int_equal(counts.jobs[STORE_RUNNING], 0);
        fx_close(f);
    }
    fx_open(f);
    for (int i = 0; i < FIELDS; i++) {
        const char name[2] = {(char)('a' + i), '\0'};
        contributions += check_field(f, name);
    }
    FX_OK(store_total(f->s, &totals, &err));
    assert_int_equal(totals.counted, contributions);
    assert_true(totals.counted > 100 && totals.duplicates > 0 && totals.interrupted > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {STORE_TEST(survives_being_killed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
