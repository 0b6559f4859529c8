/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Settings as canonical text, and as a JSON object of native types. */
#include "message/table.h"
#include "json/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VALUE_SIZE = 64, LINE_SIZE = 160 }; /* of one setting */

/* -0 and 0 are one value and must be one text. */
static void drop_sign_of_zero(shear_settings *s, const shear_setting_def *def) {
    double *value = (void *)((char *)s + def->offset);
    if (def->type == SHEAR_T_DOUBLE && *value == 0.0) {
        *value = 0.0;
    }
}

/* Add "NAME=VALUE\n" to buf; false: it does not fit. */
static bool add_line(char *buf, size_t size, const shear_settings *s,
                     const shear_setting_def *def) {
    char value[VALUE_SIZE];
    shear_settings clean = *s;
    drop_sign_of_zero(&clean, def);
    shear_settings_format(&clean, def, value, sizeof value);
    const size_t used = strlen(buf);
    const int n = snprintf(buf + used, size - used, "%s=%s\n", def->name, value);
    return n > 0 && (size_t)n < size - used;
}

int sheard_settings_write(const shear_settings *s, char *buf, size_t size, shear_error *err) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    bool fits = size > 0;
    if (fits) {
        buf[0] = '\0';
    }
    for (size_t i = 0; fits && i < n; i++) {
        fits = add_line(buf, size, s, &table[i]);
    }
    return fits ? SHEAR_OK
                : shear_fail(err, SHEAR_E_SETTING, NULL, "settings do not fit %zu bytes", size);
}

/* One line of *text, its name and value apart, in `line`; *text moves on. */
static int take_line(const char **text, char line[LINE_SIZE], char **value, shear_error *err) {
    const size_t n = strcspn(*text, "\n");
    if (n >= LINE_SIZE) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "settings have a line of %zu bytes", n);
    }
    memcpy(line, *text, n);
    line[n] = '\0';
    *text += n + ((*text)[n] == '\n');
    *value = strchr(line, '=');
    if (*value == NULL) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "settings: '%s' is not NAME=VALUE", line);
    }
    *(*value)++ = '\0';
    return SHEAR_OK;
}

int sheard_settings_apply(shear_settings *s, const char *text, shear_error *err) {
    char line[LINE_SIZE];
    char *value = NULL;
    while (text != NULL && *text != '\0') {
        int rc = take_line(&text, line, &value, err);
        if (rc == SHEAR_OK) {
            rc = shear_settings_set(s, line, value, err);
        }
        if (rc != SHEAR_OK) {
            return rc;
        }
    }
    return shear_settings_check(s, err);
}

/* What 0.1 called auto. */
static int read_old(shear_settings *s, const char *text, shear_error *err) {
    shear_settings_init(s);
    int code = shear_settings_set(s, "preset", "zhang2010", err);
    if (code == SHEAR_OK) {
        code = sheard_settings_apply(s, text, err);
    }
    if (code == SHEAR_OK && s->interpolation == SHEAR_INTERP_AUTO) {
        code = shear_settings_set(s, "interpolation", "paper", err);
    }
    if (code == SHEAR_OK && s->filter == SHEAR_FILTER_AUTO) {
        code = shear_settings_set(s, "filter", "r-gal", err);
    }
    return code;
}

int sheard_settings_read(shear_settings *s, const char *text, shear_error *err) {
    static const char first[] = "preset=";
    if (strncmp(text, first, sizeof first - 1) != 0) {
        return read_old(s, text, err);
    }
    shear_settings_init(s);
    return sheard_settings_apply(s, text, err);
}

int sheard_settings_digest(const shear_settings *s, sheard_digest *hash, char *hex, size_t size,
                           shear_error *err) {
    char text[SHEARD_MSG_SETTINGS_SIZE];
    const int rc = sheard_settings_write(s, text, sizeof text, err);
    if (rc == SHEAR_OK) {
        hash(text, strlen(text), hex, size);
    }
    return rc;
}

/* ---- Reading ---- */

static const char *expected(const shear_setting_def *def) {
    switch (def->type) {
    case SHEAR_T_BOOL:
        return "true or false";
    case SHEAR_T_INT:
        return def->has_auto ? "a whole number or \"auto\"" : "a whole number";
    case SHEAR_T_DOUBLE:
        return !def->has_auto                                 ? "a number"
               : strcmp(shear_setting_auto(def), "auto") == 0 ? "a number or \"auto\""
                                                              : "a number or \"none\"";
    default:
        return "a string";
    }
}

static bool is_auto(const shear_setting_def *def, const json_t *value) {
    const char *text = json_string_value(value);
    return def->has_auto && text != NULL && strcmp(text, shear_setting_auto(def)) == 0 &&
           json_string_length(value) == strlen(text);
}

