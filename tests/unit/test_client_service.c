/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pure parts of shearctl's service subcommands: times and sizes, bars, text on a terminal, sums
 * over jobs, exit codes, paths, values of a configuration, completion data; and results read back.
 */
#include "test.h"

#include "cmdline/command.h"
#include "cmdline/completion.h"
#include "cmdline/input_path.h"
#include "doctor/conf_text.h"
#include "remote/follow_sum.h"
#include "sheard/check_result.h"
#include "sheard/report_summary.h"
#include "terminal/bar.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/style.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char buf[512];

/* ---- human.h ---- */

static void durations(void **state) {
    (void)state;
    const struct {
        double seconds;
        const char *text;
    } cases[] = {{0.0, "0.00 s"},
                 {0.25, "0.25 s"},
                 {0.9951, "1.0 s"},
                 {9.94, "9.9 s"},
                 {9.96, "10 s"},
                 {59.4, "59 s"},
                 {59.6, "1 min 00 s"},
                 {185.0, "3 min 05 s"},
                 {3599.6, "1 h 00 min"},
                 {7384.0, "2 h 03 min"},
                 {86400.0, "1 d 00 h"},
                 {442800.0, "5 d 03 h"},
                 {-1.0, "-"},
                 {(double)NAN, "-"},
                 {(double)INFINITY, "-"},
                 {1e300, "11574074074 d 01 h"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(human_duration(cases[i].seconds, buf), cases[i].text);
}

static void durations_are_parsed(void **state) {
    (void)state;
    const struct {
        const char *text;
        double seconds;
    } good[] = {{"0", 0.0},   {"90", 90.0},    {"90s", 90.0},  {"250ms", 0.25},
                {"1.5", 1.5}, {"5min", 300.0}, {"2h", 7200.0}, {"1d", 86400.0}};
    const char *bad[] = {"",   "s",   "-1",  "+1",    " 1",  "1 s",
                         "1y", "inf", "nan", "1e999", "1s2", ".5"};
    double seconds = 0.0;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_true(human_parse_duration(good[i].text, &seconds));
        assert_float_equal(seconds, good[i].seconds, 0.0);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(human_parse_duration(bad[i], &seconds));
}

static void times_ages_sizes_and_rates(void **state) {
    (void)state;
    setenv("TZ", "UTC-2", 1);
    assert_string_equal(human_time(1769860800123, true, buf), "2026-01-31 12:00:00Z");
    assert_string_equal(human_time(1769860800123, false, buf), "2026-01-31 14:00:00");
    assert_string_equal(human_time(0, true, buf), "-");
    assert_string_equal(human_age(0, 5000, buf), "-");
    assert_string_equal(human_age(5000, 5999, buf), "just now");
    assert_string_equal(human_age(6000, 5000, buf), "just now"); /* their clock is ahead */
    assert_string_equal(human_age(5000, 6000, buf), "1 s");
    assert_string_equal(human_age(1000, 186400, buf), "3 min 05 s");
    assert_string_equal(human_bytes(0, buf), "0 B");
    assert_string_equal(human_bytes(1023, buf), "1023 B");
    assert_string_equal(human_bytes(1024, buf), "1.0 KiB");
    assert_string_equal(human_bytes((1 << 20) - 1, buf), "1.0 MiB");
    assert_string_equal(human_bytes(INT64_MAX, buf), "8.0 EiB");
    assert_string_equal(human_rate(0.25, buf), "0.25/s");
    assert_string_equal(human_rate(12345.4, buf), "12345/s");
    assert_string_equal(human_rate((double)NAN, buf), "-");
}

/* ---- bar.h ---- */

static void bars(void **state) {
    (void)state;
    assert_string_equal(bar_text(0.0, 6, buf, sizeof buf), "[....]");
    assert_string_equal(bar_text(0.5, 6, buf, sizeof buf), "[##..]");
    assert_string_equal(bar_text(0.99, 6, buf, sizeof buf), "[###.]");
    assert_string_equal(bar_text(1.0, 6, buf, sizeof buf), "[####]");
    assert_string_equal(bar_text(7.0, 6, buf, sizeof buf), "[####]");
    assert_string_equal(bar_text(-1.0, 6, buf, sizeof buf), "[....]");
    assert_string_equal(bar_text((double)NAN, 6, buf, sizeof buf), "[....]");
    assert_string_equal(bar_text(0.5, 2, buf, sizeof buf), "");
    assert_string_equal(bar_text(0.5, 6, buf, 6), ""); /* no room for the end */
    assert_float_equal(bar_part(1.0, 4.0), 0.25, 0.0);
    assert_float_equal(bar_part(5.0, 4.0), 1.0, 0.0);
    assert_float_equal(bar_part(0.0, 0.0), 1.0, 0.0);
    assert_float_equal(bar_part(3.0, -1.0), 0.0, 0.0);
}

static void figures(void **state) {
    (void)state;
    assert_string_equal(bar_figures(0.42, 100.0, 67.0, buf, sizeof buf),
                        "  42% 100 stamps/s 1:07 left");
    assert_string_equal(bar_figures(1.0, 100.0, 3667.0, buf, sizeof buf),
                        " 100% 100 stamps/s 1:01:07 left");
    assert_string_equal(bar_figures(0.0, 0.0, 1.0, buf, sizeof buf), "   0%");
    assert_string_equal(bar_figures(0.0, (double)NAN, 1.0, buf, sizeof buf), "   0%");
    assert_string_equal(bar_figures(0.0, 1.0, (double)NAN, buf, sizeof buf),
                        "   0% 1 stamps/s 99:59:59 left");
}

/* ---- style.h ---- */

static void widths(void **state) {
    (void)state;
    assert_int_equal(style_width("abc"), 3);
    assert_int_equal(style_width("\x1b[31mabc\x1b[0m"), 3);
    assert_int_equal(style_width("\xC3\xA4"), 1);     /* one letter of two bytes */
    assert_int_equal(style_width("\xE6\x98\x9F"), 2); /* one letter of two columns */
    assert_int_equal(style_width("\xFF"), 1);
    assert_int_equal(style_fit("abcdef", 4), 4);
    assert_int_equal(style_fit("\x1b[31mabc\x1b[0m", 2), 7);
    assert_int_equal(style_fit("a\xE6\x98\x9F", 2), 1); /* no half of it */
    assert_int_equal(style_fit("ab", 9), 2);
}

static void cleaning(void **state) {
    (void)state;
    assert_string_equal(message_clean("a\x1b[2J\n\x7F", buf, sizeof buf), "a?[2J??");
    assert_string_equal(message_clean("\xC2\x9B"
                                      "31m",
                                      buf, sizeof buf),
                        "?31m"); /* CSI of 8 bits */
    assert_string_equal(message_clean("\xC3\xA4\xFF", buf, sizeof buf), "\xC3\xA4?");
    assert_string_equal(message_clean("a\xC3\xA4", buf, 3), "a"); /* no half letters */
}

/* ---- follow ---- */

static follow_entry entry(int64_t id, int state, int64_t done, int64_t total, double rate) {
    return (follow_entry){id, state, {.done = done, .total = total, .rate = rate}};
}

static void sums_of_jobs(void **state) {
    (void)state;
    follow_entry e[] = {entry(1, SHEARD_JOB_DONE, 90, 100, (double)NAN),
                        entry(2, SHEARD_JOB_RUNNING, 100, 300, 50.0),
                        entry(3, SHEARD_JOB_RUNNING, 0, -1, (double)NAN),
                        entry(4, SHEARD_JOB_QUEUED, 0, -1, 70.0)};
    follow_totals sum = follow_sum(e, 4);
    assert_int_equal(sum.finished, 1);
    assert_int_equal(sum.done, 200);  /* a finished job is done as a whole */
    assert_int_equal(sum.total, 800); /* 200 on average */
    assert_float_equal(sum.rate, 50.0, 0.0);
    sum = follow_sum(e + 2, 2);
    assert_int_equal(sum.total, -1);
    assert_int_equal(follow_sum(e, 0).total, -1);
}

static void news_of_jobs(void **state) {
    (void)state;
    follow_entry e[] = {entry(1, SHEARD_JOB_QUEUED, 0, -1, (double)NAN),
                        entry(2, SHEARD_JOB_QUEUED, 0, -1, (double)NAN)};
    const sheard_msg_progress half = {.done = 5, .total = 10, .rate = 1.0};
    follow_note(e, 2, 2, SHEARD_JOB_RUNNING, &half);
    follow_note(e, 2, 77, SHEARD_JOB_RUNNING, &half); /* not ours */
    assert_int_equal(e[1].state, SHEARD_JOB_RUNNING);
    assert_int_equal(e[1].progress.done, 5);
    const sheard_msg_progress whole = {.done = 10, .total = 10, .rate = 1.0};
    follow_note(e, 2, 2, SHEARD_JOB_DONE, &whole);
    follow_note(e, 2, 2, SHEARD_JOB_RUNNING, &half); /* late news */
    assert_int_equal(e[1].state, SHEARD_JOB_DONE);
    assert_int_equal(e[1].progress.done, 10);
    assert_int_equal(e[0].state, SHEARD_JOB_QUEUED);
}

static void exit_codes(void **state) {
    (void)state;
    const struct {
        follow_counts counts; /* done, failed, cancelled, unfinished */
        int code;
    } cases[] = {{{3, 0, 0, 0}, EXIT_CODE_DONE},      {{0, 2, 0, 0}, EXIT_CODE_JOB_FAILED},
                 {{1, 1, 0, 0}, EXIT_CODE_PARTLY},    {{1, 0, 1, 0}, EXIT_CODE_PARTLY},
                 {{0, 0, 1, 0}, EXIT_CODE_CANCELLED}, {{0, 1, 1, 0}, EXIT_CODE_JOB_FAILED},
                 {{5, 5, 5, 1}, EXIT_CODE_TIMED_OUT}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(follow_exit_code(&cases[i].counts), cases[i].code);
    assert_int_equal(EXIT_CODE_JOB_FAILED, 5); /* scripts have these numbers */
    assert_int_equal(EXIT_CODE_TIMED_OUT, 6);
    assert_int_equal(EXIT_CODE_UNREACHABLE, 7);
    assert_int_equal(EXIT_CODE_CANCELLED, 8);
}

/* ---- input_path.h ---- */

static char directory[] = "client-XXXXXX";

static int make_directory(void **state) {
    (void)state;
    return mkdtemp(directory) != NULL && chdir(directory) == 0 ? 0 : -1;
}

static int remove_directory(void **state) {
    (void)state;
    return chdir("..") == 0 && rmdir(directory) == 0 ? 0 : -1;
}

static void absolute_paths(void **state) {
    (void)state;
    shear_error err = {0};
    char *here = realpath(".", NULL);
    char *path = NULL;
    assert_int_equal(input_path_absolute("a.fits", &path, &err), SHEAR_OK);
    assert_memory_equal(path, here, strlen(here));
    assert_string_equal(path + strlen(here), "/a.fits");
    free(path);
    assert_int_equal(input_path_absolute("/x/../a", &path, &err), SHEAR_OK);
    assert_string_equal(path, "/x/../a");
    free(path);
    assert_int_equal(symlink("/nowhere", "link"), 0);
    assert_int_equal(input_path_absolute("./link", &path, &err), SHEAR_OK);
    assert_string_equal(path + strlen(here), "/link"); /* not resolved */
    free(path);
    assert_int_equal(unlink("link"), 0);
    const char *bad[] = {"", "..", "none/a.fits", "a/"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(input_path_absolute(bad[i], &path, &err), SHEAR_E_IO);
        assert_null(path);
    }
    free(here);
}

static void hdus(void **state) {
    (void)state;
    const struct {
        const char *name;
        int64_t hdu;
        const char *extname;
        size_t length;
    } cases[] = {{"a.fits", -1, NULL, 6}, {"a.fits:0", 0, NULL, 6},    {"a:1.fits:12", 12, NULL, 8},
                 {"a:", -1, NULL, 2},     {"a:SCI 2", -1, "SCI 2", 1}, {":1", -1, NULL, 2},
                 {"a:1/b", -1, NULL, 5},  {"a:-1", -1, "-1", 1},       {"a:9999", 9999, NULL, 1},
                 {"a:1b", -1, "1b", 1}};
    shear_error err = {0};
    shear_input_part part;
    size_t length = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(input_path_hdu(cases[i].name, &part, &length, &err), SHEAR_OK);
        assert_int_equal(part.hdu, cases[i].hdu);
        assert_int_equal(part.extname != NULL, cases[i].extname != NULL);
        if (part.extname != NULL)
            assert_string_equal(part.extname, cases[i].extname);
        assert_int_equal(length, cases[i].length);
    }
    const char *const bad[] = {
        "a:10000", "a:99999999999999999999",
        "a:a name of more than sixty-eight characters, which no header card can have as a value"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(input_path_hdu(bad[i], &part, &length, &err), SHEAR_E_SETTING);
    FILE *file = fopen("odd:1", "w"); /* a file of this very name */
    assert_non_null(file);
    fclose(file);
    assert_int_equal(input_path_hdu("odd:1", &part, &length, &err), SHEAR_OK);
    assert_int_equal(part.hdu, -1);
    assert_int_equal(input_path_hdu("odd:1:2", &part, &length, &err), SHEAR_OK);
    assert_int_equal(part.hdu, 2);
    assert_int_equal(unlink("odd:1"), 0);
}

/* ---- conf_text.h ---- */

static void value_is(const char *section, const char *key, const char *expected) {
    static const char text[] =
        "[daemon]\n# command line\nsocket = /run/s.sock\nsocket_mode = 0660\n"
        "socket_group =\n\n[access]\n# f:7\ndata_roots = /a,\n    /b c,\n"
        "    /d\nadmin_users = root\n[x]\nsocket = no\nlast = end";
    char *value = conf_text_value(text, section, key);
    if (expected != NULL) {
        assert_non_null(value);
        assert_string_equal(value, expected);
    } else {
        assert_null(value);
    }
    free(value);
}

static void values_of_a_configuration(void **state) {
    (void)state;
    value_is("daemon", "socket", "/run/s.sock");
    value_is("daemon", "socket_mode", "0660");
    value_is("daemon", "socket_group", "");
    value_is("access", "data_roots", "/a, /b c, /d");
    value_is("x", "last", "end");
    value_is("daemon", "data_roots", NULL);
    value_is("daemon", "sock", NULL);
    value_is("dae", "socket", NULL);
}

/* ---- completion.h ---- */

static void completion_is(const char *usage, const char *expected) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    completion_options("c", usage, out);
    assert_int_equal(fclose(out), 0);
    assert_memory_equal(text, expected, strlen(expected));
    assert_string_equal(text + strlen(expected), "option|c|--help|||explain this subcommand\n");
    free(text);
}

static void completion_data(void **state) {
    (void)state;
    completion_is("usage: x\n\nText with --nothing in it.\n", "");
    completion_is("  --json                  an object\n                          a line\n",
                  "option|c|--json||| an object\n");
    completion_is("  -o, --output PNG   where | it goes\n",
                  "option|c|--output|PNG|| where , it goes\n");
    completion_is("  --a, --no-a\n                  both\n",
                  "option|c|--a||| both\noption|c|--no-a||| both\n");
    completion_is("  --psf a|b               W\n", "option|c|--psf|a,b|a b| W\n");
    completion_is("  --zeros POLICY\n          zero pixels\n",
                  "option|c|--zeros|POLICY|skip floor| zero pixels\n");
    completion_is("  --file FILE[HDU]", "option|c|--file|FILE[HDU]||\n");
}

/* The tool's table: here of one subcommand. */
static const command cmd_try = {
    .name = "try",
    .summary = "attempt it",
    .usage = "usage: shearctl try [OPTION...] FILE|DIR...\n\n  --quiet   silent\n",
    .run = NULL,
};
static const command *const table[] = {&cmd_try, NULL};
static void completion_data_of_the_table(void **state) {
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    command_set_table(table);
    assert_int_equal(completion_data_print(out), EXIT_CODE_DONE);
    assert_int_equal(fclose(out), 0);
    assert_string_equal(text, "command|try|FILE,DIR...|attempt it\n"
                              "option|try|--quiet||| silent\n"
                              "option|try|--help|||explain this subcommand\n");
    free(text);
}

/* ---- protocol: results read back, findings ---- */

static void summaries(void **state) {
    (void)state;
    static const char text[] =
        "{\"g1\":0.25,\"g1_err\":0.5,\"g2\":null,\"n_stamps\":7,\"n_used\":5,\"n_flagged\":2,"
        "\"flags\":{\"galaxy_not_finite\":2},\"truth\":{\"g1\":1,\"g2\":2.5},\"jackknife\":9,"
        "\"files\":[{},{}],\"warnings\":[\"a\",7,\"b\"],\"new\":{\"x\":[]},"
        "\"resolved\":{\"interpolation\":\"none\",\"filter\":\"edge\",\"beta_px\":2.5}}";
    sheard_report_summary s;
    shear_error err = {0};
    assert_int_equal(sheard_report_summary_parse(&s, text, &err), SHEAR_OK);
    assert_float_equal(s.g1, 0.25, 0.0);
    assert_true(isnan(s.g2) && isnan(s.cov12) && isnan(s.pull_g1) && isnan(s.core_px));
    assert_int_equal(s.n_used, 5);
    assert_int_equal(s.flagged[0], 2);
    assert_float_equal(s.true_g2, 2.5, 0.0);
    assert_int_equal(s.jackknife, 9);
    assert_int_equal(s.n_files, 2);
    assert_int_equal(s.n_warnings, 2);
    assert_string_equal(s.warnings[1], "b");
    assert_string_equal(s.filter, "edge");
    sheard_report_summary_deinit(&s);
    sheard_report_summary_deinit(&s); /* again: fine */
    const char *bad[] = {"", "[]", "{", "null", "{\"a\":1}x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(sheard_report_summary_parse(&s, bad[i], &err), SHEAR_E_FORMAT);
    assert_int_equal(sheard_report_summary_parse(&s, "{}", &err), SHEAR_OK);
    assert_true(isnan(s.g1));
    sheard_report_summary_deinit(&s);
}

static void findings(void **state) {
    (void)state;
    const sheard_check_result f = {"a\"b", SHEARD_CHECK_WARN, "x\n\xFF", ""};
    char *text = NULL;
    shear_error err = {0};
    assert_int_equal(sheard_check_result_json(&text, &f, &err), SHEAR_OK);
    assert_null(strchr(text, '\n'));
    assert_non_null(strstr(text, "a\\\"b"));
    assert_non_null(strstr(text, "\"warn\""));
    free(text);
    assert_string_equal(sheard_check_level_name(SHEARD_CHECK_OK), "ok");
    assert_string_equal(sheard_check_level_name(SHEARD_CHECK_FAIL), "fail");
}

int main(void) {
    /* Widths and cleaning need a character set with more than ASCII; Debian always has this one. */
    setlocale(LC_CTYPE, "C.UTF-8");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(durations),
        cmocka_unit_test(durations_are_parsed),
        cmocka_unit_test(times_ages_sizes_and_rates),
        cmocka_unit_test(bars),
        cmocka_unit_test(figures),
        cmocka_unit_test(widths),
        cmocka_unit_test(cleaning),
        cmocka_unit_test(sums_of_jobs),
        cmocka_unit_test(news_of_jobs),
        cmocka_unit_test(exit_codes),
        cmocka_unit_test(absolute_paths),
        cmocka_unit_test(hdus),
        cmocka_unit_test(values_of_a_configuration),
        cmocka_unit_test(completion_data),
        cmocka_unit_test(completion_data_of_the_table),
        cmocka_unit_test(summaries),
        cmocka_unit_test(findings),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
