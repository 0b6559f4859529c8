/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a client reads: replies of a newer service, and wrong ones. */
#include "rpc_fixture.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

static void read_error_line(const char *line, size_t n, sheard_message *m) {
    sheard_rpc_error error = {0};
    if (sheard_message_parse(m, line, n, &error) != SHEARD_RPC_OK)
        fail_msg("%s: %s", line, error.message);
    assert_int_equal(m->kind, SHEARD_MESSAGE_ERROR);
}

static void test_newer_service(void **state) {
    (void)state;
    sheard_message m;
    sheard_rpc_error error;
    static const char unknown_error[] =
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":-32011,\"message\":\"m\",\"more\":1,"
        "\"data\":{\"code\":\"sun_is_up\",\"retry\":true,\"why\":[]}},\"x\":2}";
    read_error_line(unknown_error, sizeof unknown_error - 1, &m);
    assert_int_equal(m.error.code, SHEARD_RPC_UNKNOWN);
    assert_string_equal(m.error.name, "sun_is_up");
    assert_true(m.error.retry);
    sheard_message_deinit(&m);
    static const char bare[] =
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":-32700,\"message\":"
        "\"m\"}}";
    read_error_line(bare, sizeof bare - 1, &m);
    assert_int_equal(m.error.code, SHEARD_RPC_UNKNOWN);
    sheard_message_deinit(&m);
    static const char notice[] =
        "{\"jsonrpc\":\"2.0\",\"method\":\"weather\",\"params\":{\"x\":1}}";
    assert_int_equal(sheard_message_parse(&m, notice, sizeof notice - 1, &error), SHEARD_RPC_OK);
    assert_int_equal(m.kind, SHEARD_MESSAGE_NOTICE);
    assert_int_equal(m.notice, -1);
    sheard_message_deinit(&m);
    static const char job[] =
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{\"id\":4,\"state\":\"dreaming\",\"colour\":3,"
        "\"settings\":{\"new-setting\":1,\"beta\":2},\"priority\":5000}}";
    assert_int_equal(sheard_message_parse(&m, job, sizeof job - 1, &error), SHEARD_RPC_OK);
    sheard_reply reply;
    assert_int_equal(sheard_message_reply(&m, SHEARD_METHOD_RETRY, &reply, &error), SHEARD_RPC_OK);
    assert_int_equal(reply.retry.state, -1);
    assert_string_equal(reply.retry.settings, "beta=2\n");
    assert_int_equal(reply.retry.priority, 5000);
    assert_int_equal(reply.retry.progress.total, -1);
    sheard_reply_deinit(&reply, SHEARD_METHOD_RETRY);
    sheard_message_deinit(&m);
}

static void test_bad_replies(void **state) {
    (void)state;
    static const char *const bad[] = {
        "",
        "{",
        "[]",
        "3",
        "{}",
        "{\"jsonrpc\":\"2.0\"}",
        "{\"jsonrpc\":\"2.0\",\"id\":1}",
        "{\"jsonrpc\":\"1.0\",\"id\":1,\"result\":{}}",
        "{\"jsonrpc\":\"2.0\",\"result\":{}}",
        "{\"jsonrpc\":\"2.0\",\"id\":[],\"result\":{}}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{},\"result\":{}}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{},\"error\":{\"code\":1,\"message\":\"\"}}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":3}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":\"1\",\"message\":\"\"}}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":1}}",
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"error\":{\"code\":1,\"message\":\"\",\"data\":[]}}",
        "{\"jsonrpc\":\"2.0\",\"method\":1}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"lost\"}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"lost\",\"params\":{\"count\":\"1\"}}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"lost\",\"params\":[1]}",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        sheard_message m;
        sheard_rpc_error error = {0};
        if (sheard_message_parse(&m, bad[i], strlen(bad[i]), &error) != SHEARD_RPC_BAD_REPLY)
            fail_msg("%s was taken", bad[i]);
        assert_int_equal(error.code, SHEARD_RPC_BAD_REPLY);
        sheard_message_deinit(&m);
    }
}

