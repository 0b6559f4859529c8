/* SPDX-License-Identifier: GPL-3.0-or-later */
/* field_scan.h: look at every stamp of a field file without measuring it: which would be flagged,
 * and why. */
#ifndef CLIENT_FIELD_SCAN_H
#define CLIENT_FIELD_SCAN_H

#include "progress.h"
#include "sheard/report.h"

/* Fill in scanned, n_measurable, flags, negative, lowest_pixel and the noise's members of *v for
 * the file that `plan` was made for. Where stamps bring their own PSFs, only measuring tells
 * whether these serve: then the stamps are measured. Memory is bounded by a block of stamps. */
int field_scan(shear_field *field, const shear_plan *plan, struct progress *progress,
               shear_verdict *v, shear_error *err);

#endif
