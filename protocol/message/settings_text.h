/* SPDX-License-Identifier: GPL-3.0-or-later */
/* message/settings_text.h: write and read the lines of canonical settings (sheard/messages.h), and
 * make their digest. */
#pragma once

#include "shear/settings.h"

#include <stdbool.h>

enum {
    SETTINGS_TEXT_VALUE = 64, /* bytes of a value */
    SETTINGS_TEXT_LINE = 160  /* bytes of a line */
};

/* Append "NAME=VALUE\n" to buf[size]. Return false if it does not fit. */
bool settings_text_add(char *buf, size_t size, const shear_settings *s,
                       const shear_setting_def *def);

/* Read the next line of *text, which is advanced: its name into `line`, its value into *value. */
int settings_text_next(const char **text, char line[SETTINGS_TEXT_LINE], char **value,
                       shear_error *err);

/* Set in *s what `text` gives, without a check of the whole. */
int settings_text_set(shear_settings *s, const char *text, shear_error *err);
