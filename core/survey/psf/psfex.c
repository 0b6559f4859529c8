/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/psfex.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "survey/psf/record.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

/* A model whose chi-square per degree of freedom is larger does not describe its stars. */
static const double worst_chi2 = 100.0;

static const char *key(char out[SF_INDEXED], const char *root, int i) {
    return sf_card_indexed(out, root, i + 1);
}

/* ---- the polynomial ---- */

/* Return the number of variables: POLNAXIS, or the POLNAMEn there are (some tables lack POLNAXIS).
 */
static int read_variables(const psf_record *r, int *n, shear_error *err) {
    char k[SF_INDEXED];
    char name[SF_NAME];
    *n = -1;
    TRY(psf_record_int(r, "POLNAXIS", 0, POLYNOMIAL_VARIABLES, n, err));
    if (*n >= 0)
        return SHEAR_OK;
    for (*n = 0; *n < POLYNOMIAL_VARIABLES; ++*n) {
        TRY(psf_record_text(r, key(k, "POLNAME", *n), name, sizeof name, err));
        if (name[0] == '\0')
            break;
    }
    return SHEAR_OK;
}

static int read_variable(psf_chip *c, const psf_record *r, int i, shear_error *err) {
    char k[SF_INDEXED];
    char name[SF_NAME];
    int group = 1;
    psf_variable *v = &c->variables[i];
    double zero = NAN;
    double scale = NAN;
    TRY(psf_record_text(r, key(k, "POLNAME", i), name, sizeof name, err));
    if (name[0] == '\0')
        return psf_record_fail(r, k, "is missing", err);
    TRY(psf_record_double(r, key(k, "POLZERO", i), &zero, err));
    if (isnan(zero))
        return psf_record_fail(r, k, "is missing", err);
    TRY(psf_record_double(r, key(k, "POLSCAL", i), &scale, err));
    if (!(scale > 0.0))
        return psf_record_fail(r, k, "must be a positive number", err);
    TRY(psf_record_int(r, key(k, "POLGRP", i), 1, POLYNOMIAL_VARIABLES, &group, err));
    psf_chip_set_variable(c, i, name);
    c->terms.group[i] = group - 1;
    v->zero = v->middle = zero;
    v->scale = v->width = scale;
    return SHEAR_OK;
}

static int read_polynomial(psf_chip *c, const psf_record *r, shear_error *err) {
    char k[SF_INDEXED];
    polynomial *p = &c->terms;
    TRY(read_variables(r, &p->variables, err));
    for (int i = 0; i < p->variables; i++)
        TRY(read_variable(c, r, i, err));
    for (int i = 0; i < p->variables; i++) {
        int *degree = &p->degree[p->group[i]];
        *degree = -1;
        TRY(psf_record_int(r, key(k, "POLDEG", p->group[i]), 0, POLYNOMIAL_DEGREE, degree, err));
        if (*degree < 0)
            return psf_record_fail(r, k, "is missing", err);
        p->highest[i] = *degree;
    }
    return SHEAR_OK;
}

/* ---- the samples ---- */

/* Check that PSFAXISn, where given, agree with the shape of PSF_MASK. */
static int check_axes(const psf_record *r, const int64_t axes[SF_AXES], shear_error *err) {
    for (int i = 0; i < SF_AXES; i++) {
        char k[SF_INDEXED];
        char what[96];
        int n = 0;
        TRY(psf_record_int(r, key(k, "PSFAXIS", i), 1, INT_MAX, &n, err));
        if (n != 0 && n != axes[i]) {
            snprintf(what, sizeof what, "is %d, but PSF_MASK has %lld planes of %lld x %lld", n,
                     (long long)axes[2], (long long)axes[0], (long long)axes[1]);
            return psf_record_fail(r, k, what, err);
        }
    }
    return SHEAR_OK;
}

