/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests, replies, notifications, and how a connection ends. */
#include "server_fixture.h"

#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static int setup(void **state) {
    fx_setup(state);
    fx_open(*state);
    return 0;
}

static void reply_metrics(fixture *f, size_t i) {
    const sheard_reply reply = {.metrics = {.content_type = "text/plain", .text = "x"}};
    server_reply(f->s, f->handles[i], &reply);
}

/* Three requests and one line of nonsense, cut in two at every byte. */
static void test_any_split(void **state) {
    fixture *f = *state;
    char text[512] = "";
    strcat(text, request_text(1, "metrics", NULL));
    strcat(text, "\n\r\nnonsense\r\n");
    strcat(text, request_text(2, "metrics", NULL));
    for (size_t cut = 0; cut <= strlen(text); cut++) {
        client c;
        cl_connect(f, &c);
        cl_send(f, &c, text, cut);
        fx_turn(f);
        fx_turn(f);
        cl_send(f, &c, text + cut, strlen(text) - cut);
        assert_int_equal(cl_reply(f, &c), 1);
        assert_int_equal(cl_error(f, &c, SHEARD_RPC_PARSE_ERROR), -1);
        assert_int_equal(cl_reply(f, &c), 2);
        cl_close(&c);
    }
}

static void test_byte_by_byte(void **state) {
    fixture *f = *state;
    const char *text = request_text(7, "metrics", NULL);
    client c;
    cl_connect(f, &c);
    for (const char *p = text; *p; p++) {
        cl_send(f, &c, p, 1);
        fx_turn(f);
    }
    assert_int_equal(cl_reply(f, &c), 7);
    cl_close(&c);
}

/* More than fit into the turns, the limit of requests and the socket's buffer. */
static void test_pipelined(void **state) {
    fixture *f = *state;
    client c;
    cl_connect(f, &c);
    for (int i = 0; i < 2000; i++) {
        cl_say(f, &c, request_text(i, "metrics", NULL));
        cl_has_line(&c); /* it reads: who does not is not read from */
    }
    for (int i = 0; i < 2000; i++)
        assert_int_equal(cl_reply(f, &c), i);
    assert_int_equal(fx_statistics(f).requests[SHEARD_METHOD_METRICS], 2000);
    cl_close(&c);
}

static void test_replies_out_of_order(void **state) {
    fixture *f = *state;
    static const size_t order[] = {3, 0, 4, 2, 1};
    client c;
    f->hold = true;
    cl_connect(f, &c);
    for (int i = 0; i < 5; i++)
        cl_say(f, &c, request_text(100 + i, "metrics", NULL));
    FX_UNTIL(f, f->n == 5);
    for (size_t i = 0; i < 5; i++) {
        assert_true(fx_is_open(f, f->handles[order[i]]));
        reply_metrics(f, order[i]);
        assert_false(fx_is_open(f, f->handles[order[i]]));
        reply_metrics(f, order[i]); /* once more: nothing */
        assert_int_equal(cl_reply(f, &c), 100 + (int)order[i]);
    }
    cl_say(f, &c, "x\n");
    cl_error(f, &c, SHEARD_RPC_PARSE_ERROR); /* so there was no second reply */
    cl_close(&c);
}

static void test_errors_keep_the_connection(void **state) {
    fixture *f = *state;
    client c;
    cl_connect(f, &c);
    cl_send(f, &c, "a\0b\n", 4);
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_NUL_BYTE), -1);
    cl_say(f, &c, request_text(4, "nothing", NULL));
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_UNKNOWN_METHOD), 4);
    cl_say(f, &c, request_text(5, "wait", NULL));
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_MISSING_PARAMETER), 5);
    cl_say(f, &c, "[]\n");
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_BATCH_UNSUPPORTED), -1);
    cl_say(f, &c, request_text(6, "metrics", NULL));
    assert_int_equal(cl_reply(f, &c), 6);
    const server_statistics s = fx_statistics(f);
    assert_int_equal(s.errors[SHEARD_RPC_NUL_BYTE], 1);
    assert_int_equal(s.errors[SHEARD_RPC_UNKNOWN_METHOD], 1);
    assert_int_equal(s.lines, 5);
    cl_close(&c);
}

