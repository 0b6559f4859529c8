/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/account.h: what is kept of one file that was counted, as a JSON text: enough to write its
 * part of a report (sheard/report.h) again when nothing else is left of it. */
#ifndef SHEARD_ACCOUNT_H
#define SHEARD_ACCOUNT_H

#include "sheard/report.h"

/* The file's entry in a report, with the shape of its stamps. *text is malloc'd. SHEAR_E_NOMEM. */
int shear_account_format(char **text, const shear_report_file *file, shear_error *err);

typedef struct shear_account {
    shear_report_file file; /* file.plan is &plan, or NULL where it is not known */
    shear_plan_info plan;   /* the members that a report and its warnings need */
    void *texts;
} shear_account;
/* Entries of a report alone (of older versions) are read, too: then the shape is not known (0 x 0).
 * SHEAR_E_FORMAT, SHEAR_E_NOMEM; *account is empty then. */
int shear_account_parse(shear_account *account, const char *text, shear_error *err);
void shear_account_deinit(shear_account *account); /* zeroed: fine */

#endif
