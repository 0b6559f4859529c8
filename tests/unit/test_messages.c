/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages: written and read back they are the same, to the last bit; settings have one text;
 * times. */
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

/* ---- Settings ---- */

static void given_text(const char *json, char *out, size_t size) {
    char text[2000];
    snprintf(text, sizeof text, "{\"path\": \"/a\", \"settings\": %s}", json);
    sheard_msg_submit submit;
    sheard_rpc_error error = {0};
    if (sheard_job_file_parse(&submit, text, strlen(text), NULL, &error) != SHEARD_RPC_OK)
        fail_msg("%s: %s", json, error.message);
    snprintf(out, size, "%s", submit.settings != NULL ? submit.settings : "(none)");
    sheard_submit_deinit(&submit);
}

static void test_settings_have_one_text(void **state) {
    (void)state;
    static const char *const same[][2] = {
        {"{}", "(none)"},
        {"null", "(none)"},
        {"{\"zeros\": \"floor\", \"beta\": 2}", "beta=2\nzeros=floor\n"},
        {"{\"beta\": 2.0, \"zeros\": \"floor\"}", "beta=2\nzeros=floor\n"},
        {"{\"beta\": 20e-1}", "beta=2\n"},
        {"{\"beta\": 0.1}", "beta=0.1\n"},
        {"{\"beta\": 0.10000000000000001}", "beta=0.1\n"},
        {"{\"beta\": \"auto\"}", "beta=auto\n"},
        {"{\"beta_ratio\": 1.5}", "beta-ratio=1.5\n"},
        {"{\"pedestal\": -0.0}", "pedestal=0\n"},
        {"{\"pedestal\": 0}", "pedestal=0\n"},
        {"{\"oversample\": \"auto\"}", "oversample=auto\n"},
        {"{\"interpolation\": \"log_bicubic\"}", "interpolation=log-bicubic\n"},
        {"{\"noise-correction\": true}", "noise-correction=true\n"},
        {"{\"beta-ratio\": 3, \"preset\": \"zhang2010\"}", "preset=zhang2010\nbeta-ratio=3\n"},
        {"{\"preset\": \"zhang2010\", \"beta-ratio\": 3}", "preset=zhang2010\nbeta-ratio=3\n"},
    };
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) {
        char text[SHEARD_MSG_SETTINGS_SIZE];
        given_text(same[i][0], text, sizeof text);
        assert_string_equal(text, same[i][1]);
    }
}

/* Sum of bytes: a digest that the eye can follow. */
static void add_bytes(const void *bytes, size_t n, char *hex, size_t size) {
    unsigned sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += ((const unsigned char *)bytes)[i];
    snprintf(hex, size, "%08x", sum);
}

/* A line for each setting in the order of the table, with the defaults but for what
 * test_whole_settings gives; and some of them by heart, since stored digests depend on them. */
static void assert_canonical(const char *text) {
    static const char *const given[][2] = {{"beta", "1.7"}, {"core", "7"}, {"pedestal", "0.25"}};
    char expected[SHEARD_MSG_SETTINGS_SIZE] = "";
    shear_settings defaults;
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    shear_settings_init(&defaults);
    for (size_t i = 0; i < n; i++) {
        char value[64];
        shear_settings_format(&defaults, &table[i], value, sizeof value);
        for (size_t k = 0; k < sizeof given / sizeof given[0]; k++) {
            if (strcmp(table[i].name, given[k][0]) == 0)
                snprintf(value, sizeof value, "%s", given[k][1]);
        }
        const size_t used = strlen(expected);
        snprintf(expected + used, sizeof expected - used, "%s=%s\n", table[i].name, value);
    }
    assert_string_equal(text, expected);
    static const char begin[] = "preset=default\ninterpolation=auto\noversample=auto\nbeta=1.7\n"
                                "beta-ratio=2\nbeta-floor=1.4\nfilter=auto\ncore=7\nwidth=auto\n";
    assert_memory_equal(text, begin, sizeof begin - 1);
    assert_non_null(strstr(text, "\npedestal=0.25\npsf-threshold=1e-08\npower-tolerance=0.001\n"
                                 "noise-correction=true\n"));
}

