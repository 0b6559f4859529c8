/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/psf_models.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "fits/header/meds.h"
#include "survey/psf/image_cube.h"
#include "survey/psf/internal.h"
#include "survey/psf/piff.h"
#include "survey/psf/psfex.h"
#include "survey/psf/star_stamps.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

CLEANUP_DEFINE(psf_models, psf_models_close)

/* Variables this many widths from the middle are beyond the polynomial: places twice as far as the
 * outermost star. Magnitudes may be farther: galaxies are fainter than PSF stars. So may places of
 * which the nearest image is used. */
static const double reach_of_places = 1.0;
static const double reach = 3.0;

/* ---- opening ---- */

static int choose_hdu(psf_models *p, const shear_input_part *part, shear_error *err) {
    if (part->extname != NULL)
        return sf_file_find(&p->file, part->extname, true, &p->chosen, err);
    if (part->hdu >= p->file.count) {
        return sf_fail(err, SHEAR_E_FORMAT, (sf_place){p->file.source.name, NULL},
                       "HDUs are counted from 0, the primary; or give the EXTNAME",
                       "has no HDU number %lld (its last is %d)", (long long)part->hdu,
                       p->file.count - 1);
    }
    p->chosen = part->hdu >= 0 ? &p->file.hdus[part->hdu] : NULL;
    return SHEAR_OK;
}

/* The kinds of files, in the order in which they are looked for. */
static const struct {
    enum shear_psf_kind kind;
    int (*read)(psf_models *p, shear_error *err);
    const char *name;
} kinds[] = {{SHEAR_PSF_KIND_PSFEX, psfex_read, "PSFEx model (a table with a column PSF_MASK)"},
             {SHEAR_PSF_KIND_PIFF, piff_read, "model of Piff (a table psf with a column type)"},
             {SHEAR_PSF_KIND_STARS, star_stamps_read,
              "stamps of stars (a table with a column VIGNET or IMAGE)"},
             {SHEAR_PSF_KIND_CUBE, image_cube_read, "image of a PSF"}};

static int read_models(psf_models *p, enum shear_psf_kind kind, shear_error *err) {
    const char *name = NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0] && p->n == 0; i++) {
        if (kind == SHEAR_PSF_KIND_AUTO || kind == kinds[i].kind) {
            name = kind == SHEAR_PSF_KIND_AUTO ? "PSF" : kinds[i].name;
            TRY(kinds[i].read(p, err));
        }
    }
    return p->n > 0 ? SHEAR_OK
                    : sf_fail(err, SHEAR_E_PSF, (sf_place){p->file.source.name, NULL},
                              "give a PSFEx file (.psf), a Piff file, a cube of PSF images, or "
                              "stamps of stars (docs/exposures.md)",
                              "holds no %s", name);
}

/* ---- models of one shape ---- */

static const psf_chip *first_sound(const psf_models *p) {
    int i = 0;
    while (i < p->n && p->chips[i].failed)
        i++;
    return i < p->n ? &p->chips[i] : NULL;
}

/* Append planes of zeros until there are `terms`. */
static bool pad(psf_chip *c, int terms) {
    const size_t plane = (size_t)c->model.nx * (size_t)c->model.ny;
    const size_t used = plane * (size_t)c->model.terms;
    double *samples = calloc(plane * (size_t)terms, sizeof *samples);
    if (samples == NULL)
        return false;
    memcpy(samples, c->samples, used * sizeof *samples);
    free(c->samples);
    c->samples = samples;
    c->model.terms = terms;
    return true;
}

static void finish_chip(psf_chip *c) {
    c->model.samples = c->samples;
    for (int i = 0; i < c->terms.variables; i++) {
        if (c->variables[i].quantity == PSF_QUANTITY_CONTEXT)
            c->contexts[c->n_contexts++] = c->variables[i].name;
    }
}

/* Give all models the same number of terms. Chips whose fit has failed get the planes of the first
 * sound one, so that they have some. */
