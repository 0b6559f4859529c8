/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result_text.h: print a field's result as text. */
#pragma once

#include "local/measure_group.h"

#include <stdio.h>

/* Print the result of a measured group, whose report is the JSON object `report`. */
void result_text_print(const measure_group *group, const char *report, FILE *out);
