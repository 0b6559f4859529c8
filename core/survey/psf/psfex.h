/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/psfex.h: read the models that PSFEx writes.
 *
 * A model is a row of a table with a column PSF_MASK: the coefficients of a polynomial for every
 * sample. Its parameters are keywords of an HDU PSF_DATA for each chip, or columns of a table with
 * a row per chip (Legacy Survey). */
#pragma once

#include "survey/psf/internal.h"

/* Append the models of the file; there may be none. */
int psfex_read(psf_models *p, shear_error *err);
