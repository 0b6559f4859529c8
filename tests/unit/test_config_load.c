/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The configuration file: its syntax, and every error, with file and line. */
#include "config_file.h"
#include "file.h"
#include "origin.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static sheard_problems problems; /* too large for the stack's taste */

/* This text has exactly one error, in this line, with these words. */
static void one_error(void **state, const char *text, int line, const char *words) {
    sheard_config config;
    int code = load_text_file(state, text, &config, &problems);
    sheard_config_deinit(&config);
    if (problems.n_errors != 1)
        sheard_problems_print(&problems, stderr);
    assert_int_equal(code, SHEAR_E_SETTING);
    assert_int_equal(problems.n_errors, 1);
    assert_problem(&problems, 0, line, words);
}

static void syntax(void **state) {
    sheard_config config;
    int code = load_text_file(state,
                              "\xef\xbb\xbf# comment\r\n"
                              "; comment\n"
                              "[daemon] ; behind a section\n"
                              "  \t\n"
                              "workers = 3\t; behind a value\r\n"
                              "state-dir=/srv/a;b#c\n"
                              "socket: /srv/socket ;comment\n"
                              "[ access ]\n"
                              "  data_roots = /data/a, ; the first\n"
                              "    # a comment between\n"
                              "\n"
                              "\t/data/b ; the second\n"
                              " /data/c=d,/data/[e]\n"
                              "admin_groups =\n"
                              "  one\n"
                              "[daemon]\n"
                              "nice = 5",
                              &config, &problems);
    sheard_problems_print(&problems, stderr);
    assert_int_equal(code, SHEAR_OK);
    assert_int_equal(problems.n_errors, 0);
    assert_int_equal(config.daemon.workers, 3);
    assert_string_equal(config.daemon.state_dir, "/srv/a;b#c");
    assert_string_equal(config.daemon.socket, "/srv/socket");
    assert_int_equal(config.access.data_roots.n, 4);
    assert_string_equal(config.access.data_roots.items[0], "/data/a");
    assert_string_equal(config.access.data_roots.items[1], "/data/b");
    assert_string_equal(config.access.data_roots.items[2], "/data/c=d");
    assert_string_equal(config.access.data_roots.items[3], "/data/[e]");
    assert_int_equal(config.access.admin_groups.n, 1);
    assert_int_equal(config.daemon.nice, 5);
    sheard_config_deinit(&config);
}

static void empty_files(void **state) {
    static const char *const texts[] = {"", "\n", "\xef\xbb\xbf", "# only this", "[daemon]", " "};
    sheard_config defaults;
    assert_int_equal(sheard_config_init(&defaults, NULL), SHEAR_OK);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        sheard_config config;
        assert_int_equal(load_text_file(state, texts[i], &config, &problems), SHEAR_OK);
        assert_same_config(&config, &defaults);
        sheard_config_deinit(&config);
    }
    sheard_config_deinit(&defaults);
}

static void bad_lines(void **state) {
    one_error(state, "[daemon]\nworkers\n", 2, "no '='");
    one_error(state, "[daemon]\nworkers ; = 3", 2, "no '='");
    one_error(state, "[daemon]\n= 3\n", 2, "no key");
    one_error(state, "[daemon\nworkers = 3\n", 1, "no ']'");
    one_error(state, "\n[daemon] workers = 3\n", 2, "text after the section");
    one_error(state, "workers = 3\n", 1, "before any section");
    one_error(state, "[daemon]\nworkers = 3 # three\n", 2, "'#' does not begin a comment");
    one_error(state, "[daemon]\nworkers = #3\n", 2, "'#' does not begin a comment");
    one_error(state, "[access]\ndata_roots = /a\n  /b # c\n", 3, "'#' does not begin a comment");
    one_error(state, "[daemon]\nworkers = 3\n  nice = 5\n", 3, "goes on with 'workers' of line 2");
    one_error(state, "[daemon]\nworkers = 3\n\n[spool]\nenabled = yes\n [daemon]\n", 6,
              "goes on with 'enabled' of line 5");
    one_error(state, "[daemon]\nwork\033ers = 3\n", 2, "control characters");
    one_error(state, "[daemon]\nworkers = 3\rnice = 5\n", 2, "control characters");
}

