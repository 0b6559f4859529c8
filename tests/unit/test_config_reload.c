/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contradictions, differences, and reloading a configuration while it is in use. */
#include "config_file.h"

#include <stdlib.h>
#include <string.h>

static sheard_problems problems;

static void make(sheard_config *config, const char *const *assignments) {
    problems = (sheard_problems){0};
    assert_int_equal(sheard_config_init(config, NULL), SHEAR_OK);
    for (; *assignments != NULL; assignments++)
        assert_int_equal(sheard_config_assign(config, *assignments, NULL), SHEAR_OK);
}

#define ALL(...) ((const char *const[]){__VA_ARGS__, NULL})

/* These settings contradict each other in these words; or not, where they are NULL. */
static void contradiction(const char *const *assignments, const char *words) {
    sheard_config config;
    make(&config, assignments);
    int code = sheard_config_check(&config, &problems);
    if (words == NULL) {
        assert_int_equal(code, SHEAR_OK);
        assert_int_equal(problems.n_errors, 0);
    } else {
        assert_int_equal(code, SHEAR_E_SETTING);
        assert_int_equal(problems.n_errors, 1);
        assert_non_null(strstr(problems.kept[0].error.message, words));
        assert_string_equal(problems.kept[0].where, "command line");
    }
    sheard_config_deinit(&config);
}

static void contradictions(void **state) {
    (void)state;
    contradiction(ALL("daemon.state_dir=/var/spool/sheard"),
                  "daemon.state_dir /var/spool/sheard is within");
    contradiction(ALL("daemon.state_dir=/var/spool/sheard/state"), "is within spool.directory");
    contradiction(ALL("daemon.state_dir=/var/spool/sheard", "spool.enabled=no"), NULL);
    contradiction(ALL("daemon.state_dir=/var/spool/sheard2"), NULL);
    contradiction(ALL("spool.directory=/var/lib/sheard/spool"), NULL);
    contradiction(ALL("catalogues.directory=/var/spool/sheard/incoming"), "catalogues.directory");
    contradiction(ALL("catalogues.directory=/var/spool/sheard/incoming", "catalogues.enabled=no"),
                  NULL);
    contradiction(ALL("catalogues.directory=/var/lib/sheard"), "is daemon.state_dir itself");
    contradiction(ALL("retry.first_delay=61min"), "first_delay is longer");
    contradiction(ALL("retry.first_delay=1h"), NULL);
    contradiction(ALL("retry.max_delay=9s"), "first_delay is longer");
    contradiction(ALL("reader.memory=128M"), "does not hold");
    contradiction(ALL("reader.memory=176M"), NULL);
    contradiction(ALL("reader.shared_memory=1G"), "does not hold");
    contradiction(ALL("measure.oversample=3"), "not a power of two");
    contradiction(ALL("measure.interpolation=none", "measure.oversample=4"), "[measure]");
    contradiction(ALL("measure.interpolation=bicubic", "measure.pedestal=4"), "pedestal");
}

static void a_spool_that_is_everything(void **state) {
    (void)state;
    sheard_config config;
    make(&config, ALL("spool.directory=/"));
    assert_int_equal(sheard_config_check(&config, &problems), SHEAR_E_SETTING);
    assert_int_equal(problems.n_errors, 2); /* state and catalogs both are within */
    sheard_config_deinit(&config);
}

/* Of two settings, the one that is written later is complained about. */
static void contradictions_have_lines(void **state) {
    sheard_config config;
    assert_int_equal(load_text_file(state,
                                    "[retry]\nmax_delay = 1s\nfirst_delay = 2s\n[measure]\n"
                                    "oversample = 4\ninterpolation = none\nbeta = 2\n",
                                    &config, &problems),
                     SHEAR_OK);
    assert_int_equal(sheard_config_check(&config, &problems), SHEAR_E_SETTING);
    assert_int_equal(problems.n_errors, 2);
    assert_problem(&problems, 0, 3, "first_delay is longer");
    assert_problem(&problems, 1, 7, "[measure]");
    sheard_config_deinit(&config);
}

