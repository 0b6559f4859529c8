/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result_table.h: a field's result for people. */
#ifndef CLIENT_LOCAL_RESULT_TEXT_H
#define CLIENT_LOCAL_RESULT_TEXT_H

#include "local/measure_group.h"

#include <stdio.h>

void result_text_print(const measure_group *group, const shear_settings *settings, FILE *out);

/* "0.02852 +- 0.00080": the error with two digits, the value with as many decimals. In buf;
 * returned. */
char *value_text(double value, double error, char *buf, size_t size);

#endif
