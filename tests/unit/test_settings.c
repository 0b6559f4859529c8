/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of the settings' table: every entry, every value, every kind of wrong text. */
#include "pair.h"
#include "test.h"

#include "shear/settings.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const void *member(const shear_settings *s, const shear_setting_def *def) {
    return (const char *)s + def->offset;
}

static size_t size_of(const shear_setting_def *def) {
    return def->type == SHEAR_T_DOUBLE ? sizeof(double)
           : def->type == SHEAR_T_BOOL ? sizeof(bool)
                                       : sizeof(int);
}

static size_t round_up(size_t n, size_t unit) {
    return (n + unit - 1) / unit * unit;
}

/* The members stand in the table's order, and none is left out. */
static void assert_members_are_covered(const shear_setting_def *table, size_t n) {
    size_t next = 0;
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(table[i].offset, round_up(next, size_of(&table[i])));
        next = table[i].offset + size_of(&table[i]);
    }
    assert_int_equal(sizeof(shear_settings), round_up(next, sizeof(double)));
}

static void test_table(void **state) {
    (void)state;
    size_t n;
    const shear_setting_def *table = shear_settings_table(&n);
    assert_members_are_covered(table, n);
    for (size_t i = 0; i < n; i++) {
        assert_ptr_equal(shear_settings_find(table[i].name), &table[i]);
        assert_in_range(strlen(table[i].keyword), 1, 8);
        for (const char *c = table[i].keyword; *c != '\0'; c++) {
            assert_true(isupper((unsigned char)*c) || isdigit((unsigned char)*c) || *c == '_' ||
                        *c == '-');
        }
        assert_true(strlen(table[i].help) > 10 && strchr(table[i].help, '\n') == NULL);
        assert_true((table[i].type == SHEAR_T_CHOICE) == (table[i].choices != NULL));
        assert_true(table[i].offset + size_of(&table[i]) <= sizeof(shear_settings));
        for (size_t j = 0; j < i; j++) {
            assert_string_not_equal(table[i].name, table[j].name);
            assert_string_not_equal(table[i].keyword, table[j].keyword);
            assert_true(table[i].offset != table[j].offset);
        }
    }
    assert_null(shear_settings_find("beta-rati"));
    assert_null(shear_settings_find("beta-ratios"));
    assert_null(shear_settings_find(""));
    assert_null(shear_settings_find("Beta"));
    assert_ptr_equal(shear_settings_find("beta_ratio"), shear_settings_find("beta-ratio"));
}

static void test_defaults(void **state) {
    (void)state;
    shear_settings s;
    shear_settings_init(&s);
    assert_int_equal(shear_settings_check(&s, NULL), SHEAR_OK);
    assert_true(s.preset == SHEAR_PRESET_DEFAULT && s.interpolation == SHEAR_INTERP_AUTO &&
                s.oversample == 0 && isnan(s.beta_px) && s.beta_ratio == 2.0 &&
                s.beta_floor_px == 1.4);
    assert_true(s.filter == SHEAR_FILTER_AUTO && isnan(s.core_px) && isnan(s.width_px) &&
                s.zeros == SHEAR_ZEROS_SKIP);
    assert_true(s.pedestal == 0.0 && s.psf_threshold == 1e-8 && s.power_tolerance == 1e-3 &&
                s.noise_correction && s.shot_noise == SHEAR_SHOT_NONE &&
                s.estimator == SHEAR_ESTIMATOR_MEAN);
    assert_true(s.background == SHEAR_BACKGROUND_AUTO && s.artefacts == SHEAR_ARTEFACTS_FLAG &&
                isnan(s.bad_value));
}

/* Format, set into something else, compare bits; and formatting again gives the same text. */
static void check_round_trip(const shear_settings *s, const shear_setting_def *def) {
    char text[64];
    char again[64];
    shear_settings other;
    shear_error err = {0};
    memset(&other, 0x55, sizeof other);
    assert_ptr_equal(shear_settings_format(s, def, text, sizeof text), text);
    if (shear_settings_set(&other, def->name, text, &err) != SHEAR_OK)
        fail_msg("%s = %s: %s", def->name, text, err.message);
    if (def->type != SHEAR_T_DOUBLE || !isnan(*(const double *)member(s, def)))
        assert_memory_equal(member(&other, def), member(s, def), size_of(def));
    assert_string_equal(shear_settings_format(&other, def, again, sizeof again), text);
}