static void bad_values(void **state) {
    one_error(state, "[daemon]\n\nworkers = many\n", 3, "[daemon] workers: 'many' is not");
    one_error(state, "[daemon]\nworkers =\n", 2, "'' is not a whole number");
    one_error(state, "[reader]\nwall_time = 10\n", 2, "with its unit");
    one_error(state, "[measure]\nbeta = x\n", 2, "[measure]: setting 'beta'");
    one_error(state, "[access]\n# a\ndata_roots = /a,\n /b,\n  c\n", 3,
              "'c' is not an absolute path");
    one_error(state, "[daemon]\nworkers = 3\nnice = 1\nworkers = 4\n", 4, "already set in line 2");
    one_error(state, "[measure]\nbeta-ratio = 2\n[measure]\nbeta_ratio = 2\n", 4,
              "already set in line 2");
    one_error(state, "[access]\ndata_roots = /a\n[daemon]\n[access]\ndata_roots = /b\n /c\n", 5,
              "already set in line 2");
}

/* A preset lies beneath the section's other settings, wherever it stands. */
static void preset_in_any_order(void **state) {
    static const char *const texts[] = {
        "[measure]\npreset = zhang2010\nbeta-ratio = 3\nnoise-correction = no\n",
        "[measure]\nbeta_ratio = 3\nnoise-correction = no\npreset = zhang2010\n",
        "[measure]\nbeta-ratio = 3\npreset = zhang2010\n[daemon]\n[measure]\nnoise-correction = no",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        sheard_config config;
        assert_int_equal(load_text_file(state, texts[i], &config, &problems), SHEAR_OK);
        const shear_settings *m = &config.measure;
        assert_int_equal(m->preset, SHEAR_PRESET_ZHANG2010);
        assert_true(m->beta_ratio == 3.0 && !m->noise_correction);
        assert_true(m->beta_floor_px == 0.0 && m->filter == SHEAR_FILTER_R_GAL);
        sheard_config_deinit(&config);
    }
}

static void unknown_names(void **state) {
    one_error(state, "[deamon]\nworkers = 3\nwhatever = 3\n", 1, "did you mean [daemon]?");
    one_error(state, "[daemon]\nworkesr = 3\n", 2, "did you mean workers?");
    one_error(state, "[daemon]\nqueue = 3\n", 2, "it belongs in section [limits]");
    one_error(state, "[daemon]\ndata_root = /a\n /b\n", 2, "no setting");
    one_error(state, "[]\n", 1, "no section []");
    one_error(state,
              "[a_section_whose_name_is_longer_than_any_section_is_and_than_what_we_keep_of_its_"
              "name_x]\n",
              1, "no section [a_section_whose_name");
}

static void long_lines(void **state) {
    char text[600];
    char filler[500];
    sheard_config config;
    memset(filler, 'x', sizeof filler);
    filler[499] = '\0';

    snprintf(text, sizeof text, "[daemon]\nstate_dir = /%.185s\nnice = 1\n", filler);
    one_error(state, text, 2, "has 186 bytes; at most 180");
    snprintf(text, sizeof text, "[daemon]\nstate_dir = /%.186s\nnice = 1\n", filler);
    one_error(state, text, 2, "this line has 199 bytes; at most 198");
    snprintf(text, sizeof text, "[daemon]\n%s\nnice = 1\n", filler);
    one_error(state, text, 2, "this line has 499 bytes");

    /* Comments may be long, and are not chopped into lines. */
    snprintf(text, sizeof text, "[daemon]\n#%.180s workers = 9 %.250s\nnice = 1\n", filler, filler);
    assert_int_equal(load_text_file(state, text, &config, &problems), SHEAR_OK);
    assert_int_equal(config.daemon.workers, 0);
    assert_int_equal(config.daemon.nice, 1);
    sheard_config_deinit(&config);
}

static void load_bytes(void **state, const char *text, size_t size, int line, const char *words) {
    sheard_config config;
    problems = (sheard_problems){0};
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    const char *path = file_with_bytes(state, "file.conf", text, size);
    assert_int_not_equal(sheard_config_load(&config, path, &problems), SHEAR_OK);
    assert_int_equal(problems.n_errors, 1);
    assert_problem(&problems, 0, line, words);
    sheard_config_deinit(&config);
}

static void zero_bytes(void **state) {
    static const char in_value[] = "[daemon]\nnice = 1\0 2\n";
    static const char in_comment[] = "[daemon]\n# a \0 comment\n";
    load_bytes(state, in_value, sizeof in_value - 1, 2, "control characters");
    load_bytes(state, in_comment, sizeof in_comment - 1, 2, "control characters");
}

static void large_files(void **state) {
    sheard_config config;
    char *text = malloc(CONFIG_FILE_MAX + 1);
    assert_non_null(text);
    memset(text, '\n', CONFIG_FILE_MAX + 1);
    load_bytes(state, text, CONFIG_FILE_MAX + 1, 0, "larger than 1048576 bytes");
    assert_int_equal(problems.kept[0].error.code, SHEAR_E_IO);

    problems = (sheard_problems){0};
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    const char *path = file_with_bytes(state, "file.conf", text, CONFIG_FILE_MAX);
    assert_int_equal(sheard_config_load(&config, path, &problems), SHEAR_OK);
    sheard_config_deinit(&config);
    free(text);
}

