/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/account.h: what is kept of one file that was counted, as a JSON text: enough to write its
 * part of a report (sheard/report.h) again when nothing else is left of it. */
#ifndef SHEARD_ACCOUNT_H
#define SHEARD_ACCOUNT_H

#include "sheard/report.h"

/* The file's entry in a report, with the shape of its stamps. *text is malloc'd. SHEAR_E_NOMEM. */
int sheard_account_format(char **text, const sheard_report_file *file, shear_error *err);

typedef struct sheard_account {
    sheard_report_file file; /* file.plan is &plan, or NULL if it is not known */
    shear_plan_info plan;    /* the members that a report and its warnings need */
    void *texts;
} sheard_account;
/* Entries of a report alone (of older versions) are read, too: then the shape is not known (0 x 0).
 * SHEAR_E_FORMAT, SHEAR_E_NOMEM; *account is empty then. */
int sheard_account_parse(sheard_account *account, const char *text, shear_error *err);
void sheard_account_deinit(sheard_account *account); /* zeroed: fine */

#endif