static int finish(psf_models *p, shear_error *err) {
    const sf_place at = {p->file.source.name, NULL};
    const psf_chip *sound = first_sound(p);
    int terms = 1;
    if (sound == NULL) {
        return sf_fail(err, SHEAR_E_PSF, at,
                       "make the PSF model again, from more, brighter or better selected stars",
                       "no PSF model can be used: %s", p->chips[0].text);
    }
    for (int i = 0; i < p->n; i++) {
        if (!p->chips[i].failed && p->chips[i].model.terms > terms)
            terms = p->chips[i].model.terms;
    }
    for (int i = 0; i < p->n; i++) {
        psf_chip *c = &p->chips[i];
        if (!c->failed && c->model.terms < terms && !pad(c, terms))
            return sf_fail_memory(err, at);
        finish_chip(c);
    }
    for (int i = 0; i < p->n; i++) {
        if (p->chips[i].failed)
            p->chips[i].model = sound->model;
    }
    return SHEAR_OK;
}

int psf_models_open(psf_models **out, const shear_input_part *part, int fd,
                    enum shear_psf_kind kind, int stamp, shear_error *err) {
    *out = NULL;
    assert(stamp >= 8);
    CLEANUP(psf_models_release) psf_models *p = calloc(1, sizeof *p);
    if (p == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    p->stamp = stamp;
    p->file.source.fd = -1;
    TRY(sf_file_open(&p->file, part->path, fd, err));
    TRY(sf_meds_refuse(&p->file, err));
    TRY(choose_hdu(p, part, err));
    TRY(read_models(p, kind, err));
    TRY(finish(p, err));
    *out = CLEANUP_TAKE(p);
    return SHEAR_OK;
}

void psf_models_close(psf_models *p) {
    if (p == NULL)
        return;
    for (int i = 0; i < p->n; i++) {
        free(p->chips[i].samples);
        free(p->chips[i].places);
    }
    free(p->chips);
    sf_file_close(&p->file);
    free(p);
}

int64_t psf_models_hdu(const psf_models *p) {
    return p->chosen != NULL ? p->chosen->number : -1;
}

int psf_models_count(const psf_models *p) {
    return p->n;
}

const char *psf_models_chip(const psf_models *p, int i) {
    return p->chips[i].name;
}

const shear_psf_model *psf_models_get(const psf_models *p, int i) {
    return &p->chips[i].model;
}

const char *psf_models_text(const psf_models *p, int i) {
    return p->chips[i].text;
}

int psf_models_stars(const psf_models *p, int i) {
    return p->chips[i].stars;
}

int psf_models_contexts(const psf_models *p, int i, const char *const **names) {
    *names = p->chips[i].contexts;
    return p->chips[i].n_contexts;
}

/* ---- coefficients ---- */

/* Compute the variables. Return false if one is unknown or too far from the stars. */
static bool compute_variables(const psf_chip *c, const psf_place *place, double *out) {
    double value[PSF_QUANTITY_CONTEXT] = {[PSF_QUANTITY_X] = place->x, [PSF_QUANTITY_Y] = place->y};
    const double *context = place->context;
    psf_chip_tangent(c, place->ra, place->dec, &value[PSF_QUANTITY_U], &value[PSF_QUANTITY_V]);
    for (int i = 0; i < c->terms.variables; i++) {
        const psf_variable *v = &c->variables[i];
        const double x = v->quantity == PSF_QUANTITY_CONTEXT ? *context++ : value[v->quantity];
        const bool fitted = v->quantity != PSF_QUANTITY_CONTEXT && c->places == NULL;
        if (!(fabs(x - v->middle) <= (fitted ? reach_of_places : reach) * v->width))
            return false;
        out[i] = (x - v->zero) / v->scale;
    }
    return true;
}

/* Set the coefficient of the plane nearest to u[2] to 1. */
static void choose_nearest(const psf_chip *c, const double *u, double *t) {
    double least = INFINITY;
    int nearest = 0;
    for (int i = 0; i < c->planes; i++) {
        const double d = hypot(u[0] - c->places[2 * i], u[1] - c->places[2 * i + 1]);
        nearest = d < least ? i : nearest;
        least = fmin(d, least);
    }
    t[nearest] = 1.0;
}

bool psf_models_terms(const psf_models *p, int i, const psf_place *place, double *c) {
    const psf_chip *chip = &p->chips[i];
    double u[POLYNOMIAL_VARIABLES] = {0};
    bool finite = true;
    for (int t = 0; t < chip->model.terms; t++)
        c[t] = 0.0;
    if (chip->failed || !compute_variables(chip, place, u))
        return false;
    if (chip->places != NULL) {
        choose_nearest(chip, u, c);
    } else {
        polynomial_terms(&chip->terms, u, c);
    }
    for (int t = 0; t < chip->model.terms; t++)
        finite = finite && isfinite(c[t]);
    return finite;
}
