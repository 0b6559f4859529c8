/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/positions.h: a sample of an exposure's stamps: are the galaxies where their positions are? */
#pragma once

#include "shear/centring.h"
#include "shear/work.h"

/* Return whether the stamps were cut at the positions in X and Y: an exposure, or a field file that
 * was extracted from one. */
bool positions_known(const shear_field_info *info);
/* Look at the first galaxies of the field that are not dropped, at most 64 of 512 stamps, so that
 * only the first chips need to be read. Stamps are read from slot 0, at most `capacity` at a time.
 */
int positions_check(shear_centring *c, const shear_field_info *info, shear_source source,
                    int capacity, shear_error *err);
