/* SPDX-License-Identifier: GPL-3.0-or-later */
/* value_text.h: values of a result as text, and lines common to local results and reports of the
 * service. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Write "+0.02852 +- 0.00080" into buf: the error with two digits, the value with the same
 * decimals; "-" if the value is not finite. Returns buf. */
char *value_text(double value, double error, char *buf, size_t size);
/* Return the number of decimals that show two digits of the error. */
int value_text_decimals(double error);

/* Write "2.4 px", or "2.4 to 2.6 px" if files differ, into buf. Returns buf. */
char *value_text_length(double from, double to, char *buf, size_t size);

/* Return a description of an error method, given its name ("delta"). */
const char *value_text_error_method(const char *name);

/* Print "400 of 403 used (2 galaxy_not_finite, 1 masked)"; a stamp may have several flags.
 * `flagged` is [SHEAR_N_FLAGS]. */
void value_text_print_stamps(int64_t n_used, int64_t n_stamps, const int64_t *flagged, FILE *out);
