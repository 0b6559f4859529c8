/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/piff_grid.h: the planes of a PixelGrid of Piff. */
#pragma once

#include "survey/psf/internal.h"
#include "survey/psf/record.h"

/* Read the planes from the tables `model` (scale, size, interp) and `solution` (q), for the
 * polynomial c->terms. `advice` is for interpolants that are not read. SHEAR_E_FORMAT,
 * SHEAR_E_PSF, SHEAR_E_NOMEM. */
int piff_grid_read(psf_chip *c, const psf_record *model, const psf_record *solution,
                   const char *advice, shear_error *err);
