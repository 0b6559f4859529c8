/* SPDX-License-Identifier: GPL-3.0-or-later */
/* conf_text.h: extraction of one value from the output of `sheard --print-config`. */
#pragma once

/* Return the value of `key` in `section`, with continuation lines joined by a space; malloc'd, to
 * be freed by the caller. NULL if the key is missing, or if out of memory. */
char *conf_text_value(const char *text, const char *section, const char *key);