static void test_reply_lines_and_errors(void **state) {
    fixture *f = *state;
    client c;
    sheard_rpc_error error;
    f->hold = true;
    cl_connect(f, &c);
    for (int i = 0; i < 3; i++)
        cl_say(f, &c, request_text(i, "metrics", NULL));
    FX_UNTIL(f, f->n == 3);
    sheard_rpc_fail(&error, SHEARD_RPC_QUEUE_FULL, NULL, "full");
    server_reply_error(f->s, f->handles[0], &error);
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_QUEUE_FULL), 0);
    server_reply_line(f->s, f->handles[1], NULL, 0);
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_OUT_OF_MEMORY), 1);
    char *line;
    size_t n;
    const sheard_rpc_id id = {.type = SHEARD_ID_INTEGER, .integer = 2};
    const sheard_reply reply = {.metrics = {.content_type = "", .text = ""}};
    assert_int_equal(sheard_reply_line(&line, &n, &id, SHEARD_METHOD_METRICS, &reply, &error), 0);
    server_reply_line(f->s, f->handles[2], line, n);
    assert_int_equal(cl_reply(f, &c), 2);
    line = strdup("never sent\n");
    server_reply_line(f->s, f->handles[2], line, 11); /* answered: freed */
    cl_close(&c);
}

static void test_peer(void **state) {
    fixture *f = *state;
    client c;
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "metrics", NULL));
    cl_reply(f, &c);
    assert_int_equal(f->peer_uid, getuid());
    assert_int_equal(f->peer_groups, getgroups(0, NULL));
    cl_close(&c);
}

static void test_disconnect_in_flight(void **state) {
    fixture *f = *state;
    client c;
    client other;
    f->hold = true;
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "wait", "{\"ids\":[1]}"));
    cl_say(f, &c, request_text(2, "metrics", NULL));
    FX_UNTIL(f, f->n == 2);
    cl_close(&c);
    for (int i = 0; i < 5; i++) { /* at once, although it waits for replies */
        fx_turn(f);
    }
    assert_int_equal(f->n_closed, 1);
    assert_int_equal(f->closed[0], f->handles[0].connection);
    assert_false(fx_is_open(f, f->handles[1]));
    reply_metrics(f, 1); /* to nobody, also when its place is taken */
    cl_connect(f, &other);
    cl_say(f, &other, request_text(9, "metrics", NULL));
    FX_UNTIL(f, f->n == 3);
    assert_int_not_equal(f->handles[2].connection, f->handles[1].connection);
    reply_metrics(f, 1);
    reply_metrics(f, 2);
    assert_int_equal(cl_reply(f, &other), 9);
    cl_close(&other);
}

/* What somebody asked who has gone is not begun. */
static void test_send_and_close(void **state) {
    fixture *f = *state;
    client c;
    cl_connect(f, &c);
    cl_say(f, &c, request_text(0, "metrics", NULL));
    FX_UNTIL(f, f->n == 1);
    for (int i = 1; i <= 100; i++)
        cl_push(&c, request_text(i, "metrics", NULL), strlen(request_text(i, "metrics", NULL)));
    cl_close(&c);
    FX_UNTIL(f, f->n_closed == 1);
    assert_int_equal(f->n, 1);
    assert_int_equal(fx_statistics(f).connections, 0);
}

static void test_half_closed_client_is_answered(void **state) {
    fixture *f = *state;
    client c;
    f->hold = true;
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "metrics", NULL));
    cl_say(f, &c, "cut off");
    assert_int_equal(shutdown(c.fd, SHUT_WR), 0);
    FX_UNTIL(f, f->n == 1);
    for (int i = 0; i < 50; i++)
        fx_turn(f);
    assert_int_equal(f->n_closed, 0);
    reply_metrics(f, 0);
    assert_int_equal(cl_reply(f, &c), 1);
    cl_ended(f, &c);
    FX_UNTIL(f, f->n_closed == 1);
    cl_close(&c);
}

