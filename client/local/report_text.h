/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report_text.h: print the result of a field from its report (sheard/report.h), be it measured here
 * or by the service. */
#pragma once

#include "sheard/report_summary.h"

#include <stdbool.h>
#include <stdio.h>

/* Print the lines "  stamps ...", "  method ...", "  g1 ..." of a report, a JSON object. Prints
 * nothing if `report` is NULL. `reason`, if not NULL, explains in more detail than the report why
 * there is no shear. `own`: the field was measured here; a true shear has as many decimals as the
 * measured one, and warnings are left out, because they go to standard error. */
void report_text_print(const char *report, const char *reason, bool own, FILE *out);

/* Parts of it: print the lines "  method ...", "  filter ...", "  background ..." and
 * "  artefacts ...". `artefacts` is the number of stamps left out because of an artefact; -1:
 * unknown, or already printed. */
void report_text_method(const sheard_report_summary *s, int64_t artefacts, FILE *out);
/* Print the lines "  level ..." and "  influence ..."; a line without known numbers is omitted. */
void report_text_quality(const sheard_report_summary *s, FILE *out);
