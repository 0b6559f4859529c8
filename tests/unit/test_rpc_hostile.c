/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines that are nearly right, and memory that runs out: an error at worst. Sanitizers and valgrind
 * watch. */
#include "rpc_fixture.h"
#include "scarce.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

enum { MUTANTS = 5000 };

static const sheard_rpc_id id_7 = {.type = SHEARD_ID_INTEGER, .integer = 7};

/* ---- Mutants ---- */

static char *some_request(uint64_t *seed, size_t *n) {
    const int method = (int)(next_random(seed) % SHEARD_N_METHODS);
    sheard_params params;
    fill_params(&params, method, seed);
    char *line = NULL;
    sheard_rpc_error error;
    assert_int_equal(sheard_request_line(&line, n, &id_7, method, &params, &error), SHEARD_RPC_OK);
    msg_deinit(&params, rpc_methods[method].params);
    return line;
}

static char *some_reply(uint64_t *seed, size_t *n, int *method) {
    *method = (int)(next_random(seed) % SHEARD_N_METHODS);
    sheard_reply reply;
    fill(&reply, rpc_methods[*method].reply, seed);
    char *line = NULL;
    sheard_rpc_error error;
    assert_int_equal(sheard_reply_line(&line, n, &id_7, *method, &reply, &error), SHEARD_RPC_OK);
    msg_deinit(&reply, rpc_methods[*method].reply);
    return line;
}

/* Flip, put, take away or double bytes. */
static void mutate(char *line, size_t *n, uint64_t *seed) {
    static const char likely[] = "{}[]\",:\\0019eE+-.tfnu \xC3\xFF";
    for (uint64_t k = 1 + next_random(seed) % 4; k > 0 && *n > 0; k--) {
        const size_t at = next_random(seed) % *n;
        switch (next_random(seed) % 4) {
        case 0:
            line[at] = (char)(line[at] ^ (1 << next_random(seed) % 8));
            break;
        case 1:
            line[at] = likely[next_random(seed) % sizeof likely];
            break;
        case 2:
            memmove(line + at, line + at + 1, *n - at - 1);
            --*n;
            break;
        default:
            *n = at;
            break;
        }
    }
}

/* A copy of exactly its size, so that a byte read too far shows. */
static char *exact_copy(const char *line, size_t n) {
    char *copy = malloc(n > 0 ? n : 1);
    assert_non_null(copy);
    memcpy(copy, line, n);
    return copy;
}

static void test_mutated_requests(void **state) {
    (void)state;
    uint64_t seed = 11;
    int taken = 0;
    for (int i = 0; i < MUTANTS; i++) {
        size_t n = 0;
        char *line = some_request(&seed, &n);
        mutate(line, &n, &seed);
        char *exact = exact_copy(line, n);
        sheard_request request;
        sheard_rpc_error error = {0};
        const int rc = sheard_request_parse(&request, exact, n, NULL, &error);
        assert_int_equal(rc, error.code);
        assert_true(rc == SHEARD_RPC_OK || error.message[0] != '\0');
        assert_int_not_equal(rc, SHEARD_RPC_OUT_OF_MEMORY);
        taken += rc == SHEARD_RPC_OK;
        char *answer = NULL;
        assert_int_equal(sheard_error_line(&answer, &n, &request.id, &error), SHEARD_RPC_OK);
        free(answer);
        free(exact);
        free(line);
        sheard_request_deinit(&request);
    }
    assert_in_range(taken, 1, MUTANTS - 1); /* both ways were walked */
}

static void test_mutated_replies(void **state) {
    (void)state;
    uint64_t seed = 12;
    int taken = 0;
    for (int i = 0; i < MUTANTS; i++) {
        size_t n = 0;
        int method = 0;
        char *line = some_reply(&seed, &n, &method);
        mutate(line, &n, &seed);
        char *exact = exact_copy(line, n);
        sheard_message message;
        sheard_rpc_error error = {0};
        if (sheard_message_parse(&message, exact, n, &error) == SHEARD_RPC_OK &&
            message.kind == SHEARD_MESSAGE_REPLY) {
            sheard_reply reply;
            taken += sheard_message_reply(&message, method, &reply, &error) == SHEARD_RPC_OK;
            sheard_reply_deinit(&reply, method);
        }
        free(exact);
        free(line);
        sheard_message_deinit(&message);
    }
    assert_in_range(taken, 1, MUTANTS - 1);
}

/* ---- Want of memory ---- */

/* Calls `act` with the n-th request for memory refused, for every n, once and for ever. It returns
 * a code, and frees what it was given. */
static void refuse_each(int (*act)(void *), void *what) {
    for (int ever = 0; ever < 2; ever++) {
        long n = 1;
        for (;; n++) {
            scarce_after(n, ever);
            const int rc = act(what);
            const bool refused = scarce_end();
            assert_int_equal(rc, refused ? SHEARD_RPC_OUT_OF_MEMORY : SHEARD_RPC_OK);
            if (!refused)
                break;
        }
        assert_true(n > 3); /* it did ask for memory */
    }
}

typedef struct line_of {
    char *line;
    size_t n;
    int method;
    const void *message;
} line_of;

static int read_request(void *what) {
    const line_of *l = what;
    sheard_request request;
    sheard_rpc_error error;
    const int rc = sheard_request_parse(&request, l->line, l->n, NULL, &error);
    assert_int_equal(error.code, rc);
    sheard_request_deinit(&request);
    return rc;
}

