/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Job files: the parameters of a submission in a file of JSON, and their errors. */
#include "rpc_fixture.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_job_file),
        cmocka_unit_test(test_job_file_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
