/* SPDX-License-Identifier: GPL-3.0-or-later */
/* value_text.h: values of a result as text. */
#pragma once

#include <stddef.h>

/* Write "+0.02852 +- 0.00080" into buf: the error with two digits, the value with the same
 * decimals; "-" if the value is not finite. Returns buf. */
char *value_text(double value, double error, char *buf, size_t size);
/* Return the number of decimals that show two digits of the error. */
int value_text_decimals(double error);
