/* SPDX-License-Identifier: GPL-3.0-or-later */
/* validation_text.h: print the report of `shearctl validate` as text. */
#pragma once

#include "sheard/validation_report.h"

#include <stdio.h>

/* Print the report. */
void validation_text_print(const sheard_validation_report *v, FILE *out);