/* The JSON value as the text that shear_settings_set reads; false: of the wrong type. */
static bool value_text(const shear_setting_def *def, const json_t *value, char *buf, size_t size) {
    if (is_auto(def, value)) {
        snprintf(buf, size, "%s", shear_setting_auto(def));
        return true;
    }
    const bool right = def->type == SHEAR_T_BOOL     ? json_is_boolean(value)
                       : def->type == SHEAR_T_INT    ? json_is_integer(value)
                       : def->type == SHEAR_T_DOUBLE ? json_is_number(value)
                                                     : json_is_string(value);
    if (!right) {
        return false;
    }
    if (def->type == SHEAR_T_DOUBLE) {
        shear_settings s;
        shear_settings_init(&s);
        *(double *)(void *)((char *)&s + def->offset) = json_number_value(value);
        shear_settings_format(&s, def, buf, size); /* the shortest that reads back */
    } else if (def->type == SHEAR_T_INT) {
        snprintf(buf, size, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    } else if (def->type == SHEAR_T_BOOL) {
        snprintf(buf, size, "%s", json_is_true(value) ? "true" : "false");
    } else {
        snprintf(buf, size, "%s", json_string_value(value));
        return strlen(json_string_value(value)) == json_string_length(value);
    }
    return true;
}

static int read_one(msg_reader *r, shear_settings *s, const shear_setting_def *def,
                    const json_t *value) {
    char text[VALUE_SIZE];
    if (!value_text(def, value, text, sizeof text)) {
        return msg_fail(r, SHEARD_RPC_BAD_SETTING, "expected %s, not %s", expected(def),
                        msg_kind(value));
    }
    shear_error err = {0};
    return shear_settings_set(s, def->name, text, &err) == SHEAR_OK
               ? SHEARD_RPC_OK
               : msg_fail(r, SHEARD_RPC_BAD_SETTING, "%s", err.message);
}

/* One member of an object of settings. A newer service may have settings that we do not know: they
 * are passed over. */
static int read_member(msg_reader *r, shear_settings *s, bool *given, const char *name,
                       const json_t *value) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    const shear_setting_def *def = shear_settings_find(name);
    if (def == NULL && !(r->mode & MSG_STRICT)) {
        return SHEARD_RPC_OK;
    }
    const size_t mark = msg_enter(r, name);
    if (def == NULL) {
        return msg_fail(r, SHEARD_RPC_BAD_SETTING, "there is no such setting");
    }
    if (given[def - table]) {
        return msg_fail(r, SHEARD_RPC_BAD_SETTING, "is given twice ('-' and '_' are the same)");
    }
    const int rc = read_one(r, s, def, value);
    if (rc == SHEARD_RPC_OK) {
        given[def - table] = true;
        msg_leave(r, mark);
    }
    return rc;
}

/* Which settings an object gives, and their values in *s. */
static int read_given(msg_reader *r, shear_settings *s, bool *given, const json_t *object) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    json_t *o = (json_t *)object; /* jansson's iterators take no const */
    const char *preset = table[0].name;
    int rc = SHEARD_RPC_OK;
    if (json_object_get(o, preset) != NULL) { /* the others override it, wherever it stands */
        rc = read_member(r, s, given, preset, json_object_get(o, preset));
    }
    for (void *i = json_object_iter(o); i != NULL && rc == SHEARD_RPC_OK;
         i = json_object_iter_next(o, i)) {
        const char *name = json_object_iter_key(i);
        if (strcmp(name, preset) != 0) {
            rc = read_member(r, s, given, name, json_object_iter_value(i));
        }
    }
    return rc;
}

enum { MOST_SETTINGS = 64 }; /* more than the table has */

int msg_read_settings(msg_reader *r, const char **at, const json_t *value) {
    if (!json_is_object(value)) {
        return msg_fail(r, SHEARD_RPC_BAD_PARAMETER, "expected an object, not %s", msg_kind(value));
    }
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    bool given[MOST_SETTINGS] = {false};
    char text[SHEARD_MSG_SETTINGS_SIZE] = "";
    shear_settings s;
    shear_settings_init(&s);
    const int rc = n > MOST_SETTINGS ? msg_fail(r, SHEARD_RPC_INTERNAL, "has too many settings")
                                     : read_given(r, &s, given, value);
    if (rc != SHEARD_RPC_OK) {
        return rc;
    }
    for (size_t i = 0; i < n; i++) {
        if (given[i] && !add_line(text, sizeof text, &s, &table[i])) {
            return msg_fail(r, SHEARD_RPC_BAD_SETTING, "is too long");
        }
    }
    if (text[0] == '\0') {
        return SHEARD_RPC_OK;
    }
    *at = msg_copy(text, strlen(text));
    return *at != NULL ? SHEARD_RPC_OK : msg_no_memory(r);
}

/* ---- Writing ---- */

/* Copy from `all` what `text` names. False: no memory. */
static bool pick_named(json_t *object, json_t *all, const char *text) {
    char line[LINE_SIZE];
    char *value = NULL;
    while (*text != '\0' && take_line(&text, line, &value, NULL) == SHEAR_OK) {
        const char *name = shear_settings_find(line)->name;
        if (json_object_set(object, name, json_object_get(all, name)) != 0) {
            return false;
        }
    }
    return true;
}

json_t *msg_write_settings(const char *text, bool *bad) {
    shear_settings s;
    shear_settings_init(&s);
    char line[LINE_SIZE];
    char *value = NULL;
    for (const char *rest = text; *rest != '\0';) {
        if (take_line(&rest, line, &value, NULL) != SHEAR_OK ||
            shear_settings_set(&s, line, value, NULL) != SHEAR_OK) {
            *bad = true;
            return NULL;
        }
    }
    json_t *all = json_text_settings(&s);
    json_t *object = all != NULL ? json_object() : NULL;
    if (object != NULL && !pick_named(object, all, text)) {
        json_decref(object);
        object = NULL;
    }
    json_decref(all);
    return object;
}
