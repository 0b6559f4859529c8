/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "config_file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int directory_make(void **state) {
    char template[] = "/tmp/sheard-config-XXXXXX";
    char *path = mkdtemp(template) != NULL ? strdup(template) : NULL;
    *state = path;
    return path != NULL ? 0 : -1;
}

int directory_remove(void **state) {
    char command[100];
    snprintf(command, sizeof command, "rm -r '%s'", (char *)*state);
    free(*state);
    return system(command); /* NOLINT(cert-env33-c): the path is mkdtemp's */
}

const char *file_with_bytes(void **state, const char *name, const char *text, size_t size) {
    static char path[200];
    snprintf(path, sizeof path, "%s/%s", (char *)*state, name);
    (void)unlink(path); /* ext4 flushes what is overwritten, which is slow */
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    return path;
}

const char *file_with(void **state, const char *text) {
    return file_with_bytes(state, "file.conf", text, strlen(text));
}

int load_text_file(void **state, const char *text, sheard_config *config,
                   sheard_problems *problems) {
    memset(problems, 0, sizeof *problems);
    assert_int_equal(sheard_config_init(config, NULL), SHEAR_OK);
    return sheard_config_load(config, file_with(state, text), problems);
}

char *slurp(const char *path) {
    char *text = NULL;
    size_t room = 0;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    ssize_t n = getdelim(&text, &room, '\0', file);
    assert_true(n >= 0);
    fclose(file);
    return text;
}

char *printed(const sheard_config *config) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    assert_int_equal(sheard_config_print(config, out, NULL), SHEAR_OK);
    fclose(out);
    return text;
}

void assert_same_config(const sheard_config *a, const sheard_config *b) {
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        char *text_a = sheard_config_format(a, i);
        char *text_b = sheard_config_format(b, i);
        assert_string_equal(text_a, text_b);
        assert_true(sheard_config_same(a, b, i));
        free(text_a);
        free(text_b);
    }
}

void assert_problem(const sheard_problems *problems, size_t i, int line, const char *words) {
    char place[32];
    assert_true(i < problems->n_kept);
    const sheard_problem *p = &problems->kept[i];
    snprintf(place, sizeof place, line > 0 ? "/file.conf:%d" : "/file.conf", line);
    size_t n = strlen(p->where);
    bool here = n > strlen(place) && strcmp(p->where + n - strlen(place), place) == 0;
    bool told = strstr(p->error.message, words) != NULL || strstr(p->error.advice, words) != NULL;
    if (!here || !told) {
        print_error("expected %s, '%s'; got %s: %s (%s)\n", place, words, p->where,
                    p->error.message, p->error.advice);
    }
    assert_true(here);
    assert_true(told);
    assert_false(p->is_warning);
    assert_true(p->error.code != SHEAR_OK);
}
