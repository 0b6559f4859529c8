/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report_text.h: print the result of a job or field, which the service sends as a JSON object. */
#pragma once

#include <stdio.h>

/* Print the lines "  stamps ...", "  method ...", "  g1 ..." of a report, as shearctl measure does.
 * Prints nothing if `report` is NULL. `reason`, if not NULL, explains in more detail than the
 * report why there is no shear. */
void report_text_print(const char *report, const char *reason, FILE *out);
