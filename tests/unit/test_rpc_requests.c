/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests of a client, wrong or too large: each has its code, and is answered under its id. */
#include "rpc_fixture.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

#define RPC        "{\"jsonrpc\":\"2.0\",\"id\":7,"
#define CALL(m, p) RPC "\"method\":\"" m "\",\"params\":" p "}"

/* ---- Wrong requests ---- */

typedef struct wrong {
    const char *line;
    int code;
    const char *id;        /* as in JSON */
    const char *parameter; /* NULL: none */
    const char *said;      /* part of the message; NULL: anything */
} wrong;

static const char *id_text(const sheard_rpc_id *id, char buf[160]) {
    if (id->type == SHEARD_ID_INTEGER) {
        snprintf(buf, 160, "%lld", (long long)id->integer);
    } else if (id->type == SHEARD_ID_TEXT) {
        snprintf(buf, 160, "\"%s\"", id->text);
    } else {
        snprintf(buf, 160, "null");
    }
    return buf;
}

static void assert_wrong(const wrong *w) {
    sheard_request request;
    sheard_rpc_error error = {0};
    char id[160];
    const int rc = sheard_request_parse(&request, w->line, strlen(w->line), NULL, &error);
    if (rc != w->code || error.code != rc) {
        fail_msg("%s: %s (%s), expected %s", w->line, error.name, error.message,
                 sheard_rpc_code_get(w->code)->name);
    }
    if (strcmp(id_text(&request.id, id), w->id) != 0)
        fail_msg("%s: id %s, expected %s", w->line, id, w->id);
    if (strcmp(error.parameter, w->parameter != NULL ? w->parameter : "") != 0)
        fail_msg("%s: parameter \"%s\"", w->line, error.parameter);
    if (strstr(error.message, w->said != NULL ? w->said : "") == NULL)
        fail_msg("%s: %s", w->line, error.message);
    assert_int_equal(request.method, -1);
    assert_int_not_equal(error.message[0], '\0');
    assert_int_not_equal(error.advice[0], '\0');
    assert_string_equal(error.name, sheard_rpc_code_get(rc)->name);
    sheard_request_deinit(&request);
}

static void assert_all_wrong(const wrong *list, size_t n) {
    for (size_t i = 0; i < n; i++)
        assert_wrong(&list[i]);
}
#define ASSERT_ALL_WRONG(list) assert_all_wrong(list, sizeof(list) / sizeof *(list))