static void differences(void **state) {
    (void)state;
    sheard_config a;
    sheard_config b;
    size_t changed[4];
    make(&a, ALL("daemon.workers=3"));
    make(&b, ALL("daemon.workers=4", "limits.queue=5", "access.data_roots=/a", "measure.beta=2",
                 "spool.directory=/s"));
    assert_int_equal(sheard_config_changes(&a, &a, false, changed, 4), 0);
    assert_int_equal(sheard_config_changes(&a, &b, false, changed, 4), 5);
    assert_int_equal(changed[0], sheard_setting_find("daemon", "workers"));
    assert_int_equal(changed[1], sheard_setting_find("spool", "directory"));
    assert_int_equal(changed[2], sheard_setting_find("access", "data_roots"));
    assert_int_equal(changed[3], sheard_setting_find("limits", "queue"));
    assert_int_equal(sheard_config_changes(&a, &b, true, changed, 4), 2);
    assert_int_equal(changed[0], sheard_setting_find("daemon", "workers"));
    assert_int_equal(changed[1], sheard_setting_find("spool", "directory"));
    assert_int_equal(sheard_config_changes(&a, &b, false, NULL, 0), 5);
    sheard_config_deinit(&a);
    sheard_config_deinit(&b);
}

/* Same lengths, other items; and the other way round. */
static void lists_differ_by_their_items(void **state) {
    (void)state;
    sheard_config a;
    sheard_config b;
    size_t index = (size_t)sheard_setting_find("access", "admin_users");
    make(&a, ALL("access.admin_users=x, y"));
    make(&b, ALL("access.admin_users=x, z"));
    assert_false(sheard_config_same(&a, &b, index));
    assert_int_equal(sheard_config_assign(&b, "access.admin_users=x", NULL), SHEAR_OK);
    assert_false(sheard_config_same(&a, &b, index));
    assert_int_equal(sheard_config_assign(&b, "access.admin_users=x,y", NULL), SHEAR_OK);
    assert_true(sheard_config_same(&a, &b, index));
    sheard_config_deinit(&a);
    sheard_config_deinit(&b);
}

static void reload(void **state) {
    sheard_config running;
    sheard_config fresh;
    assert_int_equal(load_text_file(state,
                                    "[daemon]\nworkers = 3\nlog_level = debug\n"
                                    "[spool]\ndirectory = /s\n",
                                    &running, &problems),
                     SHEAR_OK);
    assert_int_equal(
        load_text_file(state,
                       "\n\n\n[daemon]\nworkers = 4\n[spool]\ndirectory = /s\n[access]\n"
                       "data_roots = /a, /b\n[measure]\nbeta-ratio = 2\n",
                       &fresh, &problems),
        SHEAR_OK);
    assert_int_equal(sheard_config_reload(&running, &fresh, &problems), SHEAR_OK);
    sheard_config_deinit(&fresh);
    assert_int_equal(running.daemon.workers, 3);
    assert_int_equal(running.daemon.log_level, SHEARD_LOG_INFO);
    assert_string_equal(running.spool.directory, "/s");
    assert_int_equal(running.access.data_roots.n, 2);
    assert_true(running.measure.beta_ratio == 2.0);

    assert_int_equal(problems.n_warnings, 1);
    assert_non_null(strstr(problems.kept[0].where, "file.conf:5"));
    assert_non_null(strstr(problems.kept[0].error.message, "[daemon] workers"));

    char *text = printed(&running);
    assert_non_null(strstr(text, "# earlier configuration\nworkers = 3\n"));
    assert_non_null(strstr(text, "file.conf:7\ndirectory = /s\n"));
    assert_non_null(strstr(text, "# default\nlog_level = info\n"));
    free(text);
    sheard_config_deinit(&running);
}

/* Good by itself, but not with what cannot change while running. */
static void reload_of_a_contradiction(void **state) {
    (void)state;
    sheard_config running;
    sheard_config fresh;
    sheard_config before;
    make(&running, ALL("spool.directory=/a", "limits.queue=7"));
    make(&before, ALL("spool.directory=/a", "limits.queue=7"));
    make(&fresh, ALL("spool.directory=/b", "catalogues.directory=/a/x", "limits.queue=9"));
    assert_int_equal(sheard_config_check(&fresh, &problems), SHEAR_OK);
    assert_int_equal(sheard_config_reload(&running, &fresh, &problems), SHEAR_E_SETTING);
    assert_non_null(strstr(problems.kept[0].error.message, "/a/x is within spool.directory /a"));
    assert_int_equal(problems.n_warnings, 0);
    assert_same_config(&running, &before);
    sheard_config_deinit(&fresh);
    sheard_config_deinit(&before);
    sheard_config_deinit(&running);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contradictions),
        cmocka_unit_test(a_spool_that_is_everything),
        cmocka_unit_test(contradictions_have_lines),
        cmocka_unit_test(differences),
        cmocka_unit_test(lists_differ_by_their_items),
        cmocka_unit_test(reload),
        cmocka_unit_test(reload_of_a_contradiction),
    };
    return cmocka_run_group_tests(tests, directory_make, directory_remove);
}
