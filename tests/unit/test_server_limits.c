/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every limit, and that a client that reaches one does not delay others. */
#include "server_fixture.h"

#include "test.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static void ask(fixture *f, client *c, int64_t id) {
    cl_say(f, c, request_text(id, "metrics", NULL));
}

static void reply_metrics(fixture *f, size_t i) {
    const sheard_reply reply = {.metrics = {.content_type = "", .text = "x"}};
    server_reply(f->s, f->handles[i], &reply);
}

static void turns(fixture *f, int n) {
    while (n-- > 0)
        fx_turn(f);
}

/* ---- lines ---- */

static void test_line_too_long(void **state) {
    fixture *f = *state;
    client exact;
    client longer;
    char line[202];
    f->options.limits.line_bytes = 200;
    fx_open(f);
    memset(line, 'x', 201);
    line[201] = '\n';
    cl_connect(f, &exact);
    cl_send(f, &exact, line + 1, 201);
    cl_error(f, &exact, SHEARD_RPC_PARSE_ERROR);
    ask(f, &exact, 1);
    assert_int_equal(cl_reply(f, &exact), 1);
    cl_connect(f, &longer);
    cl_send(f, &longer, line, 201); /* no need to wait for its end */
    cl_error(f, &longer, SHEARD_RPC_LINE_TOO_LONG);
    cl_ended(f, &longer);
    cl_close(&exact);
    cl_close(&longer);
}

/* ---- requests ---- */

static void test_short_requests_pause_reading(void **state) {
    fixture *f = *state;
    client c;
    f->options.limits.in_flight = 3;
    f->hold = true;
    fx_open(f);
    cl_connect(f, &c);
    for (int i = 0; i < 10; i++)
        ask(f, &c, i);
    FX_UNTIL(f, f->n == 3);
    turns(f, 20);
    assert_int_equal(f->n, 3);
    for (size_t i = 0; i < 10; i++) {
        FX_UNTIL(f, f->n > i);
        assert_in_range(f->n, i + 1, i + 3);
        reply_metrics(f, i);
        assert_int_equal(cl_reply(f, &c), (int)i);
    }
    cl_close(&c);
}

static void test_long_requests_are_refused(void **state) {
    fixture *f = *state;
    static const char submit[] = "{\"path\":\"/data/a.fits\",\"wait\":true}";
    client c;
    f->options.limits.in_flight = 2;
    fx_open(f);
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "wait", "{\"ids\":[1]}"));
    cl_say(f, &c, request_text(2, "submit", submit));
    cl_say(f, &c, request_text(3, "wait", "{\"ids\":[1]}"));
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_TOO_MANY_REQUESTS), 3);
    ask(f, &c, 4); /* while it waits, it may do other things */
    assert_int_equal(cl_reply(f, &c), 4);
    sheard_rpc_error error;
    sheard_rpc_fail(&error, SHEARD_RPC_NO_SUCH_JOB, NULL, "none");
    server_reply_error(f->s, f->handles[0], &error);
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_NO_SUCH_JOB), 1);
    cl_say(f, &c, request_text(5, "wait", "{\"ids\":[1]}"));
    FX_UNTIL(f, f->n == 4);
    cl_close(&c);
}

/* ---- connections ---- */

static void test_too_many_connections(void **state) {
    fixture *f = *state;
    client a;
    client b;
    client c;
    f->options.limits.connections = 2;
    fx_open(f);
    cl_connect(f, &a);
    cl_connect(f, &b);
    cl_connect(f, &c);
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_TOO_MANY_CONNECTIONS), -1);
    cl_ended(f, &c);
    cl_close(&c);
    assert_int_equal(fx_statistics(f).refused, 1);
    assert_int_equal(fx_statistics(f).connections, 2);
    cl_close(&a);
    FX_UNTIL(f, fx_statistics(f).connections == 1);
    cl_connect(f, &c);
    ask(f, &c, 1);
    assert_int_equal(cl_reply(f, &c), 1);
    cl_close(&b);
    cl_close(&c);
}

/* ---- silence ---- */

static void test_idle(void **state) {
    fixture *f = *state;
    client quiet;
    client waits;
    client watches;
    f->options.limits.idle_timeout_ms = 100;
    fx_open(f);
    cl_connect(f, &quiet);
    cl_connect(f, &waits);
    cl_connect(f, &watches);
    cl_say(f, &waits, request_text(1, "wait", "{\"ids\":[1]}"));
    cl_say(f, &watches, request_text(2, "subscribe", "{\"all\":true}"));
    cl_reply(f, &watches);
    assert_int_equal(cl_error(f, &quiet, SHEARD_RPC_IDLE_TIMEOUT), -1);
    cl_ended(f, &quiet);
    const uint64_t begin = uv_hrtime();
    FX_UNTIL(f, uv_hrtime() - begin > UINT64_C(300000000)); /* three times as long */
    assert_false(cl_has_line(&waits) || waits.ended);
    assert_false(cl_has_line(&watches) || watches.ended);
    assert_int_equal(fx_statistics(f).timeouts, 1);
    cl_close(&quiet);
    cl_close(&waits);
    cl_close(&watches);
}

