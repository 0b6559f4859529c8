/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every type of value: accepted and refused texts, errors, and that values are written as they are
 * read.
 */
#include "config_file.h"
#include "value.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static sheard_config config;

static int init(void **state) {
    (void)state;
    return sheard_config_init(&config, NULL);
}

static int deinit(void **state) {
    (void)state;
    sheard_config_deinit(&config);
    return 0;
}

/* Set, and the text it is written as. */
static void good(const char *section, const char *key, const char *text, const char *written) {
    shear_error err = {0};
    int code = sheard_config_set(&config, section, key, text, &err);
    if (code != SHEAR_OK)
        print_error("%s.%s = '%s': %s\n", section, key, text, err.message);
    assert_int_equal(code, SHEAR_OK);
    char *back = sheard_config_format(&config, (size_t)sheard_setting_find(section, key));
    assert_string_equal(back, written);
    free(back);
}

/* Refused with these words and the setting's name, and the value stays. */
static void bad(const char *section, const char *key, const char *text, const char *words) {
    shear_error err = {0};
    size_t index = (size_t)sheard_setting_find(section, key);
    char *before = sheard_config_format(&config, index);
    assert_int_equal(sheard_config_set(&config, section, key, text, &err), SHEAR_E_SETTING);
    char *after = sheard_config_format(&config, index);
    assert_string_equal(before, after);
    if (strstr(err.message, words) == NULL)
        print_error("'%s' is not in '%s'\n", words, err.message);
    assert_non_null(strstr(err.message, words));
    assert_non_null(strstr(err.message, section));
    assert_non_null(strstr(err.message, key));
    free(before);
    free(after);
}

static void integers(void **state) {
    (void)state;
    good("daemon", "max_active_jobs", "1", "1");
    good("daemon", "max_active_jobs", "256", "256");
    assert_int_equal(config.daemon.max_active_jobs, 256);
    good("daemon", "max_active_jobs", "007", "7");
    static const char *const not [] = {"0",
                                       "257",
                                       "-1",
                                       "+1",
                                       "1.0",
                                       "1e2",
                                       "",
                                       " 1",
                                       "1 ",
                                       "auto",
                                       "x",
                                       "1K",
                                       "0x10",
                                       "1s",
                                       "9223372036854775808",
                                       "99999999999999999999999999999999"};
    for (size_t i = 0; i < sizeof not / sizeof not [0]; i++)
        bad("daemon", "max_active_jobs", not [i], "is not a whole number of jobs from 1 to 256");
    good("daemon", "nice", "0", "0");
}

static void words_for_zero(void **state) {
    (void)state;
    good("daemon", "workers", "3", "3");
    good("daemon", "workers", "auto", "auto");
    assert_int_equal(config.daemon.workers, 0);
    bad("daemon", "workers", "0", "from 1 to 1024, or auto");
    bad("daemon", "workers", "Auto", "or auto");
    good("spool", "done_max_bytes", "2T", "2T");
    good("spool", "done_max_bytes", "unlimited", "unlimited");
    assert_int_equal(config.spool.done.max_bytes, 0);
    good("limits", "idle_timeout", "never", "never");
    assert_int_equal(config.limits.idle_timeout_ms, 0);
}

static void sizes(void **state) {
    (void)state;
    good("plans", "max_bytes", "1048576", "1M");
    assert_int_equal(config.plans.max_bytes, 1 << 20);
    good("plans", "max_bytes", "1048577", "1048577");
    good("plans", "max_bytes", "1025K", "1025K");
    good("plans", "max_bytes", "2048K", "2M");
    assert_int_equal(config.plans.max_bytes, 1 << 21);
    good("plans", "max_bytes", "1024G", "1T");
    good("reader", "memory", "1T", "1T");
    assert_true(config.reader.memory_bytes == INT64_C(1) << 40);
    good("reader", "memory", "3G", "3G");
    static const char *const not [] = {"1048575",  "1025G",
                                       "1k",       "1KB",
                                       "1 K",      "K",
                                       "-4K",      "1.5K",
                                       "",         "9223372036854775807K",
                                       "8388608T", "9223372036854775808"};
    for (size_t i = 0; i < sizeof not / sizeof not [0]; i++)
        bad("plans", "max_bytes", not [i], "is not a size (as in 512K, 64M, 4G) from 1M to 1T");
}