/* Its end is not seen by reading any more. */
static void test_half_closed_client_goes(void **state) {
    fixture *f = *state;
    client c;
    server_limits limits = f->options.limits;
    limits.idle_timeout_ms = 40; /* for the tick */
    server_set_limits(f->s, &limits);
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "wait", "{\"ids\":[1]}"));
    shutdown(c.fd, SHUT_WR);
    FX_UNTIL(f, f->n == 1);
    fx_turn(f);
    assert_int_equal(f->n_closed, 0);
    cl_close(&c);
    FX_UNTIL(f, f->n_closed == 1);
}

/* ---- subscriptions ---- */

static void publish(fixture *f, int notice, int64_t job, const char *field) {
    const sheard_notice_params params = {
        .job_progress = {.id = job, .progress = {.done = 1, .total = 2}}};
    const sheard_notice_params state = {.server_state = {.state = SHEARD_SERVER_DRAINING}};
    server_publish(f->s, notice, job, field,
                   notice == SHEARD_NOTICE_SERVER_STATE ? &state : &params);
}

static void subscribe(fixture *f, client *c, const char *method, const char *params) {
    cl_say(f, c, request_text(1, method, params));
    assert_int_equal(cl_reply(f, c), 1);
}

static void test_subscriptions(void **state) {
    fixture *f = *state;
    const int progress = SHEARD_NOTICE_JOB_PROGRESS;
    client some;
    client all;
    client none;
    cl_connect(f, &some);
    cl_connect(f, &all);
    cl_connect(f, &none);
    assert_false(server_is_watched(f->s, progress, 7, NULL));
    subscribe(f, &some, "subscribe", "{\"jobs\":[9,7],\"fields\":[\"b\",\"a\"],\"progress\":true}");
    subscribe(f, &all, "subscribe", "{\"all\":true,\"progress\":true}");
    publish(f, progress, 7, NULL);
    publish(f, progress, 8, NULL);
    publish(f, progress, 10, "a");
    publish(f, progress, 11, "c");
    publish(f, SHEARD_NOTICE_SERVER_STATE, 0, NULL);
    static const int64_t to_all[] = {7, 8, 10, 11};
    for (size_t i = 0; i < 4; i++)
        assert_int_equal(cl_notice(f, &all, progress), to_all[i]);
    cl_notice(f, &all, SHEARD_NOTICE_SERVER_STATE);
    assert_int_equal(cl_notice(f, &some, progress), 7);
    assert_int_equal(cl_notice(f, &some, progress), 10);
    cl_notice(f, &some, SHEARD_NOTICE_SERVER_STATE);
    subscribe(f, &some, "unsubscribe", "{\"jobs\":[7]}");
    subscribe(f, &all, "unsubscribe", "{}");
    assert_false(server_is_watched(f->s, progress, 7, NULL));
    assert_true(server_is_watched(f->s, progress, 9, NULL));
    publish(f, progress, 7, NULL);
    publish(f, progress, 9, NULL);
    assert_int_equal(cl_notice(f, &some, progress), 9);
    assert_int_equal(fx_statistics(f).subscribers, 1);
    cl_close(&some);
    FX_UNTIL(f, f->n_closed == 1);
    assert_int_equal(fx_statistics(f).subscribers, 0);
    assert_int_equal(fx_statistics(f).notices, 9);
    subscribe(f, &none, "unsubscribe", "{}"); /* nobody got what is not theirs */
    cl_close(&all);
    cl_close(&none);
}

static void test_progress_only_for_those_who_want_it(void **state) {
    fixture *f = *state;
    client c;
    cl_connect(f, &c);
    subscribe(f, &c, "subscribe", "{\"all\":true}");
    publish(f, SHEARD_NOTICE_JOB_PROGRESS, 7, NULL);
    publish(f, SHEARD_NOTICE_SERVER_STATE, 0, NULL);
    cl_notice(f, &c, SHEARD_NOTICE_SERVER_STATE);
    cl_close(&c);
}

