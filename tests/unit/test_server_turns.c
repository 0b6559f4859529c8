/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose turn it is, deferred work, and the common budget of unread replies. */
#include "server_fixture.h"

#include "server/users.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- users ---- */

enum { PEOPLE = 5, EACH = 7 };

/* Work of random length: whoever is next has had the least time of the ready, its user first; and
 * in the end all that always wanted some have had the same, but for one piece. */
static void test_least_time_first(void **state) {
    (void)state;
    static connection all[PEOPLE][EACH];
    const uint64_t longest = 5000000;
    server_user_list users = TAILQ_HEAD_INITIALIZER(users);
    uint64_t clock = 0;
    unsigned seed = 7;
    memset(all, 0, sizeof all);
    for (int u = 0; u < PEOPLE; u++) {
        for (int i = 0; i < EACH; i++) {
            all[u][i].user = users_join(&users, (uid_t)u, clock);
            assert_non_null(all[u][i].user);
            users_add_ready(all[u][i].user, &all[u][i], clock);
        }
    }
    for (int n = 0; n < 20000; n++) {
        connection *c = users_next(&users, &clock);
        for (int u = 0; u < PEOPLE; u++)
            assert_true(all[u][0].user->used_ns >= c->user->used_ns);
        for (size_t i = 0; i < c->user->n; i++) {
            assert_true(c->user->ready[i]->used_ns >= c->used_ns);
            assert_int_equal(c->user->ready[i]->place, i + 1);
        }
        seed = seed * 1103515245u + 12345u;
        users_charge(c, seed % longest);
        users_add_ready(c->user, c, clock);
    }
    for (int u = 0; u < PEOPLE; u++) {
        assert_true(all[u][0].user->used_ns - clock <= longest);
        for (int i = 0; i < EACH; i++) {
            assert_true(all[u][i].used_ns + longest >= all[u][0].used_ns);
            users_remove_ready(all[u][i].user, &all[u][i]);
            users_part(&users, all[u][i].user);
        }
    }
    assert_true(TAILQ_EMPTY(&users));
}

/* Whoever was quiet comes first, but has saved up no more than the credit. */
static void test_quiet_ones_come_first(void **state) {
    (void)state;
    connection busy = {0};
    connection quiet = {0};
    server_user_list users = TAILQ_HEAD_INITIALIZER(users);
    uint64_t clock = 0;
    busy.user = users_join(&users, 1, clock);
    quiet.user = users_join(&users, 2, clock);
    for (int n = 0; n < 1000; n++) {
        users_add_ready(busy.user, &busy, clock);
        assert_ptr_equal(users_next(&users, &clock), &busy);
        users_charge(&busy, 1000000);
    }
    users_add_ready(busy.user, &busy, clock);
    uint64_t had = 0;
    for (;;) {
        users_add_ready(quiet.user, &quiet, clock);
        if (users_next(&users, &clock) != &quiet)
            break;
        users_charge(&quiet, 10000);
        had += 10000;
    }
    assert_in_range(had, USERS_CREDIT_NS / 2, 3 * USERS_CREDIT_NS);
    users_remove_ready(quiet.user, &quiet);
    users_part(&users, busy.user);
    users_part(&users, quiet.user);
}

/* ---- deferred work ---- */

/* `fields` takes STEPS steps and then replies with reply_bytes; `wait` pauses until it is woken,
 * and is then answered; `metrics` is answered at once with a byte. */
enum { STEPS = 3 };

typedef struct job {
    fixture *f;
    server_handle to;
    int method, steps;
} job;

static int n_jobs;              /* that are kept */
static server_handle order[64]; /* [n_order] of their first steps */
static size_t n_order;

static void reply_text(fixture *f, server_handle to, size_t n) {
    char *line = malloc(n + 64);
    assert_non_null(line);
    const int head = snprintf(line, 64, "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{\"x\":\"");
    memset(line + head, 'x', n);
    memcpy(line + head + n, "\"}}\n", 4);
    server_reply_line(f->s, to, line, (size_t)head + n + 4);
}