static void test_round_trips(void **state) {
    (void)state;
    size_t n;
    uint64_t seed = 1;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        const shear_setting_def *def = &table[i];
        shear_settings s;
        shear_settings_init(&s);
        void *value = (char *)&s + def->offset;
        check_round_trip(&s, def);
        for (int k = 0; k < 300; k++) {
            const double span = fmin(def->max, 1e300) - def->min;
            if (def->type == SHEAR_T_CHOICE) {
                for (int c = 0; def->choices[c] != NULL; c++) {
                    *(int *)value = c;
                    check_round_trip(&s, def);
                }
                break;
            }
            if (def->type == SHEAR_T_BOOL) {
                *(bool *)value = k % 2 == 0;
            } else if (def->type == SHEAR_T_INT) {
                *(int *)value = (int)(def->min + floor(uniform(&seed) * (span + 1.0)));
            } else {
                const double power = pow(10.0, -20.0 * uniform(&seed) * uniform(&seed));
                *(double *)value = k == 0   ? def->min
                                   : k == 1 ? def->max
                                            : def->min + span * uniform(&seed) * power;
            }
            check_round_trip(&s, def);
        }
    }
}

static void check_refused(const char *name, const char *text) {
    shear_settings s;
    shear_settings before;
    shear_error err = {0};
    shear_settings_init(&s);
    memcpy(&before, &s, sizeof s);
    if (shear_settings_set(&s, name, text, &err) != SHEAR_E_SETTING)
        fail_msg("%s = '%s' was accepted", name, text);
    assert_int_equal(err.code, SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, name));
    assert_memory_equal(&s, &before, sizeof s);
    assert_int_equal(shear_settings_set(&s, name, text, NULL), SHEAR_E_SETTING);
}

static void test_refusals(void **state) {
    (void)state;
    size_t n;
    const shear_setting_def *table = shear_settings_table(&n);
    static const char *const nonsense[] = {"",     "x",     "1 2", "1x",   "nan",   "inf",
                                           "-inf", "1e999", "-1",  "AUTO", "2e400", "tru"};
    for (size_t i = 0; i < n; i++) {
        char text[64];
        for (size_t k = 0; k < sizeof nonsense / sizeof nonsense[0]; k++) {
            const bool negative = table[i].type == SHEAR_T_DOUBLE && table[i].min < 0.0;
            if (!negative || strcmp(nonsense[k], "-1") != 0)
                check_refused(table[i].name, nonsense[k]);
        }
        if (!table[i].has_auto && table[i].type != SHEAR_T_CHOICE)
            check_refused(table[i].name, "auto");
        if (table[i].type == SHEAR_T_INT) {
            check_refused(table[i].name, "1.5");
            check_refused(table[i].name, "0");
            check_refused(table[i].name, "99999999999999999999");
            check_refused(table[i].name, "4294967300"); /* 4 after truncation to 32 bits */
        }
        if (table[i].type == SHEAR_T_DOUBLE && table[i].max < 1e300) {
            snprintf(text, sizeof text, "%.17g", nextafter(table[i].max, INFINITY));
            check_refused(table[i].name, text);
        }
        if (table[i].type == SHEAR_T_DOUBLE && table[i].min > 0.0) {
            snprintf(text, sizeof text, "%.17g", nextafter(table[i].min, 0.0));
            check_refused(table[i].name, text);
        }
    }
    check_refused("bad-value", "auto");
    check_refused("beta", "none");
    check_refused("no-such-setting", "1");
    check_refused("filter", "2");
}

static void test_words(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool value;
    } words[] = {{"true", true}, {"false", false}, {"yes", true}, {"no", false},
                 {"on", true},   {"off", false},   {"1", true},   {"0", false}};
    shear_settings s;
    shear_settings_init(&s);
    for (int i = 0; i < 8; i++) {
        s.noise_correction = !words[i].value;
        assert_int_equal(shear_settings_set(&s, "noise_correction", words[i].text, NULL), SHEAR_OK);
        assert_int_equal(s.noise_correction, words[i].value);
    }
    assert_int_equal(shear_settings_set(&s, "interpolation", "log_spline", NULL), SHEAR_OK);
    assert_int_equal(s.interpolation, SHEAR_INTERP_LOG_SPLINE);
    assert_int_equal(shear_settings_set(&s, "oversample", "auto", NULL), SHEAR_OK);
    assert_int_equal(s.oversample, 0);
    s.beta_px = 3.0;
    assert_int_equal(shear_settings_set(&s, "beta", "auto", NULL), SHEAR_OK);
    assert_true(isnan(s.beta_px));
}

