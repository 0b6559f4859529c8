/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many clients, and clients that send more than the service can answer: others are served. */
#include "server_fixture.h"

#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

static void ask(fixture *f, client *c, int64_t id) {
    cl_say(f, c, request_text(id, "metrics", NULL));
}

static void turns(fixture *f, int n) {
    while (n-- > 0)
        fx_turn(f);
}

enum { MANY = 1000 };

static void test_a_thousand_connections(void **state) {
    fixture *f = *state;
    struct rlimit limit;
    client *clients = calloc(MANY, sizeof *clients);
    assert_non_null(clients);
    getrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_cur < 2 * MANY + 100) {
        limit.rlim_cur = limit.rlim_max < 2 * MANY + 100 ? limit.rlim_max : 2 * MANY + 100;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
    const size_t n = limit.rlim_cur < 2 * MANY + 100 ? (limit.rlim_cur - 100) / 2 : MANY;
    fx_open(f);
    for (size_t i = 0; i < n; i++) {
        cl_connect(f, &clients[i]);
        ask(f, &clients[i], (int64_t)i);
    }
    FX_UNTIL(f, fx_statistics(f).connections == n);
    for (size_t i = n; i-- > 0;) {
        assert_int_equal(cl_reply(f, &clients[i]), (int)i);
        cl_close(&clients[i]);
    }
    FX_UNTIL(f, f->n_closed == n);
    assert_int_equal(fx_statistics(f).queued_bytes, 0);
    assert_int_equal(fx_statistics(f).refused, 0);
    free(clients);
}

/* All that the socket takes at once: the other is answered within a few turns. Connections take
 * turns by the processor time that they have had: one that an interrupt was charged to waits
 * longer, once. */
static void test_flood_and_fairness(void **state) {
    fixture *f = *state;
    client flood;
    client other;
    f->options.limits.slice_us = 1; /* one thing a turn */
    fx_open(f);
    cl_connect(f, &flood);
    cl_connect(f, &other);
    turns(f, 3);
    int all = 0;
    for (int round = 0; round < 20; round++) {
        const char *text = request_text(round, "metrics", NULL);
        while (cl_push(&flood, text, strlen(text)) == strlen(text)) {
        }
        const size_t before = f->n;
        ask(f, &other, round);
        int n = 0;
        while (!cl_has_line(&other)) {
            fx_turn(f);
            assert_in_range(++n, 1, 64); /* of hundreds that wait */
        }
        all += n;
        assert_in_range(f->n - before, 1, (size_t)n + 1);
        assert_int_equal(cl_reply(f, &other), round);
        cl_has_line(&flood); /* it reads */
    }
    assert_in_range(all, 20, 20 * 5);
    cl_close(&flood);
    cl_close(&other);
}

/* The k-th of a set of wrong lines. */
static size_t malformed(char *line, size_t size, unsigned k) {
    static const char *const kinds[] = {
        "{",
        "}{",
        "\"",
        "[[[[[[[[[[[[[[[[",
        "{\"jsonrpc\":\"2.0\"}",
        "null",
        "\xff\xfe",
        "1e999",
        "{\"a\":1,\"a\":2}",
        "{\"jsonrpc\":\"2.0\",\"id\":{},\"method\":\"metrics\"}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"metrics\",\"params\":[]}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"\\u0000\"}",
        "\t",
    };
    const char *kind = kinds[k % (sizeof kinds / sizeof kinds[0])];
    return (size_t)snprintf(line, size, "%s%u\n", kind, k);
}

enum { WRONG = 10000 };

/* Each is answered, and meanwhile another client is, within a few turns each time. */
static void test_malformed_lines(void **state) {
    fixture *f = *state;
    client bad;
    client good;
    char line[256];
    int64_t asked = 0;
    fx_open(f);
    cl_connect(f, &bad);
    cl_connect(f, &good);
    turns(f, 3);
    unsigned sent = 0;
    unsigned answered = 0;
    size_t part = 0;
    size_t n = malformed(line, sizeof line, 0);
    while (answered < WRONG) {
        while (sent < WRONG && (part += cl_push(&bad, line + part, n - part)) == n) {
            n = malformed(line, sizeof line, ++sent);
            part = 0;
        }
        ask(f, &good, asked);
        for (int turn = 0; !cl_has_line(&good); turn++) {
            assert_in_range(turn, 0, 5);
            fx_turn(f);
        }
        assert_int_equal(cl_reply(f, &good), asked++);
        while (cl_has_line(&bad)) {
            sheard_message m = cl_next(f, &bad);
            assert_int_equal(m.kind, SHEARD_MESSAGE_ERROR);
            sheard_message_deinit(&m);
            answered++;
        }
        assert_false(bad.ended);
    }
    assert_int_equal(fx_statistics(f).lines, WRONG + (unsigned)asked);
    assert_int_equal(f->n, asked);
    cl_close(&bad);
    cl_close(&good);
}

/* Bytes without any end of line. */
static void test_endless_line(void **state) {
    fixture *f = *state;
    client c;
    static char block[1 << 16];
    memset(block, 'x', sizeof block);
    fx_open(f);
    cl_connect(f, &c);
    while (!cl_has_line(&c)) {
        cl_push(&c, block, sizeof block);
        fx_turn(f);
    }
    cl_error(f, &c, SHEARD_RPC_LINE_TOO_LONG);
    cl_ended(f, &c);
    cl_close(&c);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fx_setup, fx_teardown)
int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(test_a_thousand_connections),
        TEST(test_flood_and_fairness),
        TEST(test_malformed_lines),
        TEST(test_endless_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
