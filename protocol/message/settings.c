/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convert between canonical settings and JSON objects of native types. */
#include "json/settings.h"

#include "base/cleanup.h"

#include "message/reader.h"
#include "message/settings_text.h"
#include "json/text.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { MOST_SETTINGS = 64 }; /* more than the table has */

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

static void write_double(const shear_setting_def *def, double value, char *buf, size_t size) {
    shear_settings s;
    shear_settings_init(&s);
    *(double *)(void *)((char *)&s + def->offset) = value;
    shear_settings_format(&s, def, buf, size); /* shortest text of the same value */
}

/* Convert the JSON value to text for shear_settings_set. Return false if it has the wrong type. */
static bool value_text(const shear_setting_def *def, const json_t *value, char *buf, size_t size) {
    if (is_auto(def, value)) {
        snprintf(buf, size, "%s", shear_setting_auto(def));
        return true;
    }
    switch (def->type) {
    case SHEAR_T_BOOL:
        snprintf(buf, size, "%s", json_is_true(value) ? "true" : "false");
        return json_is_boolean(value);
    case SHEAR_T_INT:
        snprintf(buf, size, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        return json_is_integer(value);
    case SHEAR_T_DOUBLE:
        write_double(def, json_number_value(value), buf, size);
        return json_is_number(value);
    default:
        snprintf(buf, size, "%s", json_is_string(value) ? json_string_value(value) : "");
        return json_is_string(value) &&
               strlen(json_string_value(value)) == json_string_length(value);
    }
}

/* The settings of an object being read. */
typedef struct given_settings {
    shear_settings values;
    bool given[MOST_SETTINGS]; /* by index in the table */
} given_settings;

/* Read a setting. Unknown settings of a newer service are ignored. */
static int read_setting(msg_reader *r, given_settings *g, const char *name, const json_t *value) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    const shear_setting_def *def = shear_settings_find(name);
    char text[SETTINGS_TEXT_VALUE];
    shear_error err = {0};
    if (def == NULL && !reader_is_strict(r))
        return SHEARD_RPC_OK;
    const size_t mark = reader_enter(r, name);
    if (def == NULL)
        return reader_fail(r, SHEARD_RPC_BAD_SETTING, "there is no such setting");
    if (g->given[def - table])
        return reader_fail(r, SHEARD_RPC_BAD_SETTING, "is given twice ('-' and '_' are the same)");
    if (!value_text(def, value, text, sizeof text)) {
        return reader_fail(r, SHEARD_RPC_BAD_SETTING, "expected %s, not %s", expected(def),
                           json_text_kind(value));
    }
    if (shear_settings_give(&g->values, g->given, name, text, &err) != SHEAR_OK)
        return reader_fail(r, SHEARD_RPC_BAD_SETTING, "%s", err.message);
    reader_leave(r, mark);
    return SHEARD_RPC_OK;
}

static int read_settings(msg_reader *r, given_settings *g, const json_t *object) {
    json_t *o = (json_t *)object; /* jansson's iterators are not const */
    for (void *i = json_object_iter(o); i != NULL; i = json_object_iter_next(o, i))
        TRY(read_setting(r, g, json_object_iter_key(i), json_object_iter_value(i)));
    return SHEARD_RPC_OK;
}

int reader_settings(msg_reader *r, const char **at, const json_t *value) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    given_settings g = {.given = {false}};
    char text[SHEARD_MSG_SETTINGS_SIZE] = "";
    if (!json_is_object(value))
        return reader_wrong_type(r, "an object", value);
    assert(n <= MOST_SETTINGS);
    shear_settings_init(&g.values);
    TRY(read_settings(r, &g, value));
    for (size_t i = 0; i < n; i++) {
        if (g.given[i] && !settings_text_add(text, sizeof text, &g.values, &table[i]))
            return reader_fail(r, SHEARD_RPC_BAD_SETTING, "is too long");
    }
    return text[0] != '\0' ? reader_copy(r, at, text, strlen(text)) : SHEARD_RPC_OK;
}

/* ---- Writing ---- */

/* Copy the settings named in `text` from `all`. Return false if out of memory. */
static bool pick_named(json_t *object, json_t *all, const char *text) {
    char line[SETTINGS_TEXT_LINE];
    char *value = NULL;
    while (*text != '\0' && settings_text_next(&text, line, &value, NULL) == SHEAR_OK) {
        const char *name = shear_settings_find(line)->name;
        if (json_object_set(object, name, json_object_get(all, name)) != 0)
            return false;
    }
    return true;
}

json_t *msg_write_settings(const char *text, bool *bad) {
    shear_settings s;
    shear_settings_init(&s);
    *bad = settings_text_set(&s, text, NULL) != SHEAR_OK;
    json_auto_t *all = *bad ? NULL : json_settings(&s);
    json_t *object = all != NULL ? json_object() : NULL;
    if (object != NULL && !pick_named(object, all, text)) {
        json_decref(object);
        object = NULL;
    }
    return object;
}