static void test_wrong_text(void **state) {
    (void)state;
    static const wrong list[] = {
        {"", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {"   ", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {"{", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":\"status\"", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":\"status\"}}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":\"status\"} {}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":\"sta\x01tus\"}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":\"\xFF\"}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":\"\xC0\x80\"}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":\"\\ud800\"}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":'status'}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":NaN}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":1e999}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {RPC "\"method\":99999999999999999999}", SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {"\xEF\xBB\xBF" CALL("status", "{}"), SHEARD_RPC_PARSE_ERROR, "null", NULL, NULL},
        {"[]", SHEARD_RPC_BATCH_UNSUPPORTED, "null", NULL, NULL},
        {"[" CALL("status", "{}") "]", SHEARD_RPC_BATCH_UNSUPPORTED, "null", NULL, NULL},
        {"5", SHEARD_RPC_INVALID_REQUEST, "null", NULL, NULL},
        {"\"status\"", SHEARD_RPC_INVALID_REQUEST, "null", NULL, NULL},
        {"null", SHEARD_RPC_INVALID_REQUEST, "null", NULL, NULL},
    };
    ASSERT_ALL_WRONG(list);
}

static void test_wrong_envelope(void **state) {
    (void)state;
    static const wrong list[] = {
        {"{}", SHEARD_RPC_INVALID_REQUEST, "null", NULL, "id"},
        {"{\"jsonrpc\":\"2.0\",\"method\":\"status\"}", SHEARD_RPC_INVALID_REQUEST, "null", NULL,
         "\"id\" is missing"},
        {"{\"jsonrpc\":\"2.0\",\"id\":1.5,\"method\":\"status\"}", SHEARD_RPC_INVALID_REQUEST,
         "null", NULL, "id"},
        {"{\"jsonrpc\":\"2.0\",\"id\":true,\"method\":\"status\"}", SHEARD_RPC_INVALID_REQUEST,
         "null", NULL, "id"},
        {"{\"jsonrpc\":\"2.0\",\"id\":{},\"method\":\"status\"}", SHEARD_RPC_INVALID_REQUEST,
         "null", NULL, "id"},
        {"{\"jsonrpc\":\"2.0\",\"id\":\"a\\u0000b\",\"method\":\"status\"}",
         SHEARD_RPC_INVALID_REQUEST, "null", NULL, "id"},
        {"{\"jsonrpc\":\"1.0\",\"id\":\"x\",\"method\":\"status\"}", SHEARD_RPC_INVALID_REQUEST,
         "\"x\"", NULL, "jsonrpc"},
        {"{\"jsonrpc\":2.0,\"id\":-9,\"method\":\"status\"}", SHEARD_RPC_INVALID_REQUEST, "-9",
         NULL, "jsonrpc"},
        {"{\"id\":7,\"method\":\"status\"}", SHEARD_RPC_INVALID_REQUEST, "7", NULL, "jsonrpc"},
        {RPC "\"method\":\"status\",\"extra\":1}", SHEARD_RPC_INVALID_REQUEST, "7", NULL, "extra"},
        {RPC "\"params\":{}}", SHEARD_RPC_INVALID_REQUEST, "7", NULL, "method"},
        {RPC "\"method\":5}", SHEARD_RPC_INVALID_REQUEST, "7", NULL, "method"},
        {RPC "\"method\":\"Status\"}", SHEARD_RPC_UNKNOWN_METHOD, "7", NULL, "Status"},
        {RPC "\"method\":\"\"}", SHEARD_RPC_UNKNOWN_METHOD, "7", NULL, NULL},
        {RPC "\"method\":\"status\\u0000\"}", SHEARD_RPC_UNKNOWN_METHOD, "7", NULL, NULL},
        {CALL("status", "[]"), SHEARD_RPC_BAD_PARAMETER, "7", "params", "an array"},
        {CALL("status", "3"), SHEARD_RPC_BAD_PARAMETER, "7", "params", "a number"},
        {RPC "\"method\":\"status\",\"method\":\"drain\"}", SHEARD_RPC_DUPLICATE_KEY, "7", NULL,
         NULL},
        {CALL("job", "{\"id\":1,\"id\":2}"), SHEARD_RPC_DUPLICATE_KEY, "7", NULL, NULL},
        {RPC "\"id\":8,\"method\":\"status\"}", SHEARD_RPC_DUPLICATE_KEY, "null", NULL, NULL},
        {"{\"a\":1,\"a\":2,\"id\":7,\"id\":8}", SHEARD_RPC_DUPLICATE_KEY, "null", NULL, NULL},
        {"{\"a\":1,\"a\":2,\"id\":7,\"\\u0069d\":8}", SHEARD_RPC_DUPLICATE_KEY, "null", NULL, NULL},
        {"{\"a\":1,\"a\":2,\"id\" : \"}\\\",\" , \"b\":1}", SHEARD_RPC_DUPLICATE_KEY, "\"}\",\"",
         NULL, NULL},
    };
    ASSERT_ALL_WRONG(list);
}

static void test_wrong_parameters(void **state) {
    (void)state;
    static const wrong list[] = {
        {CALL("status", "{\"x\":1}"), SHEARD_RPC_UNKNOWN_PARAMETER, "7", "x", "no parameters"},
        {CALL("job", "{\"ids\":1}"), SHEARD_RPC_UNKNOWN_PARAMETER, "7", "ids", "there are: id"},
        {CALL("job", "{}"), SHEARD_RPC_MISSING_PARAMETER, "7", "id", "missing"},
        {RPC "\"method\":\"job\"}", SHEARD_RPC_MISSING_PARAMETER, "7", "id", "missing"},
        {RPC "\"method\":\"job\",\"params\":null}", SHEARD_RPC_MISSING_PARAMETER, "7", "id", NULL},
        {CALL("job", "{\"id\":null}"), SHEARD_RPC_BAD_PARAMETER, "7", "id", "null"},
        {CALL("job", "{\"id\":\"1\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "id",
         "a whole number, not a string"},
        {CALL("job", "{\"id\":1.0}"), SHEARD_RPC_BAD_PARAMETER, "7", "id", "a whole number"},
        {CALL("job", "{\"id\":0}"), SHEARD_RPC_BAD_PARAMETER, "7", "id", "from 1 to"},
        {CALL("job", "{\"id\":-1}"), SHEARD_RPC_BAD_PARAMETER, "7", "id", "not -1"},
        {CALL("wait", "{\"ids\":[]}"), SHEARD_RPC_BAD_PARAMETER, "7", "ids", "at least one"},
        {CALL("wait", "{\"ids\":5}"), SHEARD_RPC_BAD_PARAMETER, "7", "ids", "an array"},
        {CALL("wait", "{\"ids\":[1,\"2\"]}"), SHEARD_RPC_BAD_PARAMETER, "7", "ids[1]", "a string"},
        {CALL("wait", "{\"ids\":[1,null]}"), SHEARD_RPC_BAD_PARAMETER, "7", "ids[1]", "null"},
        {CALL("wait", "{\"ids\":[1],\"timeout_s\":-1}"), SHEARD_RPC_BAD_PARAMETER, "7", "timeout_s",
         "from 0 to 86400"},
        {CALL("wait", "{\"ids\":[1],\"timeout_s\":\"1\"}"), SHEARD_RPC_BAD_PARAMETER, "7",
         "timeout_s", "a number"},
        {CALL("jobs", "{\"states\":[\"failed\",\"lost\"]}"), SHEARD_RPC_BAD_PARAMETER, "7",
         "states[1]", "queued, running, waiting, done, failed, cancelled, retracted, not \"lost\""},
        {CALL("jobs", "{\"states\":\"failed\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "states",
         "an array"},
        {CALL("jobs", "{\"limit\":0}"), SHEARD_RPC_BAD_PARAMETER, "7", "limit", "from 1 to 200"},
        {CALL("jobs", "{\"limit\":201}"), SHEARD_RPC_BAD_PARAMETER, "7", "limit", NULL},
        {CALL("jobs", "{\"owner\":4294967296}"), SHEARD_RPC_BAD_PARAMETER, "7", "owner", NULL},
        {CALL("jobs", "{\"field\":\"\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "field", "empty"},
        {CALL("field", "{\"field\":\"a\\nb\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "field", "control"},
        {CALL("field", "{\"field\":\"a\\u0000b\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "field", "NUL"},
        {CALL("subscribe", "{}"), SHEARD_RPC_MISSING_PARAMETER, "7", "jobs", "subscribe"},
        {CALL("subscribe", "{\"all\":1}"), SHEARD_RPC_BAD_PARAMETER, "7", "all", "true or false"},
        {CALL("subscribe", "{\"fields\":[\"a\",\"\"]}"), SHEARD_RPC_BAD_PARAMETER, "7", "fields[1]",
         "empty"},
        {CALL("unsubscribe", "{\"progress\":true}"), SHEARD_RPC_UNKNOWN_PARAMETER, "7", "progress",
         NULL},
        {CALL("hello", "{\"oldest\":2,\"newest\":1}"), SHEARD_RPC_BAD_PARAMETER, "7", "oldest",
         NULL},
        {CALL("shutdown", "{\"mode\":\"later\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "mode",
         "drain, now, not \"later\""},
        {CALL("shutdown", "{\"mode\":1}"), SHEARD_RPC_BAD_PARAMETER, "7", "mode", "a number"},
    };
    ASSERT_ALL_WRONG(list);
}

static void test_wrong_submit(void **state) {
    (void)state;
    static const wrong list[] = {
        {CALL("submit", "{}"), SHEARD_RPC_MISSING_PARAMETER, "7", "path", NULL},
        {CALL("submit", "{\"path\":\"a.fits\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "path", "a.fits"},
        {CALL("submit", "{\"path\":\"\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "path", NULL},
        {CALL("submit", "{\"path\":\"/a\\u0000\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "path", "NUL"},
        {CALL("submit", "{\"path\":\"/a\",\"psf\":{\"path\":\"/b\"}}"), SHEARD_RPC_BAD_PARAMETER,
         "7", "path", "contradicts"},
        {CALL("submit", "{\"galaxy\":{\"path\":\"/a\"},\"noise\":{\"path\":\"/a\"}}"),
         SHEARD_RPC_MISSING_PARAMETER, "7", "psf", NULL},
        {CALL("submit", "{\"psf\":{\"path\":\"/a\"}}"), SHEARD_RPC_MISSING_PARAMETER, "7", "galaxy",
         NULL},
        {CALL("submit", "{\"galaxy\":\"/a\"}"), SHEARD_RPC_BAD_PARAMETER, "7", "galaxy",
         "an object, not a string"},
        {CALL("submit", "{\"galaxy\":{}}"), SHEARD_RPC_MISSING_PARAMETER, "7", "galaxy.path", NULL},
        {CALL("submit", "{\"galaxy\":{\"path\":\"/a\",\"hdu\":-1}}"), SHEARD_RPC_BAD_PARAMETER, "7",
         "galaxy.hdu", "from 0 to 9999"},
        {CALL("submit", "{\"galaxy\":{\"path\":\"/a\"},\"noise\":{\"path\":\"/a\"},"
                        "\"psf\":{\"path\":\"/a\",\"hdu\":1,\"extname\":\"P\"}}"),
         SHEARD_RPC_BAD_PARAMETER, "7", "psf.hdu", "extname"},
        {CALL("submit", "{\"path\":\"/a\",\"catalog\":{\"path\":\"/a\"}}"),
         SHEARD_RPC_BAD_PARAMETER, "7", "path", "contradicts"},
        {CALL("submit", "{\"catalog\":{\"path\":\"/a\"}}"), SHEARD_RPC_MISSING_PARAMETER, "7",
         "galaxy", NULL},
        {CALL("submit", "{\"galaxy\":{\"path\":\"/a\",\"ext\":1}}"), SHEARD_RPC_UNKNOWN_PARAMETER,
         "7", "galaxy.ext", NULL},
        {CALL("submit", "{\"path\":\"/a\",\"priority\":101}"), SHEARD_RPC_BAD_PARAMETER, "7",
         "priority", "from -100 to 100"},
        {CALL("submit", "{\"path\":\"/a\",\"priority\":-101}"), SHEARD_RPC_BAD_PARAMETER, "7",
         "priority", NULL},
        {CALL("submit", "{\"path\":\"/a\",\"force\":\"yes\"}"), SHEARD_RPC_BAD_PARAMETER, "7",
         "force", NULL},
        {CALL("submit", "{\"path\":\"/a\",\"settings\":[]}"), SHEARD_RPC_BAD_PARAMETER, "7",
         "settings", NULL},
        {CALL("submit", "{\"path\":\"/a\",\"settings\":{\"betta\":1}}"), SHEARD_RPC_BAD_SETTING,
         "7", "settings.betta", "no such setting"},
        {CALL("submit", "{\"path\":\"/a\",\"settings\":{\"beta\":\"1\"}}"), SHEARD_RPC_BAD_SETTING,
         "7", "settings.beta", "a number or \"auto\", not a string"},
        {CALL("submit", "{\"path\":\"/a\",\"settings\":{\"beta-ratio\":1,\"beta_ratio\":1}}"),
         SHEARD_RPC_BAD_SETTING, "7", "settings.beta_ratio", "twice"},
        {CALL("submit", "{\"path\":\"/a\",\"settings\":{\"filter\":\"none\",\"width\":1}}"),
         SHEARD_RPC_BAD_SETTING, "7", "settings", "width"},
    };
    ASSERT_ALL_WRONG(list);
}

/* ---- Limits, at them and one beyond ---- */

static int parse_code(const char *line, size_t n, sheard_rpc_id *id) {
    sheard_request request;
    sheard_rpc_error error;
    const int rc = sheard_request_parse(&request, line, n, NULL, &error);
    *id = request.id;
    sheard_request_deinit(&request);
    return rc;
}

static void test_line_limit(void **state) {
    (void)state;
    const size_t limit = sheard_rpc_request_limits.line;
    char *line = malloc(limit + 1);
    assert_non_null(line);
    memset(line, ' ', limit + 1);
    memcpy(line, CALL("status", "{}"), sizeof CALL("status", "{}") - 1);
    sheard_rpc_id id;
    assert_int_equal(parse_code(line, limit, &id), SHEARD_RPC_OK);
    assert_int_equal(parse_code(line, limit + 1, &id), SHEARD_RPC_LINE_TOO_LONG);
    assert_int_equal(id.type, SHEARD_ID_NULL);
    line[limit - 1] = '\0';
    assert_int_equal(parse_code(line, limit, &id), SHEARD_RPC_NUL_BYTE);
    free(line);
}

static void test_depth_limit(void **state) {
    (void)state;
    for (int depth = 1; depth <= 200; depth++) {
        char line[600] = "{\"jsonrpc\":\"2.0\",\"id\":\"deep\",\"method\":\"status\",\"params\":";
        for (int i = 1; i < depth; i++)
            strcat(line, "[");
        strcat(line, depth == 1 ? "null" : "");
        for (int i = 1; i < depth; i++)
            strcat(line, "]");
        strcat(line, "}");
        sheard_rpc_id id;
        const int rc = parse_code(line, strlen(line), &id);
        assert_int_equal(rc, depth == 1                                 ? SHEARD_RPC_OK
                             : depth <= sheard_rpc_request_limits.depth ? SHEARD_RPC_BAD_PARAMETER
                                                                        : SHEARD_RPC_TOO_COMPLEX);
        assert_int_equal(id.type, SHEARD_ID_TEXT);
        assert_string_equal(id.text, "deep");
    }
}

/* wait with `n` ids: 7 + n separators and openings around them. */
static int wait_code(size_t n, sheard_rpc_id *id) {
    char *line = malloc(100 + 2 * n);
    assert_non_null(line);
    strcpy(line, RPC "\"method\":\"wait\",\"params\":{\"ids\":[1");
    char *end = line + strlen(line);
    for (size_t i = 1; i < n; i++) {
        memcpy(end, ",1", 2);
        end += 2;
    }
    strcpy(end, "]}}");
    const int rc = parse_code(line, strlen(line), id);
    free(line);
    return rc;
}

static void test_list_and_value_limits(void **state) {
    (void)state;
    sheard_rpc_id id;
    assert_int_equal(wait_code(SHEARD_MSG_LIST_MAX, &id), SHEARD_RPC_OK);
    assert_int_equal(wait_code(SHEARD_MSG_LIST_MAX + 1, &id), SHEARD_RPC_BAD_PARAMETER);
    /* { : , : , : , : { : [ and the commas between the ids */
    const size_t around = 1 + 7 + 2 + 1;
    const size_t most = sheard_rpc_request_limits.values - around + 1;
    assert_int_equal(wait_code(most, &id), SHEARD_RPC_BAD_PARAMETER);
    assert_int_equal(wait_code(most + 1, &id), SHEARD_RPC_TOO_COMPLEX);
    assert_int_equal(id.integer, 7);
}

/* submit with a text of n bytes for a parameter. */
static int text_code(const char *parameter, const char *begin, size_t n) {
    char *line = malloc(200 + n);
    assert_non_null(line);
    int used = sprintf(line, RPC "\"method\":\"submit\",\"params\":{%s\"%s\":\"%s",
                       strcmp(parameter, "path") == 0 ? "" : "\"path\":\"/a\",", parameter, begin);
    memset(line + used, 'x', n - strlen(begin));
    strcpy(line + used + n - strlen(begin), "\"}}");
    sheard_rpc_id id;
    const int rc = parse_code(line, strlen(line), &id);
    assert_int_equal(id.integer, 7);
    free(line);
    return rc;
}

static void test_text_limits(void **state) {
    (void)state;
    static const struct {
        const char *parameter, *begin;
        size_t max;
    } texts[] = {{"path", "/", SHEARD_MSG_PATH_MAX},
                 {"field", "", SHEARD_MSG_FIELD_MAX},
                 {"key", "", SHEARD_MSG_KEY_MAX}};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        assert_int_equal(text_code(texts[i].parameter, texts[i].begin, texts[i].max),
                         SHEARD_RPC_OK);
        assert_int_equal(text_code(texts[i].parameter, texts[i].begin, texts[i].max + 1),
                         SHEARD_RPC_BAD_PARAMETER);
        assert_int_equal(
            text_code(texts[i].parameter, texts[i].begin, sheard_rpc_request_limits.text),
            SHEARD_RPC_BAD_PARAMETER);
        assert_int_equal(
            text_code(texts[i].parameter, texts[i].begin, sheard_rpc_request_limits.text + 1),
            SHEARD_RPC_TOO_COMPLEX);
    }
}

/* ---- Ids ---- */

static void test_ids(void **state) {
    (void)state;
    static const char *const ids[] = {
        "0",    "-1",   "9223372036854775807",    "-9223372036854775808",
        "null", "\"\"", "\"a\\\"\\\\\\n\\u20AC\""};
    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++) {
        char line[200];
        snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"id\":%s,\"method\":\"status\"}",
                 ids[i]);
        sheard_request request;
        sheard_rpc_error error;
        assert_int_equal(sheard_request_parse(&request, line, strlen(line), NULL, &error), 0);
        char *reply = NULL;
        size_t n = 0;
        sheard_rpc_fail(&error, SHEARD_RPC_QUEUE_FULL, NULL, "full");
        assert_int_equal(sheard_error_line(&reply, &n, &request.id, &error), 0);
        snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"id\":%s,\"error\":", ids[i]);
        assert_memory_equal(reply, line, strlen(line));
        free(reply);
        sheard_request_deinit(&request);
    }
    char line[400];
    for (int n = SHEARD_RPC_ID_MAX; n <= SHEARD_RPC_ID_MAX + 1; n++) {
        snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"id\":\"%0*d\",\"method\":\"status\"}",
                 n, 1);
        sheard_rpc_id id;
        assert_int_equal(parse_code(line, strlen(line), &id),
                         n > SHEARD_RPC_ID_MAX ? SHEARD_RPC_INVALID_REQUEST : SHEARD_RPC_OK);
        assert_int_equal(id.type, n > SHEARD_RPC_ID_MAX ? SHEARD_ID_NULL : SHEARD_ID_TEXT);
    }
}

static void test_id_equality(void **state) {
    (void)state;
    const sheard_rpc_id ids[] = {{.type = SHEARD_ID_NULL},
                                 {.type = SHEARD_ID_INTEGER, .integer = 1},
                                 {.type = SHEARD_ID_INTEGER, .integer = 2},
                                 {.type = SHEARD_ID_TEXT, .text = "1"},
                                 {.type = SHEARD_ID_TEXT, .text = "2"}};
    for (int i = 0; i < 5; i++) {
        for (int k = 0; k < 5; k++)
            assert_int_equal(sheard_rpc_id_equal(&ids[i], &ids[k]), i == k);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_wrong_text),
        cmocka_unit_test(test_wrong_envelope),
        cmocka_unit_test(test_wrong_parameters),
        cmocka_unit_test(test_wrong_submit),
        cmocka_unit_test(test_line_limit),
        cmocka_unit_test(test_depth_limit),
        cmocka_unit_test(test_list_and_value_limits),
        cmocka_unit_test(test_text_limits),
        cmocka_unit_test(test_ids),
        cmocka_unit_test(test_id_equality),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
