/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is written: the sample, the effective configuration, the manual, the options; and damaged
 * files, which are at worst refused. */
#include "config_file.h"
#include "value.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

static sheard_problems problems;

/* noinline: inlined, gcc 12 takes the text for a dangling pointer. */
__attribute__((noinline)) static char *written(int (*print)(FILE *, shear_error *)) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    assert_int_equal(print(out, NULL), SHEAR_OK);
    fclose(out);
    return text;
}

/* In place: take the '#' from every setting (comments have a space behind theirs). */
static void uncomment(char *text) {
    char *to = text;
    bool line_begins = true;
    for (const char *from = text; *from != '\0'; from++) {
        bool mark = line_begins && from[0] == '#' && from[1] != ' ' && from[1] != '\n';
        line_begins = *from == '\n';
        if (!mark)
            *to++ = *from;
    }
    *to = '\0';
}

static void sample_is_current(void **state) {
    (void)state;
    char *sample = written(sheard_config_print_sample);
    char *committed = slurp(CONFIG_SAMPLE);
    if (strcmp(sample, committed) != 0) {
        print_error(
            "config/sheard.conf is not what the table says: build the target config-sample\n");
    }
    assert_string_equal(sample, committed);
    free(sample);
    free(committed);
}

static void sample_is_the_defaults(void **state) {
    sheard_config defaults;
    sheard_config config;
    char *sample = written(sheard_config_print_sample);
    assert_int_equal(sheard_config_init(&defaults, NULL), SHEAR_OK);
    assert_int_equal(load_text_file(state, sample, &config, &problems), SHEAR_OK);
    assert_same_config(&config, &defaults);
    sheard_config_deinit(&config);

    uncomment(sample);
    int code = load_text_file(state, sample, &config, &problems);
    sheard_problems_print(&problems, stderr);
    assert_int_equal(code, SHEAR_OK);
    assert_same_config(&config, &defaults);
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        assert_true(config.lines[i] > 0); /* every setting is in the sample */
    }
    sheard_config_deinit(&config);
    sheard_config_deinit(&defaults);
    free(sample);
}

static void lines_are_short(const char *text, size_t most) {
    for (const char *p = text; *p != '\0'; p += strcspn(p, "\n") + 1)
        assert_true(strcspn(p, "\n") <= most);
}

static void sample_fits_a_terminal(void **state) {
    (void)state;
    char *sample = written(sheard_config_print_sample);
    lines_are_short(sample, 79);
    free(sample);
}

static void defaults_are_sound(void **state) {
    (void)state;
    sheard_config config;
    problems = (sheard_problems){0};
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    assert_int_equal(sheard_config_check(&config, &problems), SHEAR_OK);
    assert_string_equal(config.daemon.state_dir, "/var/lib/sheard");
    assert_string_equal(config.daemon.socket, "/run/sheard/sheard.sock");
    assert_int_equal(config.daemon.socket_mode, 0660);
    assert_string_equal(config.spool.directory, "/var/spool/sheard");
    assert_int_equal(config.access.data_roots.n, 0);
    assert_int_equal(config.access.admin_users.n, 1);
    assert_int_equal(config.spool.done.max_age_ms, 0); /* nothing is ever removed unasked */
    assert_int_equal(config.spool.done.max_count, 0);
    assert_int_equal(config.spool.done.max_bytes, 0);
    assert_true(config.measure.beta_ratio == 2.0);
    sheard_config_deinit(&config);
}

/* A value in the setting's range that is not `before`, from its row. */
static void other_measure_value(const shear_setting_def *def, const char *before, char *buf,
                                size_t size) {
    const double middle = def->min / 2 + def->max / 2;
    switch (def->type) {
    case SHEAR_T_CHOICE:
        snprintf(buf, size, "%s", def->choices[strcmp(def->choices[0], before) == 0]);
        break;
    case SHEAR_T_BOOL:
        snprintf(buf, size, "%s", strcmp(before, "true") == 0 ? "false" : "true");
        break;
    case SHEAR_T_INT:
        snprintf(buf, size, "%d", (int)middle);
        break;
    default:
        snprintf(buf, size, "%.17g", middle != 0.0 ? middle : def->max);
        break;
    }
}

