/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/field/spec.h"

#include "base/cleanup.h"
#include "fits/field/internal.h"
#include "fits/field/name.h"

#include <math.h>

static int bad(sf_place at, const char *what, shear_error *err) {
    return sf_fail(err, SHEAR_E_SETTING, at, NULL, "cannot be made: %s", what);
}

static bool inside(int64_t value, int64_t min, int64_t max) {
    return value >= min && value <= max;
}

static int check_sizes(const shear_field_spec *s, sf_place at, shear_error *err) {
    const shear_geometry *g = &s->geometry;
    const bool has_ids = (s->columns & SHEAR_COL_PSF_ID) != 0;
    const struct {
        bool kept;
        const char *what;
    } rules[] = {
        {inside(g->nx, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE) &&
             inside(g->ny, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE),
         "a stamp's side must have 8 to 1024 pixels"},
        {inside(g->psf_nx, SF_PSF_MIN_SIDE, SF_PSF_MAX_SIDE) &&
             inside(g->psf_ny, SF_PSF_MIN_SIDE, SF_PSF_MAX_SIDE),
         "a PSF's side must have 3 to 4096 samples"},
        {inside(g->psf_oversample, 1, SF_MAX_OVERSAMPLE), "the PSF's oversampling must be 1 to 64"},
        {inside(s->n_stamps, 1, INT32_MAX), "the number of stamps must be 1 to 2147483647"},
        {inside(s->noise_planes, 0, SHEAR_MAX_NOISE_PLANES),
         "there must be 1 to 64 noise stamps per galaxy"},
        {s->n_psf == 1 || s->n_psf == s->n_stamps || (has_ids && inside(s->n_psf, 1, INT32_MAX)),
         "there must be one PSF, or one per stamp, or a column PSF_ID"},
        {s->layout == SHEAR_LAYOUT_CUBE || s->layout == SHEAR_LAYOUT_MOSAIC,
         "the layout is neither cube nor mosaic"},
        {inside(s->mosaic_columns, 0, s->n_stamps),
         "a mosaic's row must have 1 to n_stamps stamps"},
        {s->bitpix == -32 || s->bitpix == -64, "BITPIX must be -32 or -64"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
        if (!rules[i].kept)
            return bad(at, rules[i].what, err);
    }
    return SHEAR_OK;
}

int sf_field_spec_check(const shear_field_spec *s, const char *file, shear_error *err) {
    const sf_place at = {file, NULL};
    if (s->name != NULL) {
        char copy[SHEAR_FIELD_NAME_SIZE];
        TRY(sf_field_name_copy(copy, s->name, SHEAR_E_SETTING, at, "as given", err));
    }
    if (!isnan(s->pixscale) && !(s->pixscale > 0.0 && isfinite(s->pixscale)))
        return bad(at, "the pixel scale must be positive", err);
    if (s->has_truth && !(fabs(s->sim_g1) < 1.0 && fabs(s->sim_g2) < 1.0))
        return bad(at, "the true shear must lie between -1 and 1", err);
    return check_sizes(s, at, err);
}
