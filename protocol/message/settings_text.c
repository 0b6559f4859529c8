/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "message/settings_text.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "sheard/messages.h"

#include <string.h>

/* Replace -0 by 0: they are equal, and must have equal text. */
static void drop_sign_of_zero(shear_settings *s, const shear_setting_def *def) {
    double *value = (void *)((char *)s + def->offset);
    if (def->type == SHEAR_T_DOUBLE && *value == 0.0)
        *value = 0.0;
}

bool settings_text_add(char *buf, size_t size, const shear_settings *s,
                       const shear_setting_def *def) {
    char value[SETTINGS_TEXT_VALUE];
    shear_settings clean = *s;
    drop_sign_of_zero(&clean, def);
    shear_settings_format(&clean, def, value, sizeof value);
    return text_append(buf, size, "%s=%s\n", def->name, value);
}

int settings_text_next(const char **text, char line[SETTINGS_TEXT_LINE], char **value,
                       shear_error *err) {
    const size_t n = strcspn(*text, "\n");
    if (n >= SETTINGS_TEXT_LINE)
        return shear_fail(err, SHEAR_E_SETTING, NULL, "settings have a line of %zu bytes", n);
    memcpy(line, *text, n);
    line[n] = '\0';
    *text += n + ((*text)[n] == '\n');
    *value = strchr(line, '=');
    if (*value == NULL)
        return shear_fail(err, SHEAR_E_SETTING, NULL, "settings: '%s' is not NAME=VALUE", line);
    *(*value)++ = '\0';
    return SHEAR_OK;
}

int settings_text_set(shear_settings *s, const char *text, shear_error *err) {
    char line[SETTINGS_TEXT_LINE];
    char *value = NULL;
    while (text != NULL && *text != '\0') {
        TRY(settings_text_next(&text, line, &value, err));
        TRY(shear_settings_set(s, line, value, err));
    }
    return SHEAR_OK;
}

int sheard_settings_write(const shear_settings *s, char *buf, size_t size, shear_error *err) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    bool fits = size > 0 && text_set(buf, size, "");
    for (size_t i = 0; fits && i < n; i++)
        fits = settings_text_add(buf, size, s, &table[i]);
    return fits ? SHEAR_OK
                : shear_fail(err, SHEAR_E_SETTING, NULL, "settings do not fit %zu bytes", size);
}

int sheard_settings_apply(shear_settings *s, const char *text, shear_error *err) {
    TRY(settings_text_set(s, text, err));
    return shear_settings_check(s, err);
}

/* Read settings of version 0.1, in which `auto` had another meaning. */
static int read_old(shear_settings *s, const char *text, shear_error *err) {
    static const char beneath[] = "preset=zhang2010\n";
    shear_settings_init(s);
    TRY(settings_text_set(s, beneath, err));
    TRY(sheard_settings_apply(s, text, err));
    if (s->interpolation == SHEAR_INTERP_AUTO)
        s->interpolation = SHEAR_INTERP_PAPER;
    if (s->filter == SHEAR_FILTER_AUTO)
        s->filter = SHEAR_FILTER_R_GAL;
    return SHEAR_OK;
}

int sheard_settings_read(shear_settings *s, const char *text, shear_error *err) {
    static const char first[] = "preset=";
    if (strncmp(text, first, sizeof first - 1) != 0)
        return read_old(s, text, err);
    shear_settings_init(s);
    return sheard_settings_apply(s, text, err);
}

int sheard_settings_digest(const shear_settings *s, sheard_digest *hash, char *hex, size_t size,
                           shear_error *err) {
    char text[SHEARD_MSG_SETTINGS_SIZE];
    TRY(sheard_settings_write(s, text, sizeof text, err));
    hash(text, strlen(text), hex, size);
    return SHEAR_OK;
}
