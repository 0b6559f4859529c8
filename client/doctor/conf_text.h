/* SPDX-License-Identifier: GPL-3.0-or-later */
/* conf_text.h: a value of what `sheard --print-config` prints. Pure. */
#ifndef CLIENT_DOCTOR_CONF_TEXT_H
#define CLIENT_DOCTOR_CONF_TEXT_H

/* The value of `key` in `section`, its continued lines joined with a space; malloc'd, the caller's.
 * NULL: not there, or no memory. */
char *conf_text_value(const char *text, const char *section, const char *key);

#endif