static void test_too_many_subscriptions(void **state) {
    fixture *f = *state;
    client c;
    server_limits limits = f->options.limits;
    limits.subscriptions = 3;
    server_set_limits(f->s, &limits);
    cl_connect(f, &c);
    subscribe(f, &c, "subscribe", "{\"jobs\":[1,2],\"fields\":[\"a\"],\"progress\":true}");
    subscribe(f, &c, "subscribe", "{\"jobs\":[2,1],\"fields\":[\"a\"]}"); /* no more than before */
    cl_say(f, &c, request_text(2, "subscribe", "{\"jobs\":[1,5]}"));
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_TOO_MANY_SUBSCRIPTIONS), 2);
    assert_false(server_is_watched(f->s, SHEARD_NOTICE_JOB_PROGRESS, 5, NULL));
    assert_true(server_is_watched(f->s, SHEARD_NOTICE_JOB_PROGRESS, 5, "a"));
    sheard_rpc_error error;
    const sheard_msg_subscribe what = {.all = true};
    assert_int_equal(server_subscribe(f->s, 12345, &what, NULL, &error), SHEARD_RPC_STOPPING);
    assert_int_equal(server_unsubscribe(f->s, 0, &what, NULL, &error), SHEARD_RPC_STOPPING);
    cl_close(&c);
}

/* ---- the end ---- */

static void test_stop_accepting(void **state) {
    fixture *f = *state;
    client c;
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "metrics", NULL));
    cl_reply(f, &c);
    server_stop_accepting(f->s);
    server_stop_accepting(f->s);
    assert_int_equal(access(f->path, F_OK), -1);
    cl_say(f, &c, request_text(2, "metrics", NULL));
    assert_int_equal(cl_reply(f, &c), 2);
    fx_close(f, 1000);
    cl_ended(f, &c);
    cl_close(&c);
}

static void test_close_answers_and_flushes(void **state) {
    fixture *f = *state;
    client c;
    f->reply_bytes = 1 << 20; /* more than a socket takes */
    cl_connect(f, &c);
    cl_say(f, &c, request_text(2, "wait", "{\"ids\":[1]}"));
    cl_say(f, &c, request_text(1, "metrics", NULL));
    FX_UNTIL(f, f->n == 2);
    f->done = false;
    server_close(f->s, 20000, NULL, NULL);
    server_close(f->s, 30000, NULL, NULL); /* later: no matter */
    assert_int_equal(cl_reply(f, &c), 1);
    assert_int_equal(cl_error(f, &c, SHEARD_RPC_STOPPING), 2);
    cl_ended(f, &c);
    f->s = NULL; /* the loop ends in the teardown */
    cl_close(&c);
}

static void test_close_does_not_wait_for_ever(void **state) {
    fixture *f = *state;
    client c;
    f->reply_bytes = 8 << 20;
    cl_connect(f, &c);
    cl_say(f, &c, request_text(1, "metrics", NULL));
    FX_UNTIL(f, f->n == 1);
    fx_turn(f);
    const uint64_t begin = uv_hrtime();
    fx_close(f, 50);
    assert_in_range((uv_hrtime() - begin) / 1000000, 40, 10000);
    assert_int_equal(f->n_closed, 1);
    cl_close(&c);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, fx_teardown)
int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(test_any_split),
        TEST(test_byte_by_byte),
        TEST(test_pipelined),
        TEST(test_replies_out_of_order),
        TEST(test_errors_keep_the_connection),
        TEST(test_reply_lines_and_errors),
        TEST(test_peer),
        TEST(test_disconnect_in_flight),
        TEST(test_send_and_close),
        TEST(test_half_closed_client_is_answered),
        TEST(test_half_closed_client_goes),
        TEST(test_subscriptions),
        TEST(test_progress_only_for_those_who_want_it),
        TEST(test_too_many_subscriptions),
        TEST(test_stop_accepting),
        TEST(test_close_answers_and_flushes),
        TEST(test_close_does_not_wait_for_ever),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
