/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/psf_models.h: the PSF models of an exposure, from PSFEx, Piff, cubes of images or
 * stamps of stars, as models that are linear in numbers of each galaxy (shear_psf_model).
 *
 * PSFEx and Piff give samples. So does a cube of at most 64 images, of which the nearest is used;
 * a larger one, and stars, give |W|^2 (SHEAR_PSF_AXES_MODES). Models may differ in the size of
 * their planes and in step. */
#pragma once

#include "shear/error.h"
#include "shear/input.h"
#include "shear/psf.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct psf_models psf_models;

/* Open the file at part->path, or the descriptor fd if it is not negative. `stamp` is the side of
 * the galaxy stamps, 8 or more: its modes are those of SHEAR_PSF_AXES_MODES. SHEAR_E_IO,
 * SHEAR_E_FORMAT; SHEAR_E_PSF: all models have failed (no accepted star, no flux), or a kind of PSF
 * that is not read: the advice says what to do instead. If only some chips have failed, their text
 * says so, their planes are those of a sound one, and their galaxies have no coefficients. *p is
 * NULL on error. */
int psf_models_open(psf_models **p, const shear_input_part *part, int fd, enum shear_psf_kind kind,
                    int stamp, shear_error *err);
void psf_models_close(psf_models *p);

/* Return the number of the HDU that was chosen for them; -1: none was. */
int64_t psf_models_hdu(const psf_models *p);
/* Return the number of models, one per chip, or one for all. */
int psf_models_count(const psf_models *p);
/* Return EXTNAME of the chip of model `i`; "" if unknown. */
const char *psf_models_chip(const psf_models *p, int i);
/* Return the model; it is the file's. All models have the same number of terms (padded with zeros).
 */
const shear_psf_model *psf_models_get(const psf_models *p, int i);
/* Return a line that describes the model, such as "PSFEx, 45 x 45 samples of 0.50 px, degree 2 in
 * X_IMAGE, Y_IMAGE, 51 of 60 stars, chi2/dof 1.05". */
const char *psf_models_text(const psf_models *p, int i);
/* Return the number of stars that the model was made from; 0: unknown. */
int psf_models_stars(const psf_models *p, int i);

/* Names of the numbers of a galaxy that model `i` depends on beside its position: catalog columns
 * (MAG_AUTO), or keywords of the image's header (":AIRMASS"). */
int psf_models_contexts(const psf_models *p, int i, const char *const **names);
/* A galaxy, as models need it. */
typedef struct psf_place {
    double x, y;           /* pixels, the first is (1, 1) */
    double ra, dec;        /* degrees; NaN: unknown */
    const double *context; /* [psf_models_contexts()] */
} psf_place;
/* Compute the coefficients c[terms] of a galaxy. Return false if they are not finite, or the place
 * is so far from the stars that the polynomial means nothing: farther from their middle than their
 * whole range; of other variables, and of the nearest image, 3 ranges. */
bool psf_models_terms(const psf_models *p, int i, const psf_place *place, double *c);