/* Work that outweighs all that a request costs besides. */
static void toil(void) {
    const clock_t end = clock() + CLOCKS_PER_SEC / 2000;
    while (clock() < end) {
    }
}

static enum server_step job_step(void *context) {
    job *j = context;
    toil();
    if (j->steps++ == 0 && n_order < 64)
        order[n_order++] = j->to;
    if (j->method == SHEARD_METHOD_WAIT && j->steps == 1)
        return SERVER_PAUSE;
    if (j->steps < STEPS)
        return SERVER_MORE;
    reply_text(j->f, j->to, j->f->reply_bytes);
    assert_false(fx_is_open(j->f, j->to));
    return SERVER_PAUSE;
}

static void job_drop(void *context) {
    n_jobs--;
    free(context);
}

static void on_request(void *context, const server_request *r) {
    fixture *f = context;
    const int method = r->request->method;
    if (f->n < FX_REQUESTS)
        f->handles[f->n] = r->handle;
    f->n++;
    if (method == SHEARD_METHOD_METRICS) {
        reply_text(f, r->handle, 1);
        return;
    }
    job *j = malloc(sizeof *j);
    assert_non_null(j);
    *j = (job){.f = f, .to = r->handle, .method = method};
    n_jobs++;
    const server_work work = {job_step, job_drop, j};
    assert_true(server_defer(f->s, r->handle, &work));
}

static int setup(void **state) {
    fx_setup(state);
    fixture *f = *state;
    f->options.handlers.request = on_request;
    n_jobs = 0;
    n_order = 0;
    return 0;
}

static int teardown(void **state) {
    fx_teardown(state);
    assert_int_equal(n_jobs, 0);
    return 0;
}

static void ask(fixture *f, client *c, const char *method) {
    cl_say(f, c, request_text(1, method, strcmp(method, "wait") == 0 ? "{\"ids\":[1]}" : NULL));
}

static void test_paused_and_woken(void **state) {
    fixture *f = *state;
    client c;
    fx_open(f);
    cl_connect(f, &c);
    ask(f, &c, "wait");
    FX_UNTIL(f, n_order == 1);
    ask(f, &c, "metrics"); /* what is paused holds up nothing */
    cl_reply(f, &c);
    assert_int_equal(n_jobs, 1);
    server_wake(f->s, f->handles[0]);
    server_wake(f->s, f->handles[0]);
    cl_reply(f, &c);
    FX_UNTIL(f, n_jobs == 0);
    server_wake(f->s, f->handles[0]); /* gone */
    cl_close(&c);
}

/* One after the other, and the next request of a connection comes behind those of the others:
 * nobody has all three done before another has one. */
static void test_one_at_a_time(void **state) {
    fixture *f = *state;
    client clients[4];
    fx_open(f);
    for (int i = 0; i < 4; i++) {
        cl_connect(f, &clients[i]);
        ask(f, &clients[i], "metrics");
        cl_reply(f, &clients[i]);
    }
    const size_t before = f->n;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 4; i++) {
            const char *text = request_text(1, "fields", NULL);
            assert_int_equal(cl_push(&clients[i], text, strlen(text)), strlen(text));
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++)
            cl_reply(f, &clients[i]);
    }
    assert_int_equal(f->n, before + 12);
    assert_int_equal(n_order, 12);
    size_t had[4] = {0};
    for (size_t i = 0; i < 12; i++) {
        for (size_t k = 0; k < 4; k++)
            had[k] += order[i].connection == f->handles[k].connection;
        for (size_t k = 0; k < 16; k++)
            assert_true(had[k % 4] < had[k / 4] + 3);
    }
    assert_int_equal(had[0] + had[1] + had[2] + had[3], 12);
    for (int i = 0; i < 4; i++)
        cl_close(&clients[i]);
}