/* Take the axes of PSF_MASK from PSFAXISn if it has no TDIMn. */
static int complete_axes(const psf_record *r, int64_t axes[SF_AXES], shear_error *err) {
    const int64_t all = axes[0];
    int n[SF_AXES] = {1, 1, 1};
    char k[SF_INDEXED];
    if (axes[1] != 1 || axes[2] != 1)
        return SHEAR_OK;
    for (int i = 0; i < SF_AXES; i++)
        TRY(psf_record_int(r, key(k, "PSFAXIS", i), 1, 1 << 20, &n[i], err));
    if ((int64_t)n[0] * n[1] <= all && (int64_t)n[0] * n[1] * n[2] == all) {
        for (int i = 0; i < SF_AXES; i++)
            axes[i] = n[i];
    }
    return SHEAR_OK;
}

static int check_shape(const psf_chip *c, const psf_record *r, const int64_t axes[SF_AXES],
                       shear_error *err) {
    char what[128];
    const int terms = polynomial_count(&c->terms);
    if (axes[0] < 3 || axes[1] < 3 || axes[0] > PSF_SIDE || axes[1] > PSF_SIDE) {
        snprintf(what, sizeof what, "has planes of %lld x %lld, but 3 x 3 to %d x %d are read",
                 (long long)axes[0], (long long)axes[1], PSF_SIDE, PSF_SIDE);
        return psf_record_fail(r, "PSF_MASK", what, err);
    }
    if (axes[2] != terms || terms > POLYNOMIAL_TERMS) {
        snprintf(what, sizeof what,
                 "has %lld planes, but its polynomial (POLDEGn, POLGRPn) has %d%s",
                 (long long)axes[2], terms > POLYNOMIAL_TERMS ? POLYNOMIAL_TERMS : terms,
                 terms > POLYNOMIAL_TERMS ? " terms or more" : " terms");
        return psf_record_fail(r, "PSF_MASK", what, err);
    }
    return SHEAR_OK;
}

static int read_samples(psf_chip *c, const psf_record *r, shear_error *err) {
    int64_t axes[SF_AXES];
    TRY(psf_record_array(r, "PSF_MASK", axes, &c->samples, err));
    TRY(complete_axes(r, axes, err));
    TRY(check_axes(r, axes, err));
    TRY(check_shape(c, r, axes, err));
    c->model = (shear_psf_model){.nx = (int)axes[0],
                                 .ny = (int)axes[1],
                                 .terms = (int)axes[2],
                                 .axes = SHEAR_PSF_AXES_PIXEL};
    return SHEAR_OK;
}

/* ---- has the fit failed? ---- */

typedef struct psfex_fit {
    int loaded, accepted; /* stars; -1: not given */
    double chi2, samp;    /* NaN: not given */
    double fwhm;          /* pixels; NaN: not given */
} psfex_fit;

/* Read a number; one that is not finite, as PSFEx writes it after some failures, is INFINITY. */
static int read_result(const psf_record *r, const char *name, double *value, shear_error *err) {
    char text[SF_CARD + 1];
    double v = 0.0;
    TRY(psf_record_text(r, name, text, sizeof text, err));
    if (text_to_double(text, &v) && !isfinite(v)) {
        *value = INFINITY;
        return SHEAR_OK;
    }
    return psf_record_double(r, name, value, err);
}

static int read_fit(psfex_fit *f, const psf_record *r, shear_error *err) {
    *f = (psfex_fit){-1, -1, NAN, NAN, NAN};
    TRY(psf_record_int(r, "LOADED", 0, INT_MAX, &f->loaded, err));
    TRY(psf_record_int(r, "ACCEPTED", 0, INT_MAX, &f->accepted, err));
    TRY(read_result(r, "CHI2", &f->chi2, err));
    TRY(read_result(r, "PSF_SAMP", &f->samp, err));
    TRY(read_result(r, "PSF_FWHM", &f->fwhm, err));
    return isnan(f->samp) ? psf_record_fail(r, "PSF_SAMP", "is missing", err) : SHEAR_OK;
}

/* Return why there is no model, or NULL. */
static const char *failure_of_fit(const psfex_fit *f) {
    return f->accepted == 0                       ? "PSFEx accepted no star (ACCEPTED is 0)"
           : !(f->samp > 0.01 && f->samp < 100.0) ? "its sampling step (PSF_SAMP) is out of range"
           : f->chi2 > worst_chi2
               ? "it does not describe its stars (CHI2 is above 100, or no number)"
               : NULL;
}