static int write_request(void *what) {
    const line_of *l = what;
    char *line = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    const int rc = sheard_request_line(&line, &n, &id_7, l->method, l->message, &error);
    assert_int_equal(line == NULL, rc != SHEARD_RPC_OK);
    free(line);
    return rc;
}

static void test_scarce_requests(void **state) {
    (void)state;
    uint64_t seed = 13;
    for (int i = 0; i < 2 * SHEARD_N_METHODS; i++) {
        line_of l = {.method = i % SHEARD_N_METHODS};
        sheard_params params;
        fill_params(&params, l.method, &seed);
        sheard_rpc_error error;
        l.message = &params;
        assert_int_equal(sheard_request_line(&l.line, &l.n, &id_7, l.method, &params, &error), 0);
        l.n--;
        refuse_each(write_request, &l);
        refuse_each(read_request, &l);
        free(l.line);
        msg_deinit(&params, rpc_methods[l.method].params);
    }
}

static int read_reply(void *what) {
    const line_of *l = what;
    sheard_message message;
    sheard_reply reply;
    sheard_rpc_error error;
    char *text = NULL;
    memset(&reply, 0, sizeof reply);
    int rc = sheard_message_parse(&message, l->line, l->n, &error);
    if (rc == SHEARD_RPC_OK)
        rc = sheard_message_reply(&message, l->method, &reply, &error);
    if (rc == SHEARD_RPC_OK)
        rc = sheard_message_text(&message, &text, &error);
    free(text);
    sheard_reply_deinit(&reply, l->method);
    sheard_message_deinit(&message);
    return rc;
}

static int write_reply(void *what) {
    const line_of *l = what;
    char *line = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    const int rc = sheard_reply_line(&line, &n, &id_7, l->method, l->message, &error);
    assert_int_equal(line == NULL, rc != SHEARD_RPC_OK);
    free(line);
    return rc;
}

static void test_scarce_replies(void **state) {
    (void)state;
    uint64_t seed = 14;
    for (int i = 0; i < SHEARD_N_METHODS; i++) {
        line_of l = {.method = i};
        sheard_reply reply;
        fill(&reply, rpc_methods[i].reply, &seed);
        sheard_rpc_error error;
        l.message = &reply;
        assert_int_equal(sheard_reply_line(&l.line, &l.n, &id_7, i, &reply, &error), 0);
        l.n--;
        refuse_each(write_reply, &l);
        refuse_each(read_reply, &l);
        free(l.line);
        msg_deinit(&reply, rpc_methods[i].reply);
    }
}

static int write_error(void *what) {
    char *line = NULL;
    size_t n = 0;
    const int rc = sheard_error_line(&line, &n, &id_7, what);
    assert_int_equal(line == NULL, rc != SHEARD_RPC_OK);
    free(line);
    return rc;
}

static int write_notice(void *what) {
    char *line = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    const int rc = sheard_notice_line(&line, &n, SHEARD_NOTICE_JOB_CHANGED, what, &error);
    free(line);
    return rc;
}

static int read_notice(void *what) {
    const line_of *l = what;
    sheard_message message;
    sheard_rpc_error error;
    const int rc = sheard_message_parse(&message, l->line, l->n, &error);
    sheard_message_deinit(&message);
    return rc;
}

static int write_side(void *what) {
    char *text = NULL;
    sheard_rpc_error error;
    const int rc = sheard_side_text(&text, what, &error);
    assert_int_equal(text == NULL, rc != SHEARD_RPC_OK);
    free(text);
    return rc;
}

static int write_source(void *what) {
    char *text = NULL;
    sheard_rpc_error error;
    const int rc = sheard_source_text(&text, what, &error);
    free(text);
    return rc;
}

static int read_job_file(void *what) {
    const line_of *l = what;
    sheard_msg_submit submit;
    sheard_rpc_error error;
    const int rc = sheard_job_file_parse(&submit, l->line, l->n, NULL, &error);
    sheard_submit_deinit(&submit);
    return rc;
}

static void test_scarce_others(void **state) {
    (void)state;
    uint64_t seed = 15;
    sheard_rpc_error error;
    sheard_rpc_fail(&error, SHEARD_RPC_BAD_FILE, NULL, "a message that is longer than a few bytes");
    refuse_each(write_error, &error);
    sheard_notice_params params;
    fill(&params, rpc_notices[SHEARD_NOTICE_JOB_CHANGED].params, &seed);
    refuse_each(write_notice, &params);
    line_of l = {0};
    assert_int_equal(sheard_notice_line(&l.line, &l.n, SHEARD_NOTICE_JOB_CHANGED, &params, &error),
                     0);
    refuse_each(read_notice, &l);
    free(l.line);
    msg_deinit(&params, rpc_notices[SHEARD_NOTICE_JOB_CHANGED].params);
    sheard_msg_side side;
    fill(&side, &msg_side, &seed);
    refuse_each(write_side, &side);
    msg_deinit(&side, &msg_side);
    sheard_msg_source source = {.path = "/data/some/where/with a long name.fits"};
    refuse_each(write_source, &source);
    char text[] =
        "{\"path\":\"/data/some/where/with a long name.fits\",\"field\":\"fourteen bytes\","
        "\"settings\":{\"beta\":1.2345678901234567}}";
    l = (line_of){.line = text, .n = strlen(text)};
    refuse_each(read_job_file, &l);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mutated_requests), cmocka_unit_test(test_mutated_replies),
        cmocka_unit_test(test_scarce_requests),  cmocka_unit_test(test_scarce_replies),
        cmocka_unit_test(test_scarce_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
