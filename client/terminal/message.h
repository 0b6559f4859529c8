/* SPDX-License-Identifier: GPL-3.0-or-later */
/* message.h: what shearctl says on standard error: "shearctl: error: ...", "shearctl: warning:
 * ...".
 *
 * Bytes that could steer a terminal (control characters in file and field names) are shown as '?'.
 */
#ifndef CLIENT_TERMINAL_MESSAGE_H
#define CLIENT_TERMINAL_MESSAGE_H

#include "terminal/exit_code.h"

#include "shear/error.h"

#include <stddef.h>

/* The error, and its advice, if any, on a second line. */
void message_error(const shear_error *err);
/* An error of our own. `hint` may be NULL. */
void message_fail(const char *hint, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* "out of memory". Returns EXIT_CODE_OTHER. */
enum exit_code message_no_memory(void);
void message_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* What is neither: "shearctl: note: ...". */
void message_note(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Text from outside as it goes to the terminal (shear/text.h), into buf[size]; only ASCII where the
 * locale is not of UTF-8. Whatever prints a name, a path or a message goes through here. Returns
 * buf. */
char *message_clean(const char *text, char *buf, size_t size);

#endif