/* A byte now and then does not save a line that does not end, nor does a subscription. */
static void test_stalled_in_a_line(void **state) {
    fixture *f = *state;
    client stalled;
    client other;
    int64_t asked = 0;
    f->options.limits.idle_timeout_ms = 1000;
    fx_open(f);
    cl_connect(f, &stalled);
    cl_connect(f, &other);
    cl_say(f, &stalled, request_text(2, "subscribe", "{\"all\":true}"));
    cl_reply(f, &stalled);
    cl_say(f, &stalled, "{\"jsonrpc\":");
    while (!cl_has_line(&stalled) && !stalled.ended) {
        if (asked % 64 == 0) /* a byte a turn makes the line too long first, on a fast machine */
            cl_push(&stalled, " ", 1);
        ask(f, &other, asked);
        assert_int_equal(cl_reply(f, &other), asked++);
    }
    assert_int_equal(cl_error(f, &stalled, SHEARD_RPC_IDLE_TIMEOUT), -1);
    assert_true(asked > 10);
    cl_close(&stalled);
    cl_close(&other);
}

/* ---- not reading ---- */

static void test_never_reads(void **state) {
    fixture *f = *state;
    client c;
    client other;
    f->reply_bytes = 100000;
    f->options.limits.queue_bytes = 1 << 20;
    f->options.limits.stall_timeout_ms = 150;
    fx_open(f);
    cl_connect(f, &c);
    cl_connect(f, &other);
    /* Nothing more is begun: the queue stays at one reply, or what is left of it. */
    uint64_t most = 0;
    for (int i = 0; fx_statistics(f).dropped == 0; i++) {
        const char *text = request_text(i, "metrics", NULL);
        cl_push(&c, text, strlen(text));
        f->reply_bytes = 100000;
        fx_turn(f);
        const uint64_t queued = fx_statistics(f).queued_bytes;
        most = queued > most ? queued : most;
    }
    assert_in_range(most, 1, 110000);
    FX_UNTIL(f, f->n_closed == 1);
    ask(f, &other, 1);
    assert_int_equal(cl_reply(f, &other), 1);
    cl_close(&c);
    cl_close(&other);
}

/* Replies that come late go beyond the pause, and end at the limit and one more. */
static void test_queue_limit(void **state) {
    fixture *f = *state;
    client c;
    f->hold = true;
    f->options.limits.queue_bytes = 1 << 20;
    f->options.limits.stall_timeout_ms = 0;
    fx_open(f);
    cl_connect(f, &c);
    for (int i = 0; i < 60; i++)
        ask(f, &c, i);
    FX_UNTIL(f, f->n == 60);
    char *text = calloc(1, 100001);
    assert_non_null(text);
    memset(text, 'x', 100000);
    const sheard_reply reply = {.metrics = {.content_type = "", .text = text}};
    for (size_t i = 0; i < 60; i++) {
        server_reply(f->s, f->handles[i], &reply);
        assert_in_range(fx_statistics(f).queued_bytes, 0, (1 << 20) + 110000);
    }
    free(text);
    FX_UNTIL(f, f->n_closed == 1);
    assert_int_equal(fx_statistics(f).dropped, 1);
    assert_int_equal(fx_statistics(f).queued_bytes, 0);
    cl_close(&c);
}

/* A slow reader that goes on reading is never dropped, whatever the sum. */
static void test_slow_reader_gets_everything(void **state) {
    fixture *f = *state;
    client c;
    f->reply_bytes = 50000;
    f->options.limits.queue_bytes = 1 << 20;
    fx_open(f);
    cl_connect(f, &c);
    for (int i = 0; i < 100; i++)
        ask(f, &c, i);
    turns(f, 50);
    for (int i = 0; i < 100; i++)
        assert_int_equal(cl_reply(f, &c), i);
    assert_true(fx_statistics(f).bytes_out > 100 * 50000);
    cl_close(&c);
}

enum { NOTICES = 4000 };

static void test_lost_notifications(void **state) {
    fixture *f = *state;
    const sheard_notice_params params = {.job_progress = {.id = 7}};
    client c;
    client reader;
    int64_t got = 0;
    f->options.limits.queue_bytes = 1 << 16;
    fx_open(f);
    cl_connect(f, &c);
    cl_connect(f, &reader);
    cl_say(f, &c, request_text(1, "subscribe", "{\"all\":true,\"progress\":true}"));
    cl_reply(f, &c);
    cl_say(f, &reader, request_text(1, "subscribe", "{\"jobs\":[7],\"progress\":true}"));
    cl_reply(f, &reader);
    for (int i = 0; i < NOTICES; i++) {
        server_publish(f->s, SHEARD_NOTICE_JOB_PROGRESS, 7, NULL, &params);
        assert_int_equal(cl_notice(f, &reader, SHEARD_NOTICE_JOB_PROGRESS), 7);
        assert_true(fx_statistics(f).queued_bytes <= 1 << 15);
    }
    sheard_message m = cl_next(f, &c);
    while (m.notice == SHEARD_NOTICE_JOB_PROGRESS) {
        got++;
        sheard_message_deinit(&m);
        m = cl_next(f, &c);
    }
    assert_int_equal(m.notice, SHEARD_NOTICE_LOST);
    assert_int_equal(m.params.lost.count, NOTICES - got);
    assert_int_equal(fx_statistics(f).lost, NOTICES - got);
    assert_int_equal(fx_statistics(f).notices, NOTICES + got);
    sheard_message_deinit(&m);
    server_publish(f->s, SHEARD_NOTICE_JOB_PROGRESS, 7, NULL, &params);
    cl_notice(f, &c, SHEARD_NOTICE_JOB_PROGRESS);
    assert_int_equal(f->n_closed, 0);
    cl_close(&c);
    cl_close(&reader);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fx_setup, fx_teardown)
int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(test_line_too_long),
        TEST(test_short_requests_pause_reading),
        TEST(test_long_requests_are_refused),
        TEST(test_too_many_connections),

        TEST(test_idle),
        TEST(test_stalled_in_a_line),
        TEST(test_never_reads),
        TEST(test_queue_limit),
        TEST(test_slow_reader_gets_everything),
        TEST(test_lost_notifications),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
