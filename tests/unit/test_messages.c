/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages: written and read back they are the same, to the last bit. */
#include "rpc_fixture.h"
#include "test.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 40 };

static const sheard_rpc_id id_7 = {.type = SHEARD_ID_INTEGER, .integer = 7};

/* A line without its \n must hold none, and read as itself. */
static void assert_one_line(const char *line, size_t n) {
    assert_int_equal(strlen(line), n);
    assert_ptr_equal(strchr(line, '\n'), line + n - 1);
}

static void test_requests(void **state) {
    (void)state;
    uint64_t seed = 1;
    for (int i = 0; i < ROUNDS * SHEARD_N_METHODS; i++) {
        const int method = i % SHEARD_N_METHODS;
        sheard_params params;
        fill_params(&params, method, &seed);
        char *line = NULL;
        size_t n = 0;
        sheard_rpc_error error = {0};
        const int rc = sheard_request_line(&line, &n, &id_7, method, &params, &error);
        if (rc != SHEARD_RPC_OK)
            fail_msg("%s: %s", sheard_method_name(method), error.message);
        assert_one_line(line, n);
        sheard_request back;
        assert_int_equal(sheard_request_parse(&back, line, n - 1, NULL, &error), SHEARD_RPC_OK);
        assert_int_equal(back.method, method);
        assert_true(sheard_rpc_id_equal(&back.id, &id_7));
        assert_same(&params, &back.params, rpc_methods[method].params);
        free(line);
        sheard_request_deinit(&back);
        sheard_request_deinit(&back);
        msg_deinit(&params, rpc_methods[method].params);
    }
}

/* One of several parameters must be there: submit's source, what to subscribe to. */
static bool needs_params(int method) {
    const msg_table *table = rpc_methods[method].params;
    for (size_t i = 0; i < table->n; i++) {
        if ((table->members[i].flags & MSG_REQUIRED) != 0)
            return true;
    }
    return method == SHEARD_METHOD_SUBMIT || method == SHEARD_METHOD_SUBSCRIBE;
}

/* What is at its default is not said, and comes back. */
static void test_defaults(void **state) {
    (void)state;
    for (int method = 0; method < SHEARD_N_METHODS; method++) {
        sheard_params params;
        sheard_params_init(&params, method);
        char *line = NULL;
        size_t n = 0;
        sheard_rpc_error error;
        const int rc = sheard_request_line(&line, &n, &id_7, method, &params, &error);
        assert_int_equal(rc == SHEARD_RPC_OK, !needs_params(method));
        if (rc != SHEARD_RPC_OK) {
            assert_int_equal(rc, SHEARD_RPC_MISSING_PARAMETER);
            assert_null(line);
            continue;
        }
        char expected[200];
        snprintf(expected, sizeof expected,
                 "{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"%s\",\"params\":{}}\n",
                 sheard_method_name(method));
        assert_string_equal(line, expected);
        free(line);
    }
    sheard_params jobs;
    sheard_params_init(&jobs, SHEARD_METHOD_JOBS);
    assert_int_equal(jobs.jobs.limit, 50);
    assert_int_equal(jobs.jobs.owner, -1);
}

static void test_replies(void **state) {
    (void)state;
    uint64_t seed = 2;
    for (int i = 0; i < ROUNDS * SHEARD_N_METHODS; i++) {
        const int method = i % SHEARD_N_METHODS;
        const msg_table *table = rpc_methods[method].reply;
        sheard_reply reply;
        fill(&reply, table, &seed);
        char *line = NULL;
        size_t n = 0;
        sheard_rpc_error error = {0};
        const int rc = sheard_reply_line(&line, &n, &id_7, method, &reply, &error);
        if (rc != SHEARD_RPC_OK)
            fail_msg("%s: %s", sheard_method_name(method), error.message);
        assert_one_line(line, n);
        sheard_message message;
        assert_int_equal(sheard_message_parse(&message, line, n - 1, &error), SHEARD_RPC_OK);
        assert_int_equal(message.kind, SHEARD_MESSAGE_REPLY);
        assert_true(sheard_rpc_id_equal(&message.id, &id_7));
        sheard_reply back;
        assert_int_equal(sheard_message_reply(&message, method, &back, &error), SHEARD_RPC_OK);
        assert_same(&reply, &back, table);
        char *text = NULL;
        assert_int_equal(sheard_message_text(&message, &text, &error), SHEARD_RPC_OK);
        assert_non_null(strstr(line, text));
        free(text);
        free(line);
        sheard_message_deinit(&message);
        sheard_reply_deinit(&back, method);
        msg_deinit(&reply, table);
    }
}