static void durations(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int64_t ms;
        const char *written;
    } cases[] = {{"100ms", 100, "100ms"},     {"1s", 1000, "1s"},       {"1500ms", 1500, "1500ms"},
                 {"2000ms", 2000, "2s"},      {"60s", 60000, "1min"},   {"90s", 90000, "90s"},
                 {"90min", 5400000, "90min"}, {"60min", 3600000, "1h"}, {"24h", 86400000, "1d"},
                 {"1d", 86400000, "1d"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        good("reader", "wall_time", cases[i].text, cases[i].written);
        assert_int_equal(config.reader.wall_time_ms, cases[i].ms);
    }
    static const char *const not [] = {"99ms",
                                       "2d",
                                       "86400001ms",
                                       "10",
                                       "0",
                                       "1m",
                                       "1 s",
                                       "s",
                                       "-1s",
                                       "1.5h",
                                       "1S",
                                       "",
                                       "1sec",
                                       "106751991168d",
                                       "9223372036854775807d"};
    for (size_t i = 0; i < sizeof not / sizeof not [0]; i++) {
        bad("reader", "wall_time", not [i],
            "is not a duration with its unit (as in 250ms, 30s, 5min, 2h, 7d) from 100ms to 1d");
    }
    good("daemon", "drain_timeout", "0s", "0s");
    good("daemon", "drain_timeout", "0ms", "0s");
    bad("daemon", "drain_timeout", "0", "with its unit");
}

static void modes(void **state) {
    (void)state;
    good("daemon", "socket_mode", "0660", "0660");
    assert_int_equal(config.daemon.socket_mode, 0660);
    good("daemon", "socket_mode", "777", "0777");
    assert_int_equal(config.daemon.socket_mode, 0777);
    static const char *const not [] = {
        "0577", "1777", "0668", "u=rw", "", "-660", "07777777777777777777777"};
    for (size_t i = 0; i < sizeof not / sizeof not [0]; i++)
        bad("daemon", "socket_mode", not [i], "is not an octal mode from 0600 to 0777");
}

static void choices_and_booleans(void **state) {
    (void)state;
    good("daemon", "log_level", "error", "error");
    assert_int_equal(config.daemon.log_level, SHEARD_LOG_ERROR);
    good("daemon", "log_level", "debug", "debug");
    assert_int_equal(config.daemon.log_level, SHEARD_LOG_DEBUG);
    bad("daemon", "log_level", "verbose", "is not one of: error, warning, notice, info, debug");
    bad("daemon", "log_level", "", "is not one of");
    static const char *const yes[] = {"true", "yes", "on", "1"};
    static const char *const no[] = {"false", "no", "off", "0"};
    for (int i = 0; i < 4; i++) {
        good("spool", "enabled", yes[i], "true");
        assert_true(config.spool.enabled);
        good("spool", "enabled", no[i], "false");
        assert_false(config.spool.enabled);
    }
    bad("spool", "enabled", "TRUE", "is not one of: true, false");
    bad("spool", "enabled", "2", "is not one of: true, false");
}

static void paths(void **state) {
    (void)state;
    good("daemon", "state_dir", "/srv//sheard/", "/srv/sheard");
    good("daemon", "state_dir", "//", "/");
    good("daemon", "state_dir", "/a b/..c/.d/e.", "/a b/..c/.d/e.");
    good("daemon", "state_dir", "/a;b#c", "/a;b#c");
    bad("daemon", "state_dir", "", "not an absolute path");
    bad("daemon", "state_dir", "srv/sheard", "not an absolute path");
    bad("daemon", "state_dir", "~/sheard", "not an absolute path");
    bad("daemon", "state_dir", "/a/../b", "'.' or '..'");
    bad("daemon", "state_dir", "/a/.", "'.' or '..'");
    bad("daemon", "state_dir", "/..", "'.' or '..'");
    bad("daemon", "state_dir", "/a\nb", "cannot be written");
    bad("daemon", "state_dir", "/a ;b", "cannot be written");
    bad("daemon", "state_dir", "/a #b", "cannot be written");
    bad("daemon", "state_dir", "/a ", "cannot be written");
    bad("daemon", "state_dir", "/a /", "cannot be written");

    char longest[200];
    memset(longest, 'x', sizeof longest);
    longest[0] = '/';
    longest[180] = '\0';
    good("daemon", "state_dir", longest, longest);
    longest[107] = '\0';
    good("daemon", "socket", longest, longest);
    longest[107] = 'x';
    longest[108] = '\0';
    bad("daemon", "socket", longest, "has 108 bytes; at most 107");
}