static void unreadable_files(void **state) {
    sheard_config config;
    char path[200];
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);

    problems = (sheard_problems){0};
    snprintf(path, sizeof path, "%s/absent/file.conf", (char *)*state);
    assert_int_equal(sheard_config_load(&config, path, &problems), SHEAR_E_IO);
    assert_problem(&problems, 0, 0, "No such file");

    problems = (sheard_problems){0}; /* as the default path is allowed to */
    assert_int_equal(config_load_file(&config, path, true, &problems), SHEAR_OK);
    assert_int_equal(problems.n_errors, 0);

    assert_int_equal(sheard_config_load(&config, *state, &problems), SHEAR_E_IO);
    assert_non_null(strstr(problems.kept[0].error.message, "not a regular file"));

    problems = (sheard_problems){0}; /* nobody writes to it: must not wait */
    snprintf(path, sizeof path, "%s/fifo", (char *)*state);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(sheard_config_load(&config, path, &problems), SHEAR_E_IO);
    assert_non_null(strstr(problems.kept[0].error.message, "not a regular file"));
    sheard_config_deinit(&config);
}

/* All problems are counted, the first twenty kept, in order; the good values around them are set.
 */
static void many_errors(void **state) {
    char text[2000] = "[daemon]\n";
    sheard_config config;
    for (int i = 0; i < 30; i++)
        snprintf(text + strlen(text), 40, "wrong_%d = 1\n", i);
    snprintf(text + strlen(text), 20, "nice = 7\n");
    assert_int_equal(load_text_file(state, text, &config, &problems), SHEAR_E_SETTING);
    assert_int_equal(problems.n_errors, 30);
    assert_int_equal(problems.n_kept, SHEARD_PROBLEMS_KEPT);
    for (int i = 0; i < SHEARD_PROBLEMS_KEPT; i++) {
        char words[20];
        snprintf(words, sizeof words, "'wrong_%d'", i);
        assert_problem(&problems, (size_t)i, i + 2, words);
    }
    assert_int_equal(config.daemon.nice, 7);
    sheard_config_deinit(&config);

    char *printed_text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&printed_text, &size);
    sheard_problems_print(&problems, out);
    fclose(out);
    assert_non_null(
        strstr(printed_text, "file.conf:2: error: [daemon] there is no setting 'wrong_0'\n    "));
    assert_non_null(strstr(printed_text, "... and 10 more\n"));
    free(printed_text);

    shear_error err = {0};
    assert_int_equal(sheard_problems_error(&problems, &err), SHEAR_E_SETTING);
    assert_non_null(
        strstr(err.message, "file.conf:2: [daemon] there is no setting 'wrong_0' (and 29 more)"));
}

static void problems_without_errors(void **state) {
    (void)state;
    shear_error err = {0};
    sheard_config config;
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    problems = (sheard_problems){0};
    assert_int_equal(sheard_problems_error(&problems, &err), SHEAR_OK);
    for (int i = 0; i < 25; i++)
        problems_warn(&problems, &config, 0, NULL, "warning %d", i);
    assert_int_equal(sheard_problems_error(&problems, &err), SHEAR_OK);
    err = (shear_error){.code = SHEAR_E_IO, .message = "late"};
    assert_int_equal(problems_add(&problems, "there", &err), SHEAR_E_IO);
    assert_int_not_equal(sheard_problems_error(&problems, &err), SHEAR_OK);
    assert_non_null(strstr(err.message, "has 1 error"));
    sheard_config_deinit(&config);
}

static void places(void **state) {
    (void)state;
    char buf[24];
    assert_string_equal(place_in_file("/etc/a.conf", 12, buf, sizeof buf), "/etc/a.conf:12");
    assert_string_equal(place_in_file("/etc/a.conf", 0, buf, sizeof buf), "/etc/a.conf");
    assert_string_equal(place_in_file("/a/very/long/path/to/a.conf", 12, buf, sizeof buf),
                        "...ng/path/to/a.conf:12");
}

/* File, then command line, then contradictions; all that is wrong is told; nothing to free after
 * errors. */
