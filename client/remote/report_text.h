/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_text.h: the numbers of a result (a JSON object as the service sends it) for people. */
#ifndef CLIENT_REMOTE_REPORT_TEXT_H
#define CLIENT_REMOTE_REPORT_TEXT_H

#include <stddef.h>
#include <stdio.h>

/* The lines "  stamps ...", "  method ...", "  g1 ...", as shearctl measure prints them, of a
 * report. NULL prints nothing. `reason`: why there is no shear, where more is known of that than
 * the report tells; or NULL. */
void shear_text_print(const char *report, const char *reason, FILE *out);

/* "+0.02852 +- 0.00080"; "-" where it was not measured. Returns buf. */
char *shear_text_value(double value, double error, char *buf, size_t size);

/* The name of an error method ("delta") in words. */
const char *shear_text_method(const char *error_method);

/* One line "  NAME       TEXT", unprintable bytes replaced. */
void shear_text_line(FILE *out, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