static void names(void **state) {
    (void)state;
    good("daemon", "socket_group", "lensing", "lensing");
    good("daemon", "socket_group", "", "");
    good("daemon", "socket_group", "DOMAIN\\some.user-1@x", "DOMAIN\\some.user-1@x");
    bad("daemon", "socket_group", "two words", "is not the name of a user or group");
    bad("daemon", "socket_group", "-x", "is not the name");
    bad("daemon", "socket_group", "a:b", "is not the name");
    bad("daemon", "socket_group", "x23456789012345678901234567890123", "is not the name");
}

static void lists(void **state) {
    (void)state;
    good("access", "data_roots", "/data/b , /data//a/,/c d", "/data/b, /data/a, /c d");
    assert_int_equal(config.access.data_roots.n, 3);
    assert_string_equal(config.access.data_roots.items[1], "/data/a");
    good("access", "data_roots", " , /x,, ", "/x");
    good("access", "data_roots", "/x\n/y,\n/z", "/x, /y, /z");
    bad("access", "data_roots", "/x, y", "'y' is not an absolute path");
    bad("access", "data_roots", "/x, /y, /x/", "'/x' is listed twice");
    bad("access", "data_roots", "/x, /y ;z", "cannot be written");
    good("access", "data_roots", "", "");
    assert_int_equal(config.access.data_roots.n, 0);
    good("access", "admin_users", "root, alice,bob", "root, alice, bob");
    bad("access", "admin_users", "root, a b", "'a b' is not the name");
}

static void measurement(void **state) {
    (void)state;
    good("measure", "beta-ratio", "1.75", "1.75");
    good("measure", "beta_ratio", "2", "2");
    assert_true(config.measure.beta_ratio == 2.0);
    good("measure", "interpolation", "log-spline", "log-spline");
    assert_int_equal(config.measure.interpolation, SHEAR_INTERP_LOG_SPLINE);
    bad("measure", "beta-ratio", "wide", "wide");
    bad("measure", "filter", "wide", "wide");
}