static void other_value(const sheard_setting *s, const char *before, char *buf, size_t size) {
    sheard_setting plain = *s; /* its bounds are never the word */
    plain.word = NULL;
    switch (s->type) {
    case SHEARD_T_MEASURE:
        other_measure_value(s->measure, before, buf, size);
        break;
    case SHEARD_T_PATH:
        snprintf(buf, size, "/elsewhere");
        break;
    case SHEARD_T_PATHS:
        snprintf(buf, size, "/else, /where");
        break;
    case SHEARD_T_NAME:
        snprintf(buf, size, "some");
        break;
    case SHEARD_T_NAMES:
        snprintf(buf, size, "some, others");
        break;
    case SHEARD_T_CHOICE:
        snprintf(buf, size, "%s", s->choices[strcmp(s->choices[0], before) == 0]);
        break;
    case SHEARD_T_BOOL:
        snprintf(buf, size, "%s", strcmp(before, "true") == 0 ? "false" : "true");
        break;
    default:
        number_format(&plain, s->min, buf, size);
        if (strcmp(buf, before) == 0)
            number_format(&plain, s->max, buf, size);
        break;
    }
}

/* Set every setting to something else than its default. */
static void change_all(sheard_config *config) {
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        char other[64];
        char *before = sheard_config_format(config, i);
        other_value(&s, before, other, sizeof other);
        assert_int_equal(sheard_config_set(config, s.section, s.key, other, NULL), SHEAR_OK);
        char *after = sheard_config_format(config, i);
        assert_string_not_equal(before, after);
        free(after);
        free(before);
    }
}

static void printed_loads_the_same(void **state) {
    sheard_config config;
    sheard_config again;
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    change_all(&config);
    char *text = printed(&config);
    assert_non_null(strstr(text, "# command line\n"));
    assert_null(strstr(text, "# default\n"));
    assert_int_equal(load_text_file(state, text, &again, &problems), SHEAR_OK);
    assert_same_config(&config, &again);
    free(text);

    text = printed(&again);
    assert_non_null(strstr(text, "file.conf:"));
    free(text);
    sheard_config_deinit(&again);
    sheard_config_deinit(&config);
}

/* The longest values that can be set print as lines that can be read. */
static void longest_values_print_and_load(void **state) {
    sheard_config config;
    sheard_config again;
    char list[4000] = "";
    char item[200];
    memset(item, 'p', sizeof item);
    item[0] = '/';
    item[180] = '\0';
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        if (s.type == SHEARD_T_PATH && s.max == 180)
            assert_int_equal(sheard_config_set(&config, s.section, s.key, item, NULL), SHEAR_OK);
    }
    for (int i = 0; i < 20; i++) {
        item[1] = (char)('a' + i);
        snprintf(list + strlen(list), 190, "%.180s,", item);
    }
    assert_int_equal(sheard_config_set(&config, "access", "data_roots", list, NULL), SHEAR_OK);
    char *text = printed(&config);
    lines_are_short(text, 198);
    assert_int_equal(load_text_file(state, text, &again, &problems), SHEAR_OK);
    assert_int_equal(again.access.data_roots.n, 20);
    assert_same_config(&config, &again);
    free(text);
    sheard_config_deinit(&again);
    sheard_config_deinit(&config);
}

static void a_full_disk_is_an_error(void **state) {
    (void)state;
    shear_error err = {0};
    FILE *full = fopen("/dev/full", "w");
    if (full == NULL)
        skip();
    assert_int_equal(sheard_config_print_sample(full, &err), SHEAR_E_IO);
    fclose(full);
}

static void manual_has_every_setting(void **state) {
    (void)state;
    char *manual = written(sheard_config_print_manual);
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        char head[80] = ".It Cm ";
        for (const char *p = s.key; *p != '\0'; p++)
            snprintf(head + strlen(head), 4, *p == '-' ? "\\-" : "%c", *p);
        char *at = strstr(manual, head);
        assert_non_null(at);
        assert_non_null(strstr(at, "Default: "));
    }
    for (const char *p = manual; *p != '\0'; p += strcspn(p, "\n") + 1) {
        assert_false(p[0] == '\''); /* no control line by accident */
        assert_true(p[0] != '.' || strchr("ISBEF", p[1]) != NULL);
    }
    free(manual);
}

static void options_become_settings(void **state) {
    (void)state;
    struct option options[100];
    sheard_list assignments = {0};
    sheard_config config;
    shear_error err = {0};
    size_t n = sheard_flags_fill(options, 100);
    assert_true(n > 5);
    assert_null(options[n].name);
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    for (size_t i = 0; i < n; i++) {
        if (strcmp(options[i].name, "workers") == 0) {
            assert_int_equal(sheard_flags_assign(options[i].val, "6", &assignments, &err),
                             SHEAR_OK);
        }
        if (strcmp(options[i].name, "spool") == 0) {
            assert_int_equal(sheard_flags_assign(options[i].val, "/s", &assignments, &err),
                             SHEAR_OK);
        }
    }
    assert_int_equal(assignments.n, 2);
    for (size_t i = 0; i < assignments.n; i++)
        assert_int_equal(sheard_config_assign(&config, assignments.items[i], &err), SHEAR_OK);
    assert_int_equal(config.daemon.workers, 6);
    assert_string_equal(config.spool.directory, "/s");
    assert_int_equal(sheard_flags_assign('v', "6", &assignments, &err), SHEAR_E_INTERNAL);
    sheard_list_deinit(&assignments);
    sheard_config_deinit(&config);

    assert_int_equal(sheard_flags_fill(options, 3), 2); /* room for the zeros is kept */
    assert_null(options[2].name);
    assert_int_equal(sheard_flags_fill(options, 0), 0);
}

