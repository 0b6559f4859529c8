/* SPDX-License-Identifier: GPL-3.0-or-later */
/* field_scan.h: examine and measure every stamp of a field file: flags, noise, and the shear of all
 * stamps together. */
#pragma once

#include "local/chip_scan.h"
#include "sheard/validation_report.h"
#include "terminal/progress.h"

/* Fill the members scanned, n_measurable, flags, negative, lowest_pixel, noise_*, measured and
 * result of *v, for the file of `plan`. Nothing is measured if a log method meets negative pixels.
 * Uses memory for one block of stamps. `chips` gets what is found on the chips of an exposure. */
int field_scan(shear_field *field, const shear_plan *plan, chip_scan *chips, progress *bar,
               sheard_validation_report *v, shear_error *err);
