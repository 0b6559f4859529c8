/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Codes and methods of the protocol, and errors as lines there and back. */
#include "rpc_fixture.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

/* ---- Codes ---- */

static bool is_stable_name(const char *name) {
    return name[0] >= 'a' && name[0] <= 'z' &&
           strspn(name, "abcdefghijklmnopqrstuvwxyz_") == strlen(name) &&
           strlen(name) < SHEARD_RPC_NAME_SIZE;
}

static void test_codes(void **state) {
    (void)state;
    for (int i = 0; i < SHEARD_N_RPC_CODES; i++) {
        const sheard_rpc_code_info *info = sheard_rpc_code_get(i);
        assert_non_null(info->name);
        assert_true(is_stable_name(info->name));
        assert_int_equal(sheard_rpc_code_find(info->name), i);
        assert_true((i == SHEARD_RPC_OK) == (info->advice[0] == '\0'));
        assert_true(strlen(info->advice) < sizeof((sheard_rpc_error *)0)->advice);
        for (int k = 0; k < i; k++)
            assert_int_not_equal(sheard_rpc_code_get(k)->number, info->number);
    }
    assert_ptr_equal(sheard_rpc_code_get(-1), sheard_rpc_code_get(SHEARD_RPC_UNKNOWN));
    assert_ptr_equal(sheard_rpc_code_get(SHEARD_N_RPC_CODES),
                     sheard_rpc_code_get(SHEARD_RPC_UNKNOWN));
    assert_int_equal(sheard_rpc_code_find("nonsense"), SHEARD_RPC_UNKNOWN);
    for (int core = SHEAR_OK; core <= SHEAR_E_FULL; core++) {
        assert_string_equal(sheard_rpc_code_get(sheard_rpc_code_from_core(core))->name,
                            shear_code_name(core));
    }
    assert_int_equal(sheard_rpc_code_from_core(999), SHEARD_RPC_INTERNAL);
}

static void test_methods(void **state) {
    (void)state;
    size_t n = 0;
    const char *const *names = sheard_method_names(&n);
    assert_int_equal(n, SHEARD_N_METHODS);
    for (int i = 0; i < SHEARD_N_METHODS; i++) {
        assert_string_equal(names[i], sheard_method_name(i));
        assert_int_equal(sheard_method_find(names[i]), i);
        assert_int_equal(sheard_method_needs_admin(i),
                         i == SHEARD_METHOD_RELOAD || i == SHEARD_METHOD_DRAIN ||
                             i == SHEARD_METHOD_FORGET || i == SHEARD_METHOD_SHUTDOWN);
    }
    assert_null(sheard_method_name(-1));
    assert_null(sheard_method_name(SHEARD_N_METHODS));
    assert_null(sheard_notice_name(-1));
    assert_null(sheard_notice_name(SHEARD_N_NOTICES));
    assert_int_equal(sheard_method_find("STATUS"), -1);
    assert_false(sheard_method_needs_admin(-1));
}

/* ---- Errors there and back ---- */

static void read_error_line(const char *line, size_t n, sheard_message *m) {
    sheard_rpc_error error = {0};
    if (sheard_message_parse(m, line, n, &error) != SHEARD_RPC_OK)
        fail_msg("%s: %s", line, error.message);
    assert_int_equal(m->kind, SHEARD_MESSAGE_ERROR);
}

static void test_errors(void **state) {
    (void)state;
    for (int code = 1; code < SHEARD_N_RPC_CODES; code++) {
        sheard_rpc_error error;
        assert_int_equal(sheard_rpc_fail(&error, code, NULL, "why \"%d\"\n", code), code);
        snprintf(error.parameter, sizeof error.parameter, "%s", code % 2 ? "a.b[1]" : "");
        const sheard_rpc_id id = {.type = SHEARD_ID_INTEGER, .integer = code};
        char *line = NULL;
        size_t n = 0;
        assert_int_equal(sheard_error_line(&line, &n, &id, &error), SHEARD_RPC_OK);
        assert_int_equal(line[n - 1], '\n');
        sheard_message m;
        read_error_line(line, n - 1, &m);
        assert_true(sheard_rpc_id_equal(&m.id, &id));
        assert_int_equal(m.error.code, error.code);
        assert_int_equal(m.error.number, error.number);
        assert_int_equal(m.error.retry, error.retry);
        assert_string_equal(m.error.name, error.name);
        assert_string_equal(m.error.parameter, error.parameter);
        assert_string_equal(m.error.message, error.message);
        assert_string_equal(m.error.advice, error.advice);
        free(line);
        sheard_message_deinit(&m);
    }
    shear_error core = {SHEAR_E_BETA, "too narrow", "take 1.7"};
    sheard_rpc_error error;
    assert_int_equal(sheard_rpc_fail_core(&error, &core), SHEARD_RPC_BETA_TOO_SMALL);
    assert_string_equal(error.message, "too narrow");
    assert_string_equal(error.advice, "take 1.7");
}

static void test_no_memory_line(void **state) {
    (void)state;
    sheard_message m;
    read_error_line(sheard_rpc_no_memory_line, strlen(sheard_rpc_no_memory_line) - 1, &m);
    sheard_rpc_error error;
    sheard_rpc_fail(&error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory");
    assert_int_equal(m.error.code, error.code);
    assert_int_equal(m.error.number, error.number);
    assert_int_equal(m.error.retry, error.retry);
    assert_string_equal(m.error.advice, error.advice);
    assert_int_equal(m.id.type, SHEARD_ID_NULL);
    sheard_message_deinit(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_codes),
        cmocka_unit_test(test_methods),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_no_memory_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