static void options_help(void **state) {
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    sheard_flags_help(out);
    fclose(out);
    assert_non_null(strstr(text, "  --workers N "));
    assert_non_null(strstr(text, "(default auto)"));
    assert_non_null(strstr(text, "  --state-dir PATH "));
    lines_are_short(text, 78);
    free(text);
}

/* ---- damage ---- */

static uint64_t next_random(uint64_t *x) { /* xorshift64 */
    *x ^= *x << 13;
    *x ^= *x >> 7;
    *x ^= *x << 17;
    return *x;
}

/* One of: another byte, bytes lost, a piece repeated elsewhere, cut off. Returns the new size, at
 * most `room`. */
static size_t damage(char *text, size_t size, size_t room, uint64_t *x) {
    static const char bytes[] = "\0\n\r\t []=:;#,/.-_09KMG\x7f\xff\xef\xbb\xbf";
    size_t at = next_random(x) % size;
    size_t from = next_random(x) % size;
    size_t n = 1 + next_random(x) % 300;
    switch (next_random(x) % 8) {
    case 0:
        return at + 1;
    case 1:
        n = n < size - at ? n : size - at - 1;
        memmove(text + at, text + at + n, size - at - n);
        return size - n;
    case 2:
        n = n < size - from ? n : size - from;
        n = n < room - size ? n : room - size;
        memmove(text + at + n, text + at, size - at);
        memmove(text + at, text + from, n);
        return size + n;
    default:
        text[at] = bytes[next_random(x) % (sizeof bytes - 1)];
        return size;
    }
}

/* Whatever the file: no crash, errors in lines that exist, and what loads prints and loads the
 * same. */
static bool survives(void **state, const char *text, size_t size) {
    sheard_config config;
    sheard_config again;
    problems = (sheard_problems){0};
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    const char *path = file_with_bytes(state, "file.conf", text, size);
    int code = sheard_config_load(&config, path, &problems);
    assert_true((code == SHEAR_OK) == (problems.n_errors == 0));
    assert_true(problems.n_kept <= SHEARD_PROBLEMS_KEPT);
    for (size_t i = 0; i < problems.n_kept; i++) {
        const char *line = strstr(problems.kept[i].where, ".conf:");
        assert_non_null(line);
        long number = strtol(line + 6, NULL, 10);
        assert_true(number >= 1 && number <= (long)size + 1);
    }
    char *out = printed(&config); /* also after errors: what was good has been set */
    assert_int_equal(load_text_file(state, out, &again, &problems), SHEAR_OK);
    assert_same_config(&config, &again);
    free(out);
    sheard_config_deinit(&again);
    sheard_config_deinit(&config);
    return code == SHEAR_OK;
}

static void damaged_files(void **state) {
    enum { FILES = 1000, ROOM = 1 << 16 };
    static char text[ROOM];
    sheard_config config;
    uint64_t x = UINT64_C(20261122);
    int n_good = 0;
    assert_int_equal(sheard_config_init(&config, NULL), SHEAR_OK);
    change_all(&config);
    char *whole = printed(&config);
    for (int i = 0; i < FILES; i++) {
        size_t size = strlen(whole);
        memcpy(text, whole, size);
        for (uint64_t hits = 1 + next_random(&x) % 6; hits > 0 && size > 1; hits--)
            size = damage(text, size, ROOM, &x);
        n_good += survives(state, text, size);
    }
    free(whole);
    sheard_config_deinit(&config);
    /* Damage in comments does no harm, most other does: neither everything nor nothing is refused.
     */
    assert_in_range(n_good, FILES / 50, FILES / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sample_is_current),       cmocka_unit_test(sample_is_the_defaults),
        cmocka_unit_test(sample_fits_a_terminal),  cmocka_unit_test(defaults_are_sound),
        cmocka_unit_test(printed_loads_the_same),  cmocka_unit_test(longest_values_print_and_load),
        cmocka_unit_test(a_full_disk_is_an_error), cmocka_unit_test(manual_has_every_setting),
        cmocka_unit_test(options_become_settings), cmocka_unit_test(options_help),
        cmocka_unit_test(damaged_files),
    };
    return cmocka_run_group_tests(tests, directory_make, directory_remove);
}
