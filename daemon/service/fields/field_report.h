/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/field_report.h: the report of a field, made from what the store keeps of its
 * files: the same as `shearctl measure --json` prints for them. */
#pragma once

#include "shear/settings.h"
#include "shear/sums.h"
#include "store/store.h"

typedef struct service service;

/* Write the report. `counted` has the contributions whose files are listed. *text is malloc'd, the
 * caller's. */
int field_report(const service *s, const store_field *f, const shear_settings *settings,
                 const shear_result *result, const store_contribution_page *counted, char **text,
                 shear_error *err);