static void test_notices(void **state) {
    (void)state;
    uint64_t seed = 3;
    for (int i = 0; i < ROUNDS * SHEARD_N_NOTICES; i++) {
        const int notice = i % SHEARD_N_NOTICES;
        sheard_notice_params params;
        fill(&params, rpc_notices[notice].params, &seed);
        char *line = NULL;
        size_t n = 0;
        sheard_rpc_error error;
        assert_int_equal(sheard_notice_line(&line, &n, notice, &params, &error), SHEARD_RPC_OK);
        assert_one_line(line, n);
        sheard_message message;
        assert_int_equal(sheard_message_parse(&message, line, n - 1, &error), SHEARD_RPC_OK);
        assert_int_equal(message.kind, SHEARD_MESSAGE_NOTICE);
        assert_int_equal(message.notice, notice);
        assert_same(&params, &message.params, rpc_notices[notice].params);
        free(line);
        sheard_message_deinit(&message);
        msg_deinit(&params, rpc_notices[notice].params);
    }
}

static void test_sources_and_sides(void **state) {
    (void)state;
    uint64_t seed = 4;
    for (int i = 0; i < ROUNDS; i++) {
        sheard_rpc_error error;
        char *text = NULL;
        sheard_params params;
        fill_params(&params, SHEARD_METHOD_SUBMIT, &seed);
        assert_int_equal(sheard_source_text(&text, &params.submit.source, &error), SHEARD_RPC_OK);
        sheard_msg_source source;
        assert_int_equal(sheard_source_parse(&source, text, &error), SHEARD_RPC_OK);
        assert_same(&params.submit.source, &source, &msg_source);
        free(text);
        sheard_source_deinit(&source);
        sheard_submit_deinit(&params.submit);

        sheard_msg_side side;
        fill(&side, &msg_side, &seed);
        assert_int_equal(sheard_side_text(&text, &side, &error), SHEARD_RPC_OK);
        assert_int_equal(text[strlen(text) - 1], '\n');
        sheard_msg_side back;
        assert_int_equal(sheard_side_parse(&back, text, strlen(text), &error), SHEARD_RPC_OK);
        assert_same(&side, &back, &msg_side);
        free(text);
        sheard_side_deinit(&side);
        sheard_side_deinit(&back);
    }
}