static void test_whole_settings(void **state) {
    (void)state;
    shear_settings s;
    shear_settings t;
    shear_error err;
    char text[SHEARD_MSG_SETTINGS_SIZE];
    char again[SHEARD_MSG_SETTINGS_SIZE];
    shear_settings_init(&s);
    assert_int_equal(sheard_settings_apply(&s, "pedestal=0.25\ncore=7\nbeta=1.7", &err), SHEAR_OK);
    assert_int_equal(sheard_settings_write(&s, text, sizeof text, &err), SHEAR_OK);
    assert_canonical(text);
    shear_settings_init(&t);
    assert_int_equal(sheard_settings_apply(&t, text, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_write(&t, again, sizeof again, &err), SHEAR_OK);
    assert_string_equal(text, again);
    t.pedestal = -0.0;
    s.pedestal = 0.0;
    char a[16];
    char b[16];
    assert_int_equal(sheard_settings_digest(&s, add_bytes, a, sizeof a, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_digest(&t, add_bytes, b, sizeof b, &err), SHEAR_OK);
    assert_string_equal(a, b);
    t.beta_ratio = 1.6;
    assert_int_equal(sheard_settings_digest(&t, add_bytes, b, sizeof b, &err), SHEAR_OK);
    assert_string_not_equal(a, b);
    const size_t exact = strlen(text) + 1;
    assert_int_equal(sheard_settings_apply(&s, text, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_write(&s, again, exact, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_write(&s, again, exact - 1, &err), SHEAR_E_SETTING);
    assert_int_equal(sheard_settings_write(&s, again, 0, &err), SHEAR_E_SETTING);
}

/* Settings as 0.1 wrote them: they say nothing of what came later, and their `auto` is not today's.
 */
static void test_settings_of_0_1(void **state) {
    (void)state;
    static const char old[] =
        "interpolation=auto\noversample=auto\nbeta=auto\nbeta-ratio=1.5\nfilter=auto\ncore=auto\n"
        "width=auto\nbackground=keep\nzeros=skip\npedestal=0\npsf-threshold=1e-08\n"
        "power-tolerance=0.001\nnoise-correction=true\nshot-noise=none\nestimator=mean\n";
    shear_settings paper;
    shear_settings s;
    shear_error err = {0};
    char a[SHEARD_MSG_SETTINGS_SIZE];
    char b[SHEARD_MSG_SETTINGS_SIZE];
    shear_settings_init(&paper);
    assert_int_equal(shear_settings_set(&paper, "preset", "zhang2010", &err), SHEAR_OK);
    assert_int_equal(sheard_settings_write(&paper, a, sizeof a, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_read(&s, old, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_write(&s, b, sizeof b, &err), SHEAR_OK);
    assert_string_equal(a, b);
    assert_int_equal(sheard_settings_read(
                         &s, "interpolation=spline\nbeta-ratio=1.7\nfilter=auto\ncore=7\n", &err),
                     SHEAR_OK);
    assert_true(s.interpolation == SHEAR_INTERP_SPLINE && s.beta_ratio == 1.7 && s.core_px == 7.0);
    assert_true(s.noise_level == SHEAR_NOISE_LEVEL_NONE && s.filter == SHEAR_FILTER_R_GAL);
    shear_settings_init(&paper); /* today's read back as they are */
    assert_int_equal(sheard_settings_write(&paper, a, sizeof a, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_read(&s, a, &err), SHEAR_OK);
    assert_int_equal(sheard_settings_write(&s, b, sizeof b, &err), SHEAR_OK);
    assert_string_equal(a, b);
    assert_int_equal(sheard_settings_read(&s, "beta=x\n", &err), SHEAR_E_SETTING);
}

static void test_bad_settings_text(void **state) {
    (void)state;
    static const char *const bad[] = {"beta\n", "beta=x\n",       "no-such=1\n",           "=1\n",
                                      "\n",     "oversample=3\n", "filter=none\nwidth=2\n"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        shear_settings s;
        shear_error err = {0};
        shear_settings_init(&s);
        assert_int_equal(sheard_settings_apply(&s, bad[i], &err), SHEAR_E_SETTING);
        assert_int_not_equal(err.message[0], '\0');
    }
    char longest[400];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    shear_settings s;
    shear_error err;
    shear_settings_init(&s);
    assert_int_equal(sheard_settings_apply(&s, longest, &err), SHEAR_E_SETTING);
}

/* Every setting of the table: its bounds, what is beyond, every choice, every wrong type. */
static void assert_setting(const char *name, const char *value, bool good) {
    char text[300];
    snprintf(text, sizeof text, "{\"path\":\"/a\",\"settings\":{\"%s\":%s}}", name, value);
    sheard_msg_submit submit;
    sheard_rpc_error error = {0};
    const int rc = sheard_job_file_parse(&submit, text, strlen(text), NULL, &error);
    if (good != (rc == SHEARD_RPC_OK))
        fail_msg("%s: %s", text, error.message);
    if (!good) {
        assert_int_equal(rc, SHEARD_RPC_BAD_SETTING);
        snprintf(text, sizeof text, "settings.%s", name);
        assert_string_equal(error.parameter, text);
        assert_null(submit.source.path);
    }
    sheard_submit_deinit(&submit);
}

static void assert_number_setting(const shear_setting_def *def) {
    char text[64];
    snprintf(text, sizeof text, "%.17g", def->min);
    assert_setting(def->name, text, true);
    snprintf(text, sizeof text, "%.17g", def->max);
    assert_setting(def->name, text, true);
    snprintf(text, sizeof text, "%.17g",
             def->min > 0   ? def->min / 2
             : def->min < 0 ? def->min * 2
                            : -1.0);
    assert_setting(def->name, text, false);
    if (def->max < DBL_MAX) {
        snprintf(text, sizeof text, "%.17g", def->max * 2);
        assert_setting(def->name, text, false);
    }
    const bool automatic = def->has_auto && strcmp(shear_setting_auto(def), "auto") == 0;
    assert_setting(def->name, "\"auto\"", automatic);
    assert_setting(def->name, "\"none\"", def->has_auto && !automatic);
    assert_setting(def->name, "\"1\"", false);
    assert_setting(def->name, "true", false);
}

static void test_every_setting(void **state) {
    (void)state;
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        const shear_setting_def *def = &table[i];
        if (def->type == SHEAR_T_CHOICE) {
            for (int k = 0; def->choices[k]; k++) {
                char text[64];
                snprintf(text, sizeof text, "\"%s\"", def->choices[k]);
                assert_setting(def->name, text, true);
            }
            assert_setting(def->name, "\"\"", false);
            assert_setting(def->name, "\"none\\u0000\"", false);
            assert_setting(def->name, "1", false);
        } else if (def->type == SHEAR_T_BOOL) {
            assert_setting(def->name, "true", true);
            assert_setting(def->name, "false", true);
            assert_setting(def->name, "1", false);
            assert_setting(def->name, "\"true\"", false);
        } else {
            assert_number_setting(def);
        }
        assert_setting(def->name, "null", false);
        assert_setting(def->name, "[]", false);
        assert_setting(def->name, "{}", false);
    }
    assert_setting("no-such-setting", "1", false);
    assert_setting("oversample", "2.0", false);
    assert_setting("oversample", "1e3", false);
}

/* ---- Times ---- */

static void test_times(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int64_t ms;
    } known[] = {
        {"1970-01-01T00:00:00.000Z", 0},
        {"1970-01-01T00:00:00Z", 0},
        {"1969-12-31T23:59:59.999Z", -1},
        {"2000-02-29T12:00:00.5Z", INT64_C(951825600500)},
        {"2026-11-22T00:19:03.123Z", INT64_C(1795306743123)},
        {"2026-11-22t01:49:03.1239z", INT64_C(1795312143123)},
        {"2026-11-22T01:49:03.123+01:30", INT64_C(1795306743123)},
        {"2026-11-21T16:19:03.123-08:00", INT64_C(1795306743123)},
        {"2016-12-31T23:59:60Z", INT64_C(1483228800000)},
        {"9999-12-31T23:59:59.999Z", INT64_C(253402300799999)},
        {"0000-01-01T00:00:00.000Z", INT64_C(-62167219200000)},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        int64_t ms = 1;
        assert_true(sheard_time_parse(&ms, known[i].text));
        assert_int_equal(ms, known[i].ms);
        char text[SHEARD_TIME_SIZE];
        int64_t again = 1;
        assert_true(sheard_time_parse(&again, sheard_time_format(ms, text)));
        assert_int_equal(again, ms);
        assert_int_equal(strlen(text), strlen("2026-11-22T00:19:03.123Z"));
    }
    char text[SHEARD_TIME_SIZE];
    assert_string_equal(sheard_time_format(INT64_C(1795306743123), text),
                        "2026-11-22T00:19:03.123Z");
    assert_string_equal(sheard_time_format(-1, text), "1969-12-31T23:59:59.999Z");
    assert_string_equal(sheard_time_format(INT64_MAX, text), "9999-12-31T23:59:59.999Z");
    assert_string_equal(sheard_time_format(INT64_MIN, text), "0000-01-01T00:00:00.000Z");
}

static void test_bad_times(void **state) {
    (void)state;
    static const char *const bad[] = {
        "",
        "2026-11-22",
        "2026-11-22 00:00:00Z",
        "2026-11-22T00:00:00",
        "2026-13-22T00:00:00Z",
        "2026-00-22T00:00:00Z",
        "2026-02-29T00:00:00Z",
        "1900-02-29T00:00:00Z",
        "2026-11-31T00:00:00Z",
        "2026-11-22T24:00:00Z",
        "2026-11-22T00:60:00Z",
        "2026-11-22T00:00:61Z",
        "2026-11-22T00:00:00.Z",
        "2026-11-22T00:00:00+1:00",
        "2026-11-22T00:00:00+24:00",
        "2026-11-22T00:00:00Zx",
        "26-11-22T00:00:00Z",
        "-026-11-22T00:00:00Z",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        int64_t ms = 0;
        if (sheard_time_parse(&ms, bad[i]))
            fail_msg("\"%s\" was taken as a time", bad[i]);
    }
}

/* ---- Job files ---- */

static void test_job_file(void **state) {
    (void)state;
    static const char text[] = "{\n  \"path\": \"/data/a.fits\",\n\t\"field\": \"A\",\r\n"
                               "  \"settings\": {\n    \"beta\": 1.6\n  }\n}\n\n";
    sheard_msg_submit submit;
    sheard_rpc_error error;
    assert_int_equal(sheard_job_file_parse(&submit, text, strlen(text), NULL, &error), 0);
    assert_string_equal(submit.source.path, "/data/a.fits");
    assert_string_equal(submit.field, "A");
    assert_string_equal(submit.settings, "beta=1.6\n");
    sheard_submit_deinit(&submit);
    static const struct {
        const char *text;
        int code;
    } bad[] = {
        {"", SHEARD_RPC_PARSE_ERROR},
        {"[]", SHEARD_RPC_BAD_PARAMETER},
        {"{}", SHEARD_RPC_MISSING_PARAMETER},
        {"{\"path\":\"/a\"} x", SHEARD_RPC_PARSE_ERROR},
        {"{\"path\":\"/a\",\"method\":\"submit\"}", SHEARD_RPC_UNKNOWN_PARAMETER},
        {"{\"path\":\"/a\",\"path\":\"/b\"}", SHEARD_RPC_DUPLICATE_KEY},
        {"{\"path\":\"a\"}", SHEARD_RPC_BAD_PARAMETER},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(
            sheard_job_file_parse(&submit, bad[i].text, strlen(bad[i].text), NULL, &error),
            bad[i].code);
        assert_int_equal(error.code, bad[i].code);
    }
}

static void test_job_file_size(void **state) {
    (void)state;
    char *text = malloc(SHEARD_MSG_JOB_FILE_MAX + 1);
    assert_non_null(text);
    memset(text, ' ', SHEARD_MSG_JOB_FILE_MAX + 1);
    memcpy(text, "{\"path\":\"/a\"}", 13);
    sheard_msg_submit submit;
    sheard_rpc_error error;
    assert_int_equal(sheard_job_file_parse(&submit, text, SHEARD_MSG_JOB_FILE_MAX, NULL, &error),
                     0);
    sheard_submit_deinit(&submit);
    assert_int_equal(
        sheard_job_file_parse(&submit, text, SHEARD_MSG_JOB_FILE_MAX + 1, NULL, &error),
        SHEARD_RPC_LINE_TOO_LONG);
    free(text);
}

/* The settings of a job are checked together with those of the service. */
static void test_settings_upon_defaults(void **state) {
    (void)state;
    static const char text[] = "{\"path\":\"/a\",\"settings\":{\"width\":2}}";
    shear_settings defaults;
    shear_settings_init(&defaults);
    sheard_msg_submit submit;
    sheard_rpc_error error;
    assert_int_equal(sheard_job_file_parse(&submit, text, strlen(text), &defaults, &error), 0);
    sheard_submit_deinit(&submit);
    defaults.filter = SHEAR_FILTER_NONE;
    assert_int_equal(sheard_job_file_parse(&submit, text, strlen(text), &defaults, &error),
                     SHEARD_RPC_BAD_SETTING);
    assert_string_equal(error.parameter, "settings");
    assert_null(submit.source.path);
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
        cmocka_unit_test(test_requests),
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_replies),
        cmocka_unit_test(test_notices),
        cmocka_unit_test(test_sources_and_sides),
        cmocka_unit_test(test_wire),
        cmocka_unit_test(test_lists_by_items),
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_bad_raw),
        cmocka_unit_test(test_settings_have_one_text),
        cmocka_unit_test(test_whole_settings),
        cmocka_unit_test(test_settings_of_0_1),
        cmocka_unit_test(test_bad_settings_text),
        cmocka_unit_test(test_every_setting),
        cmocka_unit_test(test_times),
        cmocka_unit_test(test_bad_times),
        cmocka_unit_test(test_job_file),
        cmocka_unit_test(test_job_file_size),
        cmocka_unit_test(test_settings_upon_defaults),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