static void test_names(void **state) {
    (void)state;
    assert_string_equal(shear_interpolation_name(SHEAR_INTERP_LOG_BICUBIC), "log-bicubic");
    assert_string_equal(shear_interpolation_name((enum shear_interpolation) - 1), "unknown");
    assert_string_equal(shear_interpolation_name(9), "unknown");
    assert_string_equal(shear_filter_name(SHEAR_FILTER_EDGE), "edge");
    assert_string_equal(shear_filter_name(4), "r-gal");
    assert_string_equal(shear_filter_name(5), "unknown");
    for (int i = -1; i < 10; i++) {
        assert_int_equal(
            shear_interpolation_is_log((enum shear_interpolation)i),
            strncmp(shear_interpolation_name((enum shear_interpolation)i), "log-", 4) == 0);
    }
}

static void check_contradiction(const char *const *settings, bool good, const char *word) {
    shear_settings s;
    shear_error err = {0};
    shear_settings_init(&s);
    for (int i = 0; settings[i] != NULL; i += 2)
        assert_int_equal(shear_settings_set(&s, settings[i], settings[i + 1], NULL), SHEAR_OK);
    assert_int_equal(shear_settings_check(&s, &err), good ? SHEAR_OK : SHEAR_E_SETTING);
    assert_true(good || strstr(err.message, word) != NULL);
}

#define GOOD(...)      check_contradiction((const char *const[]){__VA_ARGS__, NULL}, true, "")
#define BAD(word, ...) check_contradiction((const char *const[]){__VA_ARGS__, NULL}, false, word)

static void test_contradictions(void **state) {
    (void)state;
    BAD("oversample", "oversample", "3");
    BAD("oversample", "oversample", "12", "interpolation", "spline");
    BAD("oversample", "oversample", "2", "interpolation", "none");
    GOOD("oversample", "1", "interpolation", "none");
    GOOD("oversample", "64", "interpolation", "spline");
    GOOD("oversample", "2");
    BAD("core", "core", "5", "filter", "none");
    BAD("core", "core", "5", "filter", "paper");
    BAD("core", "core", "5", "filter", "edge");
    GOOD("core", "5");
    GOOD("core", "5", "filter", "r-gal");
    GOOD("core", "0", "width", "2");
    BAD("width", "width", "5", "filter", "none");
    BAD("background", "background", "noise-mean", "filter", "none");
    GOOD("background", "noise-mean", "filter", "edge");
    GOOD("background", "noise-mean");
    GOOD("background", "auto", "filter", "none");
    GOOD("background", "keep", "filter", "none");
    BAD("estimator", "estimator", "pdf-sym-cross", "noise-correction", "no");
    GOOD("estimator", "pdf-sym", "noise-correction", "no");
    GOOD("width", "5", "filter", "edge");
    GOOD("width", "5", "filter", "paper");
    BAD("pedestal", "pedestal", "1", "interpolation", "none");
    BAD("pedestal", "pedestal", "1", "interpolation", "spline");
    GOOD("pedestal", "1", "interpolation", "log-spline");
    GOOD("pedestal", "1");
    GOOD("pedestal", "1", "interpolation", "paper");
    BAD("shot-noise", "shot-noise", "plateau", "interpolation", "log-spline");
    BAD("shot-noise", "shot-noise", "plateau", "interpolation", "bilinear");
    GOOD("shot-noise", "plateau", "interpolation", "none");
    GOOD("shot-noise", "plateau");
    GOOD("shot-noise", "plateau", "interpolation", "paper");
    GOOD("shot-noise", "none", "interpolation", "bilinear");
}

/* All members, as bytes that shear_settings_init has set. */
static void check_same(const shear_settings *a, const shear_settings *b) {
    size_t n;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        char text_a[64];
        char text_b[64];
        assert_string_equal(shear_settings_format(a, &table[i], text_a, sizeof text_a),
                            shear_settings_format(b, &table[i], text_b, sizeof text_b));
    }
}

