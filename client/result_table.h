/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result_table.h: a field's result for people. */
#ifndef CLIENT_RESULT_TABLE_H
#define CLIENT_RESULT_TABLE_H

#include "measure_group.h"

#include <stdio.h>

void result_table_print(const struct measure_group *group, FILE *out);

/* "0.02852 +- 0.00080": the error with two digits, the value with as many decimals. In buf;
 * returned. */
char *result_table_value(double value, double error, char *buf, size_t size);

/* The line "method": what the settings were resolved to. The radii are given as text ("1.6 px"). */
void result_table_method(const shear_plan_info *plan, const char *r_psf, const char *beta,
                         FILE *out);

#endif
