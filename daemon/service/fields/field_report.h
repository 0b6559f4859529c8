/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/field_report.h: the report of a field, from what the store keeps of its files: the
 * same that `shearctl measure --json` prints of them. */
#ifndef SHEARD_SERVICE_FIELD_REPORT_H
#define SHEARD_SERVICE_FIELD_REPORT_H

#include "shear/settings.h"
#include "shear/sums.h"
#include "store/store.h"

typedef struct service service;

/* `counted`: the contributions whose files are listed. *text is malloc'd. */
int field_report(const service *s, const store_field *f, const shear_settings *settings,
                 const shear_result *result, const store_contribution_page *counted, char **text,
                 shear_error *err);

#endif