static void read_from_all(void **state) {
    sheard_config config;
    sheard_list assignments = {0};
    problems = (sheard_problems){0};
    const char *path = file_with(state, "[daemon]\nworkers = 3\nnice = 4\n");
    assert_int_equal(sheard_list_append(&assignments, "daemon.workers=5", NULL), SHEAR_OK);
    assert_int_equal(sheard_config_read(&config, path, &assignments, &problems), SHEAR_OK);
    assert_int_equal(config.daemon.workers, 5);
    assert_int_equal(config.daemon.nice, 4);
    sheard_config_deinit(&config);

    path = file_with(state, "[daemon]\nworkers = x\n");
    assert_int_equal(sheard_list_append(&assignments, "daemon.nice=x", NULL), SHEAR_OK);
    assert_int_equal(sheard_config_read(&config, path, &assignments, &problems), SHEAR_E_SETTING);
    assert_int_equal(problems.n_errors, 2);
    assert_problem(&problems, 0, 2, "workers");
    assert_string_equal(problems.kept[1].where, "command line");
    sheard_list_deinit(&assignments);

    problems = (sheard_problems){0};
    path = file_with(state, "[retry]\nfirst_delay = 2h\n");
    assert_int_equal(sheard_config_read(&config, path, NULL, &problems), SHEAR_E_SETTING);
    assert_problem(&problems, 0, 2, "first_delay is longer than retry.max_delay");

    problems = (sheard_problems){0};
    assert_int_equal(sheard_config_read(&config, "/nonexistent.conf", NULL, &problems), SHEAR_E_IO);
}

static void check_of(void **state, const char *text, size_t n_errors, const char *words) {
    char *told = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&told, &size);
    assert_int_equal(sheard_config_check_file(file_with(state, text), NULL, out), n_errors);
    fclose(out);
    if (strstr(told, words) == NULL)
        print_error("%s", told);
    assert_non_null(strstr(told, words));
    free(told);
}

static void check_for_people(void **state) {
    check_of(state, "[limits]\nconnections = 1\n", 0, "file.conf: good\n");
    check_of(state, "[limits]\nconnections = 1\n[daemon]\nsocket_mode = 666\n", 0,
             "file.conf:4: warning: [daemon] socket_mode: every user");
    check_of(state, "[limits]\nconnections = 1\n[daemon]\nsocket_mode = 666\n", 0,
             "file.conf: good, with 1 warning\n");
    check_of(state, "[daemon]\nworkers = x\n", 1, "file.conf: 1 error\n");
    check_of(state, "[daemon]\nworkers = x\nnice = x\n", 2, "file.conf: 2 errors\n");
}

static void warnings(void **state) {
    sheard_config config;
    int code = load_text_file(state,
                              "[limits]\nconnections = 1\n"
                              "[daemon]\nsocket_group = no_such_group_9\n"
                              "[access]\nadmin_users = root, no_such_user_9\n"
                              "admin_groups = root, no_such_group_9, 1234567\n"
                              "submit_groups = no_such_group_9\n"
                              "data_roots = /, /tmp, /nonexistent_9, /dev/null\n",
                              &config, &problems);
    assert_int_equal(code, SHEAR_OK);
    sheard_config_warnings(&config, &problems);
    static const struct {
        int line;
        const char *words;
    } expected[] = {{6, "no user 'no_such_user_9'"},      {7, "no group 'no_such_group_9'"},
                    {8, "no group 'no_such_group_9'"},    {4, "no group 'no_such_group_9'"},
                    {9, "every file that they may read"}, {9, "'/nonexistent_9': No such file"},
                    {9, "'/dev/null' is not a directory"}};
    size_t n = sizeof expected / sizeof expected[0];
    assert_int_equal(problems.n_warnings, n);
    for (size_t i = 0; i < n; i++) {
        char place[32];
        snprintf(place, sizeof place, "/file.conf:%d", expected[i].line);
        assert_true(problems.kept[i].is_warning);
        assert_non_null(strstr(problems.kept[i].where, place));
        assert_non_null(strstr(problems.kept[i].error.message, expected[i].words));
        assert_true(i >= 4 || strstr(problems.kept[i].error.advice,
                                     i < 3 ? "nobody has" : "does not start") != NULL);
    }
    sheard_config_deinit(&config);
}

static void free_of_nothing(void **state) {
    (void)state;
    sheard_config config = {0};
    sheard_config_deinit(&config);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(syntax),
        cmocka_unit_test(empty_files),
        cmocka_unit_test(bad_lines),
        cmocka_unit_test(bad_values),
        cmocka_unit_test(preset_in_any_order),
        cmocka_unit_test(unknown_names),
        cmocka_unit_test(long_lines),
        cmocka_unit_test(zero_bytes),
        cmocka_unit_test(large_files),
        cmocka_unit_test(unreadable_files),
        cmocka_unit_test(many_errors),
        cmocka_unit_test(problems_without_errors),
        cmocka_unit_test(places),
        cmocka_unit_test(read_from_all),
        cmocka_unit_test(check_for_people),
        cmocka_unit_test(warnings),
        cmocka_unit_test(free_of_nothing),
    };
    return cmocka_run_group_tests(tests, directory_make, directory_remove);
}
