/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/exposure.h: an exposure as a field: its chips are cut into pairs of stamps as they are
 * read.
 *
 * Catalogs, sky maps and PSF models are read when it is opened; of the pixels, one chip at a time
 * is held, in bands of rows. Stamps are numbered chip by chip, in catalog order. */
#pragma once

#include "shear/field.h"
#include "shear/input.h"

/* Open the exposure: shear_field_open_input() of such inputs. */
int exposure_open(shear_field **field, const shear_input *input, const int *fds, shear_error *err);
