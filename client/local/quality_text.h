/* SPDX-License-Identifier: GPL-3.0-or-later */
/* quality_text.h: lines on the quality of a result: the noise level, and the influence of single
 * stamps. */
#pragma once

#include "sheard/report_summary.h"

#include <stdio.h>

/* Print the lines "  level ..." and "  influence ..."; a line without known numbers is omitted. */
void quality_text_print(const sheard_report_summary *s, FILE *out);
