/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sheard/account.h: the account of one counted file as a JSON text: enough to write the file's part
 * of a report (sheard/report.h) again when its job and catalog are gone. */
#ifndef SHEARD_ACCOUNT_H
#define SHEARD_ACCOUNT_H

#include "sheard/report.h"

/* Write the file's entry in a report, with the shape of its stamps. *text is from malloc. Return
 * SHEAR_OK or SHEAR_E_NOMEM. */
int sheard_account_format(char **text, const sheard_report_file *file, shear_error *err);

typedef struct sheard_account {
    sheard_report_file file; /* file.plan is &plan, or NULL if unknown */
    shear_plan_info plan;    /* only the members that a report and its warnings use */
    void *texts;
} sheard_account;
/* Parse an account. Plain report entries, which older versions stored, are also accepted: their
 * shape is unknown (0 x 0). Return SHEAR_OK, SHEAR_E_FORMAT or SHEAR_E_NOMEM; on an error *account
 * is empty. */
int sheard_account_parse(sheard_account *account, const char *text, shear_error *err);
void sheard_account_deinit(sheard_account *account); /* a zeroed struct is accepted */

#endif