/* Return why the model cannot be used, or NULL. */
static const char *failure_of_model(const psfex_fit *f, const psf_chip *c) {
    if (f->accepted >= 0 && f->accepted < c->model.terms)
        return "fewer stars (ACCEPTED) than terms of the polynomial";
    return psf_chip_failure(c);
}

static void describe(psf_chip *c, const psfex_fit *f) {
    text_append(c->text, sizeof c->text, "PSFEx, %d x %d samples of %.2f px", c->model.nx,
                c->model.ny, f->samp);
    psf_chip_describe(c);
    if (f->accepted >= 0)
        text_append(c->text, sizeof c->text, ", %d", f->accepted);
    if (f->accepted >= 0 && f->loaded >= 0)
        text_append(c->text, sizeof c->text, " of %d", f->loaded);
    if (f->accepted >= 0)
        text_append(c->text, sizeof c->text, " stars");
    if (!isnan(f->chi2))
        text_append(c->text, sizeof c->text, ", chi2/dof %.2f", f->chi2);
}

/* ---- kernels: docs/method.md section 3.3 ---- */

enum { LANCZOS = 3 };

/* FWHM in pixels below which PSFEx, by its default (BASIS_TYPE PIXEL_AUTO), fits the samples to the
 * stars. */
static const double fitted_fwhm = 3.0;

/* Set the kernels. Samples are means of stars that were interpolated from pixels, or of wider
 * steps; or they were fitted so that interpolation between them gives the stars. Models on a basis
 * of functions, whose coefficients are given, are fitted, too. */
static int set_kernels(shear_psf_model *m, const psf_record *r, const psfex_fit *f,
                       shear_error *err) {
    const sf_column *coefficients = NULL;
    TRY(sf_table_find(&r->table, "PSF_COEFFS", &coefficients, err));
    if (coefficients != NULL || f->fwhm < fitted_fwhm) {
        m->lanczos = LANCZOS;
    } else {
        m->smoothed_px = fmax(1.0, m->step);
    }
    return SHEAR_OK;
}

/* ---- models ---- */

static void note_failure(psf_chip *c, const char *why) {
    c->failed = true;
    text_append(c->text, sizeof c->text, "PSFEx, failed: %s", why);
}

static int read_model(psf_chip *c, const psf_record *r, shear_error *err) {
    psfex_fit fit;
    TRY(psf_record_text(r, "CCDNAME", c->name, sizeof c->name, err));
    TRY(read_fit(&fit, r, err));
    const char *why = failure_of_fit(&fit);
    if (why == NULL) {
        TRY(read_polynomial(c, r, err));
        TRY(read_samples(c, r, err));
        c->model.step = fit.samp;
        TRY(set_kernels(&c->model, r, &fit, err));
        why = failure_of_model(&fit, c);
    }
    if (why != NULL) {
        note_failure(c, why);
    } else {
        describe(c, &fit);
        c->stars = fit.accepted > 0 ? fit.accepted : 0;
    }
    return SHEAR_OK;
}

static int read_rows(psf_models *p, psf_record *r, shear_error *err) {
    for (r->row = 0; r->row < r->rows; r->row++) {
        psf_chip *c = NULL;
        TRY(psf_chip_new(p, &c, err));
        TRY(read_model(c, r, err));
    }
    return SHEAR_OK;
}

/* Read the HDU if it is a table with a column PSF_MASK. */
static int read_hdu(psf_models *p, const sf_hdu *hdu, shear_error *err) {
    CLEANUP(psf_record_deinit) psf_record r = {0};
    const sf_column *mask = NULL;
    if (!psf_record_is_table(hdu))
        return SHEAR_OK;
    TRY(psf_record_init(&r, &p->file, hdu, err));
    TRY(sf_table_find(&r.table, "PSF_MASK", &mask, err));
    return mask != NULL ? read_rows(p, &r, err) : SHEAR_OK;
}

int psfex_read(psf_models *p, shear_error *err) {
    for (int i = 0; i < p->file.count; i++) {
        if (p->chosen == NULL || p->chosen == &p->file.hdus[i])
            TRY(read_hdu(p, &p->file.hdus[i], err));
    }
    return SHEAR_OK;
}
