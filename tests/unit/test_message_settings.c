/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settings of a job: whatever JSON a client sends, they have one text, checked like options. */
#include "rpc_fixture.h"
#include "test.h"

#include <float.h>
#include <string.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_settings_have_one_text),
        cmocka_unit_test(test_whole_settings),
        cmocka_unit_test(test_settings_of_0_1),
        cmocka_unit_test(test_bad_settings_text),
        cmocka_unit_test(test_every_setting),
        cmocka_unit_test(test_settings_upon_defaults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