/* The very text of one of each kind, so that both sides cannot be wrong alike. */
static void test_wire(void **state) {
    (void)state;
    sheard_rpc_error error;
    char *line = NULL;
    size_t n = 0;
    sheard_params params;
    sheard_params_init(&params, SHEARD_METHOD_SUBMIT);
    params.submit.source.galaxy = (sheard_msg_image){"/data/g.fits", 1, NULL};
    params.submit.source.noise = (sheard_msg_image){"/data/n.fits", -1, "SKY"};
    params.submit.source.psf = (sheard_msg_image){"/data/p.fits", 0, NULL};
    params.submit.settings = "beta=1.5\nnoise-correction=false\nzeros=floor\n";
    params.submit.priority = -3;
    params.submit.key = "k";
    params.submit.wait = true;
    assert_int_equal(sheard_request_line(&line, &n, &id_7, SHEARD_METHOD_SUBMIT, &params, &error),
                     0);
    assert_string_equal(
        line, "{\"jsonrpc\":\"2.0\",\"id\":7,\"method\":\"submit\",\"params\":{"
              "\"galaxy\":{\"path\":\"/data/g.fits\",\"hdu\":1},"
              "\"noise\":{\"path\":\"/data/n.fits\",\"extname\":\"SKY\"},"
              "\"psf\":{\"path\":\"/data/p.fits\",\"hdu\":0},"
              "\"settings\":{\"beta\":1.5,\"noise-correction\":false,\"zeros\":\"floor\"},"
              "\"priority\":-3,\"key\":\"k\",\"wait\":true}}\n");
    free(line);
    const int64_t running[] = {3};
    const sheard_msg_field_row row = {.report = "{\"g1\":0.01,\"g2\":null}",
                                      .digest = "d",
                                      .jobs = 2,
                                      .unfinished = 1,
                                      .partial = true,
                                      .running = running,
                                      .n_running = 1,
                                      .updated_ms = 1};
    sheard_reply reply = {.field = {.field = "A", .rows = &row, .n_rows = 1}};
    const sheard_rpc_id text_id = {.type = SHEARD_ID_TEXT, .text = "x\"y"};
    assert_int_equal(sheard_reply_line(&line, &n, &text_id, SHEARD_METHOD_FIELD, &reply, &error),
                     0);
    assert_string_equal(
        line, "{\"jsonrpc\":\"2.0\",\"id\":\"x\\\"y\",\"result\":{\"field\":\"A\",\"mixed\":false,"
              "\"rows\":[{\"g1\":0.01,\"g2\":null,\"digest\":\"d\",\"jobs\":2,\"unfinished\":1,"
              "\"partial\":true,\"running\":[3],\"updated\":\"1970-01-01T00:00:00.001Z\","
              "\"contributions\":[],\"more\":false,\"files_left_out\":0,\"reason\":null,"
              "\"culprit\":null}]}}\n");
    free(line);
    const sheard_notice_params lost = {.lost = {.count = 12}};
    assert_int_equal(sheard_notice_line(&line, &n, SHEARD_NOTICE_LOST, &lost, &error), 0);
    assert_string_equal(line,
                        "{\"jsonrpc\":\"2.0\",\"method\":\"lost\",\"params\":{\"count\":12}}\n");
    free(line);
}

/* Item by item, the bytes are the same: also where the id and the texts look like the list. */
static void test_lists_by_items(void **state) {
    (void)state;
    static const int methods[] = {SHEARD_METHOD_JOBS, SHEARD_METHOD_WAIT, SHEARD_METHOD_FIELDS,
                                  SHEARD_METHOD_FIELD};
    const sheard_rpc_id tricky = {.type = SHEARD_ID_TEXT,
                                  .text = "\"jobs\":[],\"fields\":[],\"rows\":[]"};
    uint64_t seed = 11;
    sheard_rpc_error error;
    for (int round = 0; round < 200; round++) {
        const int method = methods[round % 4];
        const msg_table *table = rpc_methods[method].reply;
        sheard_reply reply;
        char *whole;
        size_t n_whole;
        fill(&reply, table, &seed);
        assert_int_equal(sheard_reply_line(&whole, &n_whole, &tricky, method, &reply, &error), 0);
        const msg_member *list = table->members;
        while (list->type != MSG_OBJECTS)
            list++;
        size_t *count = (size_t *)((char *)&reply + list->count_offset);
        const size_t n = *count;
        char items[1 << 16] = "";
        size_t used = 0;
        for (size_t i = 0; i < n; i++) {
            char *text;
            size_t length;
            const char *item = (const char *)msg_pointer(&reply, list->offset);
            assert_int_equal(
                sheard_reply_item(&text, &length, method, item + i * list->table->size, &error), 0);
            assert_int_equal(strlen(text), length);
            used += (size_t)snprintf(items + used, sizeof items - used, "%s%s", i != 0 ? "," : "",
                                     text);
            assert_true(used < sizeof items);
            free(text);
        }
        *count = 0;
        char *line;
        size_t n_line;
        assert_int_equal(
            sheard_reply_list_line(&line, &n_line, &tricky, method, &reply, items, used, &error),
            0);
        assert_string_equal(line, whole);
        assert_int_equal(n_line, n_whole);
        *count = n;
        free(line);
        free(whole);
        msg_deinit(&reply, table);
    }
    char *text;
    size_t n;
    assert_int_equal(sheard_reply_item(&text, &n, SHEARD_METHOD_HELLO, &seed, &error),
                     SHEARD_RPC_INTERNAL);
}

/* Numbers keep their bits; what is not finite is null; texts that are not UTF-8 are said with
 * U+FFFD, but never in a request. */
