/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl mock and expose: their help texts against the option tables, and their exit codes. */
#include "commands/commands.h"
#include "shear_mocks/exposure.h"
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
static void paragraph(const char *usage, const char *name, char *out, size_t size) {
    char head[64];
    snprintf(head, sizeof head, "\n  --%s", name);
    const char *at = usage;
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

/* The help has the option, its metavar, and `value` as its default. */
static void check_help(const char *usage, const shear_mock_option *o, const char *value) {
    char text[1024], expected[128];
    paragraph(usage, o->name, text, sizeof text);
    snprintf(expected, sizeof expected, "(default %s)", value);
    if (!said_in_words(o->name) && strstr(text, expected) == NULL)
        fail_msg("--%s: no \"%s\"", o->name, expected);
    if (o->metavar != NULL) {
        snprintf(expected, sizeof expected, "--%s %s ", o->name, o->metavar);
        assert_non_null(strstr(text, expected));
    }
}

static void test_help_has_the_table(void **state) {
    (void)state;
    shear_mock_spec s;
    size_t n;
    char value[96];
    const shear_mock_option *table = shear_mock_options(&n);
    shear_mock_spec_init(&s);
    for (size_t i = 0; i < n; i++) {
        check_help(cmd_mock.usage, &table[i],
                   shear_mock_format(&s, &table[i], value, sizeof value));
    }
    assert_true(s.bulge_fraction == 1.0 / 3.0);
}

static void test_help_has_the_table_of_exposures(void **state) {
    (void)state;
    shear_mock_exposure e;
    size_t n;
    char value[96];
    const shear_mock_option *table = shear_mock_exposure_options(&n);
    shear_mock_exposure_init(&e);
    for (size_t i = 0; i < n; i++) {
        check_help(cmd_expose.usage, &table[i],
                   shear_mock_exposure_format(&e, &table[i], value, sizeof value));
    }
}

static int run(const command *tool, const char *const *arguments) {
    char *argv[32] = {(char *)(uintptr_t)tool->name};
    int argc = 1;
    for (; arguments[argc - 1]; argc++)
        argv[argc] = (char *)(uintptr_t)arguments[argc - 1];
    optind = 0; /* glibc: begin again */
    return (int)tool->run(tool, argc, argv);
}
#define RUN(...)    run(&cmd_mock, (const char *const[]){__VA_ARGS__, NULL})
#define EXPOSE(...) run(&cmd_expose, (const char *const[]){__VA_ARGS__, NULL})

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

static void test_wrong_usage_of_expose(void **state) {
    (void)state;
    static const char *const nowhere = "/nonexistent/m.fits";
    assert_int_equal(EXPOSE("--chips", "2"), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--shear", "0.9,0.9", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--shear", "nan,0", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--pointing", "10,91", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--pointing", "-1,0", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--flux", "5,4", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--spacing", "4", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--moffat", "3", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--psf-shape", "0.5,0.5", "--psf-variation", "0.3", nowhere),
                     EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--galaxies", "1000", "--pixel-scale", "10", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--chips", "32", "--pixel-scale", "10", nowhere), EXIT_CODE_USAGE);
    assert_int_equal(EXPOSE("--chip-size", "64", "--quiet", nowhere), EXIT_CODE_OTHER);
}

static void test_expose_writes_four_files(void **state) {
    (void)state;
    static const char *const names[] = {"m.fits", "m.weight.fits", "m.mask.fits", "m.truth.fits"};
    char dir[] = "/tmp/mock-command-XXXXXX";
    char path[64];
    assert_non_null(mkdtemp(dir));
    snprintf(path, sizeof path, "%s/m.fits", dir);
    assert_int_equal(EXPOSE("--chip-size", "64", "--quiet", path), EXIT_CODE_DONE);
    assert_int_equal(EXPOSE("--chip-size", "64", "--quiet", path), EXIT_CODE_OTHER);
    assert_int_equal(EXPOSE("--chip-size", "64", "--force", "--quiet", path), EXIT_CODE_DONE);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", dir, names[i]);
        assert_int_equal(unlink(path), 0);
    }
    assert_int_equal(rmdir(dir), 0); /* nothing else */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_help_has_the_table),
        cmocka_unit_test(test_help_has_the_table_of_exposures),
        cmocka_unit_test(test_wrong_usage),
        cmocka_unit_test(test_wrong_usage_of_expose),
        cmocka_unit_test(test_it_writes),
        cmocka_unit_test(test_expose_writes_four_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
