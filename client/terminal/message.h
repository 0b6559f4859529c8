/* SPDX-License-Identifier: GPL-3.0-or-later */
/* message.h: messages of shearctl on standard error: "shearctl: error: ...", "shearctl: warning:
 * ...".
 *
 * Control characters in file and field names, which could steer a terminal, are shown as '?'. */
#pragma once

#include "terminal/exit_code.h"

#include "shear/error.h"

#include <stddef.h>

/* Print the error, and its advice, if any, on a second line. Returns the exit code for an error in
 * reading an input. */
enum exit_code message_error(const shear_error *err);
/* Print an error of shearctl itself, and an advice unless it is NULL or "". Returns `code`. */
enum exit_code message_fail(enum exit_code code, const char *advice, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Print "out of memory". Returns EXIT_CODE_OTHER. */
enum exit_code message_no_memory(void);

/* Print "shearctl: KIND: ...". */
void message_say(const char *kind, const char *format, ...) __attribute__((format(printf, 2, 3)));
#define message_warning(...) message_say("warning", __VA_ARGS__)
#define message_note(...)    message_say("note", __VA_ARGS__)

/* Copy text from outside into buf[size] for output on a terminal (shear/text.h), in ASCII only if
 * the locale is not UTF-8. Use it for every name, path and message that is printed. Returns buf. */
char *message_clean(const char *text, char *buf, size_t size);
