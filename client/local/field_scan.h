/* SPDX-License-Identifier: GPL-3.0-or-later */
/* field_scan.h: look at every stamp of a field file: which is flagged, and why; and what they are
 * measured to, all together. */
#ifndef CLIENT_LOCAL_FIELD_SCAN_H
#define CLIENT_LOCAL_FIELD_SCAN_H

#include "sheard/validation_report.h"
#include "terminal/progress.h"

/* Fill in scanned, n_measurable, flags, negative, lowest_pixel, the noise's members, measured and
 * result of *v for the file that `plan` was made for. Nothing is measured if a log method meets
 * negative pixels. Memory is bounded by a block of stamps. */
int field_scan(shear_field *field, const shear_plan *plan, progress *bar,
               sheard_validation_report *v, shear_error *err);

#endif
