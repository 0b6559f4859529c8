/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl mock: its help text against the option table, and its exit codes. */
#include "commands/commands.h"
#include "shear_mocks/mock.h"
#include "test.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Values that the help text puts in words. */
static bool said_in_words(const char *name) {
    return strcmp(name, "field") == 0 || strcmp(name, "bulge-fraction") == 0;
}

/* The paragraph of option `name`: from its line to the next option's. */
static void paragraph(const char *name, char *out, size_t size) {
    char head[64];
    snprintf(head, sizeof head, "\n  --%s", name);
    const char *at = cmd_mock.usage;
    do {
        at = strstr(at + 1, head);
        if (at == NULL) {
            fail_msg("--%s is not in the help text", name);
            return;
        }
    } while (at[strlen(head)] != ' ');
    const char *end = strstr(at + 1, "\n  --");
    size_t length = end != NULL ? (size_t)(end - at) : strlen(at);
    snprintf(out, size, "%.*s", (int)length, at);
}

static void test_help_has_the_table(void **state) {
    (void)state;
    shear_mock_spec s;
    size_t n;
    const shear_mock_option *table = shear_mock_options(&n);
    shear_mock_spec_init(&s);
    for (size_t i = 0; i < n; i++) {
        char text[1024], value[96], expected[128];
        paragraph(table[i].name, text, sizeof text);
        shear_mock_format(&s, &table[i], value, sizeof value);
        snprintf(expected, sizeof expected, "(default %s)", value);
        if (!said_in_words(table[i].name) && strstr(text, expected) == NULL)
            fail_msg("--%s: no \"%s\"", table[i].name, expected);
        if (table[i].metavar != NULL) {
            snprintf(expected, sizeof expected, "--%s %s ", table[i].name, table[i].metavar);
            assert_non_null(strstr(text, expected));
        }
    }
    assert_true(s.bulge_fraction == 1.0 / 3.0);
}

static int run(const char *const *arguments) {
    char *argv[16] = {(char *)(uintptr_t) "mock"};
    int argc = 1;
    for (; arguments[argc - 1]; argc++)
        argv[argc] = (char *)(uintptr_t)arguments[argc - 1];
    optind = 0; /* glibc: begin again */
    return (int)cmd_mock.run(&cmd_mock, argc, argv);
}
#define RUN(...) run((const char *const[]){__VA_ARGS__, NULL})

static void test_wrong_usage(void **state) {
    (void)state;
    static const char *const nowhere = "/nonexistent/m.fits";
    assert_int_equal(RUN("--stamps", "4"), EXIT_CODE_USAGE);
    assert_int_equal(RUN("a.fits", "b.fits"), EXIT_CODE_USAGE);
    assert_int_equal(RUN("--stamps", "0", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(RUN("--stamps", "many", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(RUN("--stamp-count", "3", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(RUN(nowhere, "--seed"), EXIT_CODE_USAGE);
    assert_int_equal(RUN("--no-shift=maybe", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(RUN("--threads", "0", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(RUN("--rotate", "3", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(RUN("--stamps", "2", "--quiet", nowhere), EXIT_CODE_OTHER);
}

static void test_it_writes(void **state) {
    (void)state;
    char dir[] = "/tmp/mock-command-XXXXXX";
    char path[64];
    assert_non_null(mkdtemp(dir));
    snprintf(path, sizeof path, "%s/m.fits", dir);
    assert_int_equal(RUN("--stamps", "4", "--size", "32", "--shear", "-0.01,0.02", "--quiet", path),
                     EXIT_CODE_DONE);
    assert_int_equal(access(path, R_OK), 0);
    assert_int_equal(RUN("--stamps", "4", "--quiet", path), EXIT_CODE_OTHER);
    assert_int_equal(RUN("--stamps", "4", "--force", "--threads", "2", "--quiet", path),
                     EXIT_CODE_DONE);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(dir), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_help_has_the_table),
        cmocka_unit_test(test_wrong_usage),
        cmocka_unit_test(test_it_writes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