static void unknown_names(void **state) {
    (void)state;
    static const struct {
        const char *section, *key, *message, *advice;
    } cases[] = {
        {"deamon", "workers", "no section [deamon]", "did you mean [daemon]?"},
        {"catalogs", "enabled", "no section [catalogs]", "did you mean [catalogues]?"},
        {"xyzzy", "workers", "no section [xyzzy]", "sheard.conf(5)"},
        {"", "workers", "no section []", "sheard.conf(5)"},
        {"daemon", "worker", "[daemon] there is no setting 'worker'", "did you mean workers?"},
        {"daemon", "log-levle", "no setting 'log-levle'", "did you mean log_level?"},
        {"measure", "noise_corection", "no setting", "did you mean noise-correction?"},
        {"daemon", "queue", "no setting 'queue'", "it belongs in section [limits]"},
        {"daemon", "flux_capacitor", "no setting 'flux_capacitor'", "sheard.conf(5)"},
        {"daemon", "a_name_that_is_longer_than_any_name_of_ours", "no setting", "sheard.conf(5)"},
        {"daemon", "", "no setting ''", "sheard.conf(5)"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        shear_error err = {0};
        assert_int_equal(sheard_config_set(&config, cases[i].section, cases[i].key, "1", &err),
                         SHEAR_E_SETTING);
        assert_non_null(strstr(err.message, cases[i].message));
        assert_non_null(strstr(err.advice, cases[i].advice));
    }
}

static void assignments(void **state) {
    (void)state;
    shear_error err = {0};
    assert_int_equal(sheard_config_assign(&config, "daemon.workers=4", &err), SHEAR_OK);
    assert_int_equal(config.daemon.workers, 4);
    assert_int_equal(sheard_config_assign(&config, "daemon.state_dir=/a=b.c", &err), SHEAR_OK);
    assert_string_equal(config.daemon.state_dir, "/a=b.c");
    assert_int_equal(sheard_config_assign(&config, "access.admin_groups=", &err), SHEAR_OK);
    static const char *const not [] = {"", "workers=4", "daemon.workers", "daemon=workers.4", "."};
    for (size_t i = 0; i < sizeof not / sizeof not [0]; i++) {
        assert_int_equal(sheard_config_assign(&config, not [i], &err), SHEAR_E_SETTING);
        assert_non_null(strstr(err.message, "section.key=value"));
    }
}

/* The bounds of every number are values, those beyond are not, and both are written so that they
 * read back. */
static void bounds_of_every_number(void **state) {
    (void)state;
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        if (s.type != SHEARD_T_INT && s.type != SHEARD_T_BYTES && s.type != SHEARD_T_DURATION)
            continue;
        const char *unit = s.type == SHEARD_T_DURATION ? "ms" : "";
        for (int side = 0; side < 2; side++) {
            char text[64];
            char buf[64];
            int64_t bound = side == 0 ? s.min : s.max;
            int64_t number = -1;
            snprintf(text, sizeof text, "%" PRId64 "%s", bound, unit);
            assert_true(number_parse(&s, text, &number));
            assert_true(number == bound);
            (void)number_format(&s, bound, buf, sizeof buf);
            assert_true(number_parse(&s, buf, &number));
            assert_true(number == bound);
            snprintf(text, sizeof text, "%" PRId64 "%s", side == 0 ? bound - 1 : bound + 1, unit);
            assert_false(number_parse(&s, text, &number));
        }
    }
}

/* Names are unique, sections are contiguous and described, flags are unique, helps are sentences.
 */
static void the_table_is_sound(void **state) {
    (void)state;
    size_t n = sheard_settings_count();
    for (size_t i = 0; i < n; i++) {
        sheard_setting s = sheard_setting_at(i);
        assert_int_equal(sheard_setting_find(s.section, s.key), i);
        assert_non_null(sheard_section_help(s.section));
        size_t length = strlen(s.help);
        assert_true(s.measure != NULL || s.help[length - 1] == '.');
        for (size_t j = i + 1; j < n; j++) {
            sheard_setting other = sheard_setting_at(j);
            bool apart = j > i + 1 && strcmp(sheard_setting_at(j - 1).section, s.section) != 0;
            assert_false(apart && strcmp(other.section, s.section) == 0);
            assert_false(s.flag != NULL && other.flag != NULL && strcmp(s.flag, other.flag) == 0);
        }
    }
    assert_int_equal(sheard_setting_find("daemon", "nothing"), -1);
    assert_null(sheard_section_help("nothing"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(integers, init, deinit),
        cmocka_unit_test_setup_teardown(words_for_zero, init, deinit),
        cmocka_unit_test_setup_teardown(sizes, init, deinit),
        cmocka_unit_test_setup_teardown(durations, init, deinit),
        cmocka_unit_test_setup_teardown(modes, init, deinit),
        cmocka_unit_test_setup_teardown(choices_and_booleans, init, deinit),
        cmocka_unit_test_setup_teardown(paths, init, deinit),
        cmocka_unit_test_setup_teardown(names, init, deinit),
        cmocka_unit_test_setup_teardown(lists, init, deinit),
        cmocka_unit_test_setup_teardown(measurement, init, deinit),
        cmocka_unit_test_setup_teardown(unknown_names, init, deinit),
        cmocka_unit_test_setup_teardown(assignments, init, deinit),
        cmocka_unit_test(bounds_of_every_number),
        cmocka_unit_test(the_table_is_sound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
