/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report_text.h: the numbers of a result (a JSON object as the service sends it) for people. */
#ifndef CLIENT_REMOTE_REPORT_TEXT_H
#define CLIENT_REMOTE_REPORT_TEXT_H

#include <stdio.h>

/* The lines "  stamps ...", "  method ...", "  g1 ...", as shearctl measure prints them, of a
 * report. NULL prints nothing. `reason`: why there is no shear, if more is known of that than
 * the report tells; or NULL. */
void report_text_print(const char *report, const char *reason, FILE *out);

#endif