static void change_everything(shear_settings *s) {
    shear_settings_set(s, "interpolation", "spline", NULL);
    shear_settings_set(s, "beta-ratio", "7", NULL);
    shear_settings_set(s, "zeros", "floor", NULL);
    shear_settings_set(s, "estimator", "pdf-sym", NULL);
}

/* A preset sets all, whatever was there; what follows overrides it, and nothing else changes. */
static void test_preset(void **state) {
    (void)state;
    shear_settings defaults;
    shear_settings s;
    shear_settings paper;
    shear_settings_init(&defaults);
    shear_settings_init(&s);
    shear_settings_init(&paper);
    assert_int_equal(shear_settings_set(&paper, "preset", "zhang2010", NULL), SHEAR_OK);
    assert_true(paper.preset == SHEAR_PRESET_ZHANG2010 && paper.beta_ratio == 1.5 &&
                paper.beta_floor_px == 0.0 && paper.interpolation == SHEAR_INTERP_PAPER &&
                paper.background == SHEAR_BACKGROUND_KEEP && paper.filter == SHEAR_FILTER_R_GAL);
    assert_int_equal(shear_settings_check(&paper, NULL), SHEAR_OK);
    change_everything(&s);
    assert_int_equal(shear_settings_set(&s, "preset", "zhang2010", NULL), SHEAR_OK);
    check_same(&s, &paper);
    shear_settings_set(&s, "beta-ratio", "1.7", NULL);
    assert_true(s.beta_ratio == 1.7);
    paper.beta_ratio = 1.7;
    check_same(&s, &paper);
    assert_int_equal(shear_settings_set(&s, "preset", "default", NULL), SHEAR_OK);
    check_same(&s, &defaults);
}

/* Given in any order, the same settings come out: the preset first, between others or last. */
static void test_preset_in_any_order(void **state) {
    (void)state;
    static const char *const others[][2] = {{"interpolation", "spline"},
                                            {"beta_ratio", "7"},
                                            {"noise-correction", "no"},
                                            {"bad-value", "-1"}};
    shear_settings expected;
    shear_settings_init(&expected);
    shear_settings_set(&expected, "preset", "zhang2010", NULL);
    for (size_t i = 0; i < 4; i++)
        shear_settings_set(&expected, others[i][0], others[i][1], NULL);
    for (size_t place = 0; place <= 4; place++) {
        bool given[64] = {false};
        shear_settings s;
        shear_settings_init(&s);
        for (size_t i = 0; i <= 4; i++) {
            const char *const preset[2] = {"preset", "zhang2010"};
            const char *const *one = i == place ? preset : others[i < place ? i : i - 1];
            assert_int_equal(shear_settings_give(&s, given, one[0], one[1], NULL), SHEAR_OK);
        }
        check_same(&s, &expected);
        assert_int_equal(shear_settings_give(&s, given, "beta", "x", NULL), SHEAR_E_SETTING);
        check_same(&s, &expected);
        assert_true(given[0] && given[1] && !given[2]);
    }
}

/* Members that were not set through the table. */
static void test_ranges(void **state) {
    (void)state;
    size_t n;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        shear_settings s;
        shear_error err = {0};
        shear_settings_init(&s);
        void *value = (char *)&s + table[i].offset;
        if (table[i].type == SHEAR_T_BOOL)
            continue;
        if (table[i].type == SHEAR_T_DOUBLE) {
            *(double *)value = table[i].min < 0.0 ? 2.0 * table[i].min : -1.0;
        } else {
            *(int *)value = -1;
        }
        assert_int_equal(shear_settings_check(&s, &err), SHEAR_E_SETTING);
        assert_non_null(strstr(err.message, table[i].name));
        if (table[i].type == SHEAR_T_DOUBLE) {
            *(double *)value = table[i].has_auto ? INFINITY : NAN;
        } else {
            *(int *)value = 1024;
        }
        assert_int_equal(shear_settings_check(&s, &err), SHEAR_E_SETTING);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_contradictions),
        cmocka_unit_test(test_preset),
        cmocka_unit_test(test_preset_in_any_order),
        cmocka_unit_test(test_ranges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