static void test_bad_results(void **state) {
    (void)state;
    static const struct {
        const char *result;
        int method;
    } bad[] = {
        {"[]", SHEARD_METHOD_STATUS},
        {"null", SHEARD_METHOD_STATUS},
        {"{}", SHEARD_METHOD_STATUS},
        {"{\"version\":\"1\",\"state\":\"running\",\"pid\":\"x\"}", SHEARD_METHOD_STATUS},
        {"{\"id\":\"1\",\"state\":\"done\"}", SHEARD_METHOD_CANCEL},
        {"{\"id\":1,\"state\":3}", SHEARD_METHOD_CANCEL},
        {"{\"id\":1,\"state\":\"done\",\"created\":\"yesterday\"}", SHEARD_METHOD_CANCEL},
        {"{\"id\":1,\"state\":\"done\",\"result\":[]}", SHEARD_METHOD_CANCEL},
        {"{\"id\":1,\"state\":\"done\",\"field\":\"a\\u0000b\"}", SHEARD_METHOD_CANCEL},
        {"{\"jobs\":[{\"id\":1,\"state\":\"done\",\"field\":\"x\"},{}]}", SHEARD_METHOD_JOBS},
        {"{\"jobs\":3}", SHEARD_METHOD_JOBS},
        {"{\"field\":\"A\",\"rows\":[{\"digest\":\"d\",\"running\":[0.5]}]}", SHEARD_METHOD_FIELD},
        {"{}", -1},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char line[300];
        snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":%s}", bad[i].result);
        sheard_message m;
        sheard_reply reply;
        sheard_rpc_error error = {0};
        assert_int_equal(sheard_message_parse(&m, line, strlen(line), &error), SHEARD_RPC_OK);
        if (sheard_message_reply(&m, bad[i].method, &reply, &error) != SHEARD_RPC_BAD_REPLY)
            fail_msg("%s was taken", bad[i].result);
        sheard_reply_deinit(&reply, bad[i].method);
        sheard_message_deinit(&m);
    }
}

/* The client hears the daemon's own words before it sends. */
static void test_client_checks(void **state) {
    (void)state;
    const sheard_rpc_id id = {.type = SHEARD_ID_NULL};
    sheard_params params;
    sheard_params_init(&params, SHEARD_METHOD_JOBS);
    params.jobs.limit = 1000;
    char *line = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    assert_int_equal(sheard_request_line(&line, &n, &id, SHEARD_METHOD_JOBS, &params, &error),
                     SHEARD_RPC_BAD_PARAMETER);
    assert_string_equal(error.parameter, "limit");
    sheard_params_init(&params, SHEARD_METHOD_SUBMIT);
    params.submit.source.path = "/a";
    params.submit.settings = "beta=hello\n";
    assert_int_equal(sheard_request_line(&line, &n, &id, SHEARD_METHOD_SUBMIT, &params, &error),
                     SHEARD_RPC_BAD_SETTING);
    assert_int_equal(sheard_request_line(&line, &n, &id, SHEARD_N_METHODS, NULL, &error),
                     SHEARD_RPC_INTERNAL);
    const sheard_reply reply = {.metrics = {.text = "x"}};
    assert_int_equal(sheard_reply_line(&line, &n, &id, -1, &reply, &error), SHEARD_RPC_INTERNAL);
    assert_int_equal(sheard_notice_line(&line, &n, -1, NULL, &error), SHEARD_RPC_INTERNAL);
    assert_null(line);
    assert_int_equal(sheard_request_line(&line, &n, &id, SHEARD_METHOD_DRAIN, NULL, &error), 0);
    assert_string_equal(line,
                        "{\"jsonrpc\":\"2.0\",\"id\":null,\"method\":\"drain\",\"params\":{}}\n");
    free(line);
}

/* A path may be within its limit and yet need more than a line, as JSON writes it. */
static void test_client_line_limit(void **state) {
    (void)state;
    char path[SHEARD_MSG_PATH_MAX + 1];
    memset(path, '\x01', sizeof path - 1);
    path[0] = '/';
    path[sizeof path - 1] = '\0';
    const sheard_rpc_id id = {.type = SHEARD_ID_NULL};
    sheard_params params;
    sheard_params_init(&params, SHEARD_METHOD_SUBMIT);
    params.submit.source.path = path;
    char *line = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    assert_int_equal(sheard_request_line(&line, &n, &id, SHEARD_METHOD_SUBMIT, &params, &error), 0);
    free(line);
    params.submit.source.path = NULL;
    params.submit.source.galaxy.path = path;
    params.submit.source.noise.path = path;
    params.submit.source.psf.path = path;
    assert_int_equal(sheard_request_line(&line, &n, &id, SHEARD_METHOD_SUBMIT, &params, &error),
                     SHEARD_RPC_LINE_TOO_LONG);
    assert_null(line);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_newer_service),     cmocka_unit_test(test_bad_replies),
        cmocka_unit_test(test_bad_results),       cmocka_unit_test(test_client_checks),
        cmocka_unit_test(test_client_line_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