/* What somebody asked who has gone is dropped: also what has not begun. */
static void test_gone(void **state) {
    fixture *f = *state;
    client gone;
    client stays;
    fx_open(f);
    f->options.limits.slice_us = 1;
    cl_connect(f, &gone);
    cl_connect(f, &stays);
    ask(f, &gone, "wait");
    FX_UNTIL(f, n_order == 1);
    ask(f, &gone, "fields");
    ask(f, &gone, "fields");
    cl_close(&gone);
    FX_UNTIL(f, f->n_closed == 1);
    FX_UNTIL(f, n_jobs == 0);
    assert_in_range(f->n, 1, 2);
    ask(f, &stays, "fields");
    cl_reply(f, &stays);
    cl_close(&stays);
}

/* ---- what is not read ---- */

enum { DEAF = 40, BIG = 1000000 };

/* Many that never read: they have half of the budget and a reply, whoever asks for little is
 * answered, and in the end those that take nothing are dropped, so that the others have theirs. */
static void test_budget(void **state) {
    fixture *f = *state;
    client deaf[DEAF];
    client other;
    f->reply_bytes = BIG;
    f->options.limits.unsent_bytes = 10 * BIG;
    f->options.limits.crowded_ms = 300;
    fx_open(f);
    cl_connect(f, &other);
    for (int i = 0; i < DEAF; i++) {
        cl_connect(f, &deaf[i]);
        ask(f, &deaf[i], "fields");
        ask(f, &deaf[i], "fields");
    }
    uint64_t most = 0;
    while (fx_statistics(f).dropped == 0) {
        ask(f, &other, "metrics");
        cl_reply(f, &other);
        const uint64_t now = fx_statistics(f).unsent_bytes;
        most = now > most ? now : most;
    }
    assert_in_range(most, 4 * BIG, 6 * BIG + 10000);
    FX_UNTIL(f, fx_statistics(f).dropped >= DEAF / 2);
    ask(f, &other, "metrics");
    cl_reply(f, &other);
    for (int i = 0; i < DEAF; i++)
        cl_close(&deaf[i]);
    ask(f, &other, "fields");
    cl_reply(f, &other);
    FX_UNTIL(f, fx_statistics(f).unsent_bytes == 0);
    cl_close(&other);
}

/* ---- connections ---- */

static void test_connections_of_a_user(void **state) {
    fixture *f = *state;
    client clients[8];
    client more;
    f->options.limits.connections = 8;
    f->options.limits.user_connections = 3;
    f->options.limits.reserved_connections = 2;
    fx_open(f);
    f->admins = false;
    for (int i = 0; i < 3; i++)
        cl_connect(f, &clients[i]);
    cl_connect(f, &more);
    cl_error(f, &more, SHEARD_RPC_TOO_MANY_CONNECTIONS);
    cl_close(&more);
    f->admins = true; /* no limit of their own */
    for (int i = 3; i < 7; i++)
        cl_connect(f, &clients[i]);
    FX_UNTIL(f, fx_statistics(f).connections == 7);
    cl_close(&clients[0]);
    FX_UNTIL(f, fx_statistics(f).connections == 6);
    f->admins = false; /* the last two are not for others */
    cl_connect(f, &more);
    cl_error(f, &more, SHEARD_RPC_TOO_MANY_CONNECTIONS);
    cl_close(&more);
    f->admins = true;
    cl_connect(f, &clients[0]);
    cl_connect(f, &clients[7]);
    cl_connect(f, &more);
    cl_error(f, &more, SHEARD_RPC_TOO_MANY_CONNECTIONS);
    cl_close(&more);
    assert_int_equal(fx_statistics(f).connections, 8);
    for (int i = 0; i < 8; i++)
        cl_close(&clients[i]);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)
int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_least_time_first),
        cmocka_unit_test(test_quiet_ones_come_first),
        TEST(test_paused_and_woken),
        TEST(test_one_at_a_time),
        TEST(test_gone),
        TEST(test_budget),
        TEST(test_connections_of_a_user),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