static void test_values(void **state) {
    (void)state;
    const double values[] = {0.1,     -0.0,     1.0 / 3,
                             DBL_MIN, DBL_MAX,  -DBL_TRUE_MIN,
                             5e-324,  1e22,     123456789012345678.0,
                             NAN,     INFINITY, -INFINITY};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        const sheard_msg_summary summary = {.field = "A\xFF", .digest = "d", .g1 = values[i]};
        const sheard_reply reply = {.fields = {.fields = &summary, .n_fields = 1}};
        char *line = NULL;
        size_t n = 0;
        sheard_rpc_error error;
        sheard_message message;
        sheard_reply back;
        assert_int_equal(sheard_reply_line(&line, &n, &id_7, SHEARD_METHOD_FIELDS, &reply, &error),
                         0);
        assert_int_equal(sheard_message_parse(&message, line, n - 1, &error), 0);
        assert_int_equal(sheard_message_reply(&message, SHEARD_METHOD_FIELDS, &back, &error), 0);
        const double got = back.fields.fields[0].g1;
        if (isfinite(values[i])) {
            assert_memory_equal(&got, &values[i], sizeof got);
        } else {
            assert_true(isnan(got));
            assert_non_null(strstr(line, "\"g1\":null"));
        }
        assert_string_equal(back.fields.fields[0].field, "A\xEF\xBF\xBD");
        free(line);
        sheard_message_deinit(&message);
        sheard_reply_deinit(&back, SHEARD_METHOD_FIELDS);
    }
    sheard_params params;
    sheard_params_init(&params, SHEARD_METHOD_SUBMIT);
    params.submit.source.path = "/data/\xFF.fits";
    char *line = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    assert_int_equal(sheard_request_line(&line, &n, &id_7, SHEARD_METHOD_SUBMIT, &params, &error),
                     SHEARD_RPC_BAD_PARAMETER);
    assert_string_equal(error.parameter, "path");
    assert_null(line);
}

/* A raw text that is no JSON object is a bug of the caller's, not a broken line. */
static void test_bad_raw(void **state) {
    (void)state;
    static const char *const bad[] = {"", "{", "[1]", "{\"a\":1,\"a\":2}", "{} {}", "\xFF"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        const sheard_reply reply = {.cancel = {.id = 1, .result = bad[i]}};
        char *line = NULL;
        size_t n = 0;
        sheard_rpc_error error;
        assert_int_equal(sheard_reply_line(&line, &n, &id_7, SHEARD_METHOD_CANCEL, &reply, &error),
                         SHEARD_RPC_INTERNAL);
        assert_null(line);
    }
    const sheard_reply reply = {.cancel = {.id = 1, .settings = "beta=hello\n"}};
    char *line = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    assert_int_equal(sheard_reply_line(&line, &n, &id_7, SHEARD_METHOD_CANCEL, &reply, &error),
                     SHEARD_RPC_INTERNAL);
}

static void test_names(void **state) {
    (void)state;
    assert_string_equal(sheard_job_state_name(SHEARD_JOB_WAITING), "waiting");
    assert_string_equal(sheard_job_state_name(-1), "unknown");
    assert_string_equal(sheard_job_state_name(SHEARD_N_JOB_STATES), "unknown");
    assert_string_equal(sheard_job_class_name(SHEARD_CLASS_NONE), "");
    assert_string_equal(sheard_job_class_name(SHEARD_CLASS_BUG), "bug");
    assert_string_equal(sheard_job_outcome_name(SHEARD_OUTCOME_DUPLICATE), "duplicate");
    assert_string_equal(sheard_job_origin_name(SHEARD_ORIGIN_SOCKET), "socket");
    assert_string_equal(sheard_attempt_outcome_name(SHEARD_ATTEMPT_INTERRUPTED), "interrupted");
    assert_string_equal(sheard_server_state_name(SHEARD_SERVER_STOPPING), "stopping");
    for (int s = -1; s <= SHEARD_N_JOB_STATES; s++) {
        assert_int_equal(sheard_job_state_is_final(s),
                         s >= SHEARD_JOB_DONE && s < SHEARD_N_JOB_STATES);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_requests),          cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_replies),           cmocka_unit_test(test_notices),
        cmocka_unit_test(test_sources_and_sides), cmocka_unit_test(test_wire),
        cmocka_unit_test(test_lists_by_items),    cmocka_unit_test(test_values),
        cmocka_unit_test(test_bad_raw),           cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
