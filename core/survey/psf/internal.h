/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/internal.h: the models of a file while they are read, kind by kind. */
#pragma once

#include "fits/header/file.h"
#include "survey/psf/polynomial.h"
#include "survey/psf/psf_models.h"

#include <stddef.h>

enum {
    PSF_TEXT = 480,
    PSF_SIDE = 1024, /* most samples along an axis */
    PSF_CHIPS = 1024 /* most models of a file */
};

/* What a variable of the polynomial is. */
enum psf_quantity {
    PSF_QUANTITY_X,      /* pixel */
    PSF_QUANTITY_Y,      /* pixel */
    PSF_QUANTITY_U,      /* arcsec to the West in the tangent plane at (ra0, dec0) */
    PSF_QUANTITY_V,      /* arcsec to the North */
    PSF_QUANTITY_CONTEXT /* a number of the galaxy */
};

/* A variable of the polynomial: (quantity - zero) / scale. The stars covered middle +- width / 2.
 */
typedef struct psf_variable {
    enum psf_quantity quantity;
    char name[SF_NAME]; /* as the PSF program calls it */
    double zero, scale;
    double middle, width;
} psf_variable;

/* The model of one chip. */
typedef struct psf_chip {
    char name[SF_NAME]; /* EXTNAME of the chip, or "" */
    char text[PSF_TEXT];
    int stars;   /* that it was made from; 0: unknown */
    bool failed; /* the fit has failed: no galaxy has coefficients */
    shear_psf_model model;
    double *samples; /* the model's; owned */
    polynomial terms;
    psf_variable variables[POLYNOMIAL_VARIABLES];
    double ra0, dec0; /* degrees */
    int planes;       /* of which the nearest is used */
    double *places; /* [planes][2] of the planes, in the two variables: the nearest is used; owned.
                       NULL: the polynomial is used */
    const char *contexts[POLYNOMIAL_VARIABLES]; /* [n_contexts] names of those variables */
    int n_contexts;
} psf_chip;

struct psf_models {
    psf_chip *chips; /* [capacity], n in use */
    int n;
    size_t capacity;
    int stamp; /* side of the galaxy stamps */
    sf_file file;
    const sf_hdu *chosen; /* the only HDU that may hold models; NULL: all */
};

/* Append a chip, all zeros, valid until the next one is appended. *chip is NULL on error.
 * SHEAR_E_FORMAT: there are more than PSF_CHIPS; SHEAR_E_NOMEM. */
int psf_chip_new(psf_models *p, psf_chip **chip, shear_error *err);

/* Set the variable that a PSF program calls `name`: pixel coordinates (X_IMAGE, XWIN_IMAGE, x,
 * ...), u and v, or else a context. */
void psf_chip_set_variable(psf_chip *c, int variable, const char *name);

/* Compute u (West) and v (North), arcsec, in the tangent plane at (c->ra0, c->dec0); NaN beyond 90
 * degrees. */
void psf_chip_tangent(const psf_chip *c, double ra, double dec, double *u, double *v);

/* Return why the samples cannot be used, or NULL: not finite, or without flux in the middle of the
 * range of the variables. */
const char *psf_chip_failure(const psf_chip *c);

/* Append to the text: ", degree 2 in X_IMAGE, Y_IMAGE", or ", constant". */
void psf_chip_describe(psf_chip *c);
