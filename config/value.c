/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "value.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"

#include <ctype.h>
#include <string.h>

/* ---- paths and names ---- */

/* Return whether a component of the path is '.' or '..'. */
static bool has_dots(const char *path) {
    for (const char *p = path; *p != '\0';) {
        size_t n = strcspn(p, "/");
        if ((n == 1 && p[0] == '.') || (n == 2 && p[0] == '.' && p[1] == '.'))
            return true;
        p += n;
        p += strspn(p, "/");
    }
    return false;
}

/* Return whether the file's syntax cannot express the text: control characters, a space at the end,
 * and ';' or '#' after a space, which begin a comment. */
static bool has_unwritable(const char *text) {
    for (const char *p = text; *p != '\0'; p++) {
        if (iscntrl((unsigned char)*p) || (*p == ' ' && (p[1] == ';' || p[1] == '#')))
            return true;
    }
    return text[0] != '\0' && text[strlen(text) - 1] == ' ';
}

static int check_path(const sheard_setting *s, const char *text, shear_error *err) {
    if (text[0] != '/') {
        return shear_fail(err, SHEAR_E_SETTING, "write the whole path, beginning with '/'",
                          "'%.200s' is not an absolute path", text);
    }
    if (strlen(text) > (size_t)s->max) {
        return shear_fail(err, SHEAR_E_SETTING, "choose a shorter path, or make a symbolic link",
                          "the path has %zu bytes; at most %d are possible", strlen(text),
                          (int)s->max);
    }
    if (has_dots(text)) {
        return shear_fail(err, SHEAR_E_SETTING, "write the path without them",
                          "'%.200s' has a part '.' or '..'", text);
    }
    if (has_unwritable(text) || (s->type == SHEARD_T_PATHS && strchr(text, ',') != NULL)) {
        return shear_fail(
            err, SHEAR_E_SETTING, "rename it, or make a symbolic link",
            "'%.200s' has a character that cannot be written here (control characters, "
            "' ;', ' #', commas in lists)",
            text);
    }
    return SHEAR_OK;
}

/* Change "/a//b/" to "/a/b", so that equal paths are equal texts. */
static void tidy_path(char *path) {
    char *to = path;
    for (const char *from = path; *from != '\0'; from++) {
        if (*from != '/' || from == path || from[-1] != '/')
            *to++ = *from;
    }
    if (to > path + 1 && to[-1] == '/')
        to--;
    *to = '\0';
}

static int check_name(const sheard_setting *s, const char *text, shear_error *err) {
    static const char letters[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-$@\\";
    if (strlen(text) > (size_t)s->max || text[0] == '-' || text[strspn(text, letters)] != '\0') {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "'%.60s' is not the name of a user or group",
                          text);
    }
    return SHEAR_OK;
}

static bool is_path(const sheard_setting *s) {
    return s->type == SHEARD_T_PATH || s->type == SHEARD_T_PATHS;
}

/* Make a tidied and checked copy of text[0..n). */
static int parse_item(const sheard_setting *s, const char *text, size_t n, char **item,
                      shear_error *err) {
    CLEANUP(release_free) char *copy = strndup(text, n);
    if (copy == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %s", s->key);
    if (is_path(s)) {
        tidy_path(copy); /* before the check: "/a /" becomes "/a ", which cannot be written */
    }
    if (s->word == NULL || strcmp(copy, s->word) != 0)
        TRY(is_path(s) ? check_path(s, copy, err) : check_name(s, copy, err));
    *item = CLEANUP_TAKE(copy);
    return SHEAR_OK;
}

/* ---- lists: items separated by commas and line ends; empty items are ignored ---- */

static bool contains(const sheard_list *list, const char *item) {
    for (size_t i = 0; i < list->n; i++) {
        if (strcmp(list->items[i], item) == 0)
            return true;
    }
    return false;
}

static int add_item(const sheard_setting *s, sheard_list *list, const char *text, size_t n,
                    shear_error *err) {
    CLEANUP(release_free) char *item = NULL;
    TRY(parse_item(s, text, n, &item, err));
    if (contains(list, item))
        return shear_fail(err, SHEAR_E_SETTING, NULL, "'%.200s' is listed twice", item);
    return sheard_list_append(list, item, err);
}

static int parse_list(const sheard_setting *s, const char *text, sheard_list *out,
                      shear_error *err) {
    static const char blank[] = " \t";
    CLEANUP(sheard_list_deinit) sheard_list list = {0};
    while (*text != '\0') {
        text += strspn(text, blank);
        const size_t length = strcspn(text, ",\n");
        size_t n = length;
        while (n > 0 && strchr(blank, text[n - 1]) != NULL)
            n--;
        TRY(n > 0 ? add_item(s, &list, text, n, err) : SHEAR_OK);
        text += length + (text[length] != '\0');
    }
    *out = list;
    list = (sheard_list){0};
    return SHEAR_OK;
}

/* ---- parsing ---- */

static int parse_choice(const sheard_setting *s, const char *text, int *choice, shear_error *err) {
    char known[120];
    const int found = spelling_find(s->choices, text);
    if (found >= 0) {
        *choice = found;
        return SHEAR_OK;
    }
    text_list(known, sizeof known, s->choices);
    return shear_fail(err, SHEAR_E_SETTING, NULL, "'%.60s' is not one of: %s", text, known);
}

static int parse_bool(const char *text, bool *flag, shear_error *err) {
    if (text_to_bool(text, flag))
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_SETTING, NULL,
                      "'%.60s' is not one of: true, false (or yes, no, on, off, 1, 0)", text);
}

static int parse_number(const sheard_setting *s, const char *text, int64_t *number,
                        shear_error *err) {
    char expected[128];
    if (number_parse(s, text, number))
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_SETTING, NULL, "'%.60s' is not %s", text,
                      value_expected(s, expected, sizeof expected));
}

static int parse_mode(const sheard_setting *s, const char *text, unsigned *mode, shear_error *err) {
    int64_t number = 0;
    TRY(parse_number(s, text, &number, err));
    *mode = (unsigned)number;
    return SHEAR_OK;
}

static int parse(const sheard_setting *s, const char *text, value *parsed, shear_error *err) {
    switch (s->type) {
    case SHEARD_T_PATH:
    case SHEARD_T_NAME:
        return parse_item(s, text, strlen(text), &parsed->member.text, err);
    case SHEARD_T_PATHS:
    case SHEARD_T_NAMES:
        return parse_list(s, text, &parsed->list, err);
    case SHEARD_T_CHOICE:
        return parse_choice(s, text, &parsed->member.number, err);
    case SHEARD_T_BOOL:
        return parse_bool(text, &parsed->member.flag, err);
    case SHEARD_T_MODE:
        return parse_mode(s, text, &parsed->member.bits, err);
    default:
        return parse_number(s, text, &parsed->member.count, err);
    }
}

int value_parse(const sheard_setting *s, const char *text, value *parsed, shear_error *err) {
    const int code = parse(s, text, parsed, err);
    return code == SHEAR_E_SETTING ? shear_prefix(err, code, "[%s] %s", s->section, s->key) : code;
}
