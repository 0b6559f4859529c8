/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/models.h: PSF models in a field file: the table PSF_MODELS, and its writer.
 *
 * HDU PSF_MODELS has a row per model: STEP, AXES, LANCZOS, NX, NY (shear_psf_model). Model m's term
 * t is plane m terms + t of HDU PSF, of whose lower left corner it has NX x NY samples. */
#pragma once

#include "fits/field/internal.h"

#include <fitsio.h>

/* Read the models, if the PSF's file has the table; otherwise leave info.n_models 0. The catalog
 * and the PSF's HDU must be open. SHEAR_E_FORMAT, SHEAR_E_NOMEM. */
int field_models_read(field_file *f, shear_error *err);

/* Create and fill the table in a file that is being written. As in CFITSIO's own calls, nothing
 * happens if *status is not 0. */
void field_models_create(fitsfile *f, const shear_psf_model *models, int n, int *status);
