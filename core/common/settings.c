/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Set and format settings by name and as text. */
#include "shear/settings.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void *member(shear_settings *s, const shear_setting_def *def) {
    return (char *)s + def->offset;
}

/* Set all settings to a preset's values. */
static void apply_preset(shear_settings *s, enum shear_preset preset) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    memset(s, 0, sizeof *s);
    for (size_t i = 0; i < n; i++) {
        const double value = table[i].by_preset[preset];
        void *at = member(s, &table[i]);
        switch (table[i].type) {
        case SHEAR_T_BOOL:
            *(bool *)at = value != 0.0;
            break;
        case SHEAR_T_DOUBLE:
            *(double *)at = value;
            break;
        default:
            *(int *)at = (int)value;
            break;
        }
    }
}

void shear_settings_init(shear_settings *s) {
    apply_preset(s, SHEAR_PRESET_DEFAULT);
}

static int set_choice(int *value, const shear_setting_def *def, const char *text,
                      shear_error *err) {
    for (int i = 0; def->choices[i] != NULL; i++) {
        if (spelling_same(def->choices[i], text)) {
            *value = i;
            return SHEAR_OK;
        }
    }
    char known[200];
    text_list(known, sizeof known, def->choices);
    return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s': '%s' is not one of: %s", def->name,
                      text, known);
}

static int set_bool(bool *value, const shear_setting_def *def, const char *text, shear_error *err) {
    static const char *const words[] = {"false", "true", "no", "yes", "off", "on", "0", "1"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(words[i], text) == 0) {
            *value = i % 2 == 1;
            return SHEAR_OK;
        }
    }
    return shear_fail(err, SHEAR_E_SETTING, NULL, "setting '%s': '%s' is neither true nor false",
                      def->name, text);
}

static int out_of_range(const shear_setting_def *def, const char *text, shear_error *err) {
    return shear_fail(err, SHEAR_E_SETTING, NULL,
                      "setting '%s': '%s' is not %s from %g to %g%s%s%s%s", def->name, text,
                      def->type == SHEAR_T_INT ? "a whole number" : "a number", def->min, def->max,
                      def->unit[0] != '\0' ? " " : "", def->unit, def->has_auto ? ", or " : "",
                      def->has_auto ? shear_setting_auto(def) : "");
}

static int set_int(int *value, const shear_setting_def *def, const char *text, shear_error *err) {
    int64_t parsed = 0;
    if (def->has_auto && strcmp(text, shear_setting_auto(def)) == 0) {
        *value = 0;
        return SHEAR_OK;
    }
    if (!text_to_int64(text, &parsed) || (double)parsed < def->min || (double)parsed > def->max)
        return out_of_range(def, text, err);
    *value = (int)parsed;
    return SHEAR_OK;
}

static int set_double(double *value, const shear_setting_def *def, const char *text,
                      shear_error *err) {
    double parsed = NAN;
    if (def->has_auto && strcmp(text, shear_setting_auto(def)) == 0) {
        *value = NAN;
        return SHEAR_OK;
    }
    if (!text_to_double(text, &parsed) || !(parsed >= def->min) || !(parsed <= def->max))
        return out_of_range(def, text, err);
    *value = parsed;
    return SHEAR_OK;
}

static int set_preset(shear_settings *s, const shear_setting_def *def, const char *text,
                      shear_error *err) {
    int preset = SHEAR_PRESET_DEFAULT;
    TRY(set_choice(&preset, def, text, err));
    apply_preset(s, (enum shear_preset)preset);
    return SHEAR_OK;
}

static bool is_preset(const shear_setting_def *def) {
    return def->offset == offsetof(shear_settings, preset);
}

int shear_settings_set(shear_settings *s, const char *name, const char *text, shear_error *err) {
    const shear_setting_def *def = shear_settings_find(name);
    if (def == NULL) {
        return shear_fail(err, SHEAR_E_SETTING, "the settings are listed in shearctl(1)",
                          "there is no setting '%s'", name);
    }
    switch (def->type) {
    case SHEAR_T_CHOICE:
        return is_preset(def) ? set_preset(s, def, text, err)
                              : set_choice(member(s, def), def, text, err);
    case SHEAR_T_BOOL:
        return set_bool(member(s, def), def, text, err);
    case SHEAR_T_INT:
        return set_int(member(s, def), def, text, err);
    default:
        return set_double(member(s, def), def, text, err);
    }
}

static size_t size_of(const shear_setting_def *def) {
    return def->type == SHEAR_T_BOOL     ? sizeof(bool)
           : def->type == SHEAR_T_DOUBLE ? sizeof(double)
                                         : sizeof(int);
}

/* Copy the settings that have been given from `from` to *s. */
static void keep_given(shear_settings *s, const shear_settings *from, const bool *given) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n; i++) {
        if (given[i] && !is_preset(&table[i]))
            memcpy(member(s, &table[i]), (const char *)from + table[i].offset, size_of(&table[i]));
    }
}

int shear_settings_give(shear_settings *s, bool *given, const char *name, const char *text,
                        shear_error *err) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    const shear_settings before = *s;
    const int code = shear_settings_set(s, name, text, err);
    const shear_setting_def *def = shear_settings_find(name);
    if (code != SHEAR_OK)
        return code;
    if (is_preset(def))
        keep_given(s, &before, given);
    given[def - table] = true;
    return SHEAR_OK;
}

char *shear_settings_format(const shear_settings *s, const shear_setting_def *def, char *buf,
                            size_t size) {
    const void *value = (const char *)s + def->offset;
    switch (def->type) {
    case SHEAR_T_CHOICE:
        text_set(buf, size, def->choices[*(const int *)value]);
        break;
    case SHEAR_T_BOOL:
        text_set(buf, size, *(const bool *)value ? "true" : "false");
        break;
    case SHEAR_T_INT:
        snprintf(buf, size, "%d", *(const int *)value);
        if (def->has_auto && *(const int *)value == 0)
            text_set(buf, size, shear_setting_auto(def));
        break;
    default: {
        const double number = *(const double *)value;
        snprintf(buf, size, "%.*g", text_digits(number, 1), number);
        if (isnan(number))
            text_set(buf, size, shear_setting_auto(def));
        break;
    }
    }
    return buf;
}
