/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Look at the chips of an open exposure: shear/chip.h. */
#include "shear/chip.h"

#include "base/cleanup.h"
#include "survey/cutout/mesh_relation.h"
#include "survey/half_light.h"
#include "survey/internal.h"
#include "survey/second_moments.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)SHEAR_DEFECT_BAD == (int)PIXEL_BAD &&
                   (int)SHEAR_DEFECT_SATURATED == (int)PIXEL_SATURATED &&
                   (int)SHEAR_DEFECT_OUTSIDE == (int)PIXEL_OUTSIDE,
               "defects are handed out as they are");

int shear_field_chips(const shear_field *field) {
    return exposure_is(field) ? ((const exposure *)field)->n_chips : 0;
}

static int check_chip(const shear_field *field, int chip, shear_error *err) {
    const int n = shear_field_chips(field);
    return chip >= 0 && chip < n ? SHEAR_OK
                                 : shear_fail(err, SHEAR_E_SETTING, "chips are counted from 0",
                                              "there is no chip %d: the field has %d", chip, n);
}

static int check_stamp(const shear_field *field, int64_t stamp, shear_error *err) {
    return shear_field_chips(field) > 0 && stamp >= 0 && stamp < field->info.n_stamps
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_SETTING, "stamps are counted from 0",
                            "there is no stamp %" PRId64 " of an exposure: the field has %" PRId64,
                            stamp, field->info.n_stamps);
}

/* Combine the planes of a stamp's PSF model; NULL: out of memory. */
static double *psf_image(const exposure *e, const exposure_chip *chip, int64_t i) {
    const shear_psf_model *m = &e->base.models[chip->model];
    const double *terms = chip->stamps.psf_terms + i * chip->stamps.terms;
    const size_t plane = (size_t)m->nx * (size_t)m->ny;
    double *image = calloc(plane, sizeof *image);
    for (int t = 0; t < m->terms && image != NULL; t++) {
        for (size_t k = 0; k < plane; k++)
            image[k] += terms[t] * m->samples[(size_t)t * plane + k];
    }
    return image;
}

/* Return the lower quartile of FLUX_RADIUS, which is half of r_gal. */
static double source_quartile(const chip_stamps *s) {
    double r_gal = NAN;
    if (s->r_gal_measured)
        (void)chip_stamps_quantile(s, 0.25, &r_gal);
    return 0.5 * r_gal;
}

/* Return the half-light radius of the PSF at the stamp in the middle, pixels; NaN if it is not a
 * model of pixels, or there is no such stamp. */
static double psf_radius(const exposure *e, int i) {
    const exposure_chip *chip = &e->chips[i];
    const shear_psf_model *m = &e->base.models[chip->model];
    const int64_t middle = exposure_middle_stamp(e, i);
    if (m->axes == SHEAR_PSF_AXES_MODES || middle < 0)
        return NAN;
    const double scale = m->axes == SHEAR_PSF_AXES_SKY ? e->base.info.pixscale : 1.0;
    CLEANUP(release_free) double *image = psf_image(e, chip, middle);
    return image != NULL ? half_light_of_image(image, m->nx, m->ny) * m->step / scale : NAN;
}

int shear_field_get_chip(const shear_field *field, int i, shear_chip *chip, shear_error *err) {
    TRY(check_chip(field, i, err));
    const exposure *e = (const exposure *)field;
    const exposure_chip *c = &e->chips[i];
    const int stars = psf_models_stars(e->psf, c->model);
    *chip = (shear_chip){.name = exposure_images_name(e->images, i),
                         .first = c->first,
                         .n_stamps = c->stamps.n,
                         .n_sources = c->stamps.n_sources,
                         .nearest_source_deg = c->sky.nearest_deg,
                         .corner_deg = c->sky.corner_deg,
                         .table = c->table,
                         .has_wcs = c->mapped,
                         .model = c->model,
                         .psf_chip = psf_models_chip(e->psf, c->model),
                         .psf = psf_models_text(e->psf, c->model),
                         .psf_terms = psf_models_get(e->psf, c->model)->terms,
                         .psf_stars = stars > 0 ? stars : -1,
                         .r_psf_px = NAN,
                         .source_quartile = source_quartile(&c->stamps),
                         .star_radius_px = c->stamps.star_radius,
                         .psf_radius_px = psf_radius(e, i)};
    exposure_images_size(e->images, i, &chip->nx, &chip->ny);
    (void)exposure_r_psf(e, i, &chip->r_psf_px);
    for (int part = 0; part < SHEAR_N_PARTS; part++) {
        chip->hdu[part] = part >= SHEAR_PART_IMAGE && part <= SHEAR_PART_SEGMENTATION
                              ? exposure_images_hdu(e->images, i, (enum shear_part)part)
                              : -1;
    }
    return SHEAR_OK;
}

/* ---- places of stamps ---- */

int shear_chip_find(shear_field *field, int64_t stamp, shear_chip_place *place, shear_error *err) {
    TRY(check_stamp(field, stamp, err));
    exposure *e = exposure_of(field);
    const int chip = exposure_find_chip(e, stamp);
    const size_t pixels = (size_t)e->base.info.geometry.nx * (size_t)e->base.info.geometry.ny;
    CLEANUP(release_free)
    double *memory = malloc((1 + (size_t)e->base.info.noise_planes) * pixels * sizeof *memory);
    if (memory == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a stamp");
    cutter_pair pair = {.galaxy = memory, .noise = memory + pixels};
    const int64_t i = stamp - e->chips[chip].first;
    TRY(exposure_cut(e, chip, i, &pair, err));
    const chip_stamps *s = &e->chips[chip].stamps;
    *place = (shear_chip_place){.chip = chip,
                                .x = s->x[i],
                                .y = s->y[i],
                                .flags = s->flags[i] | pair.flags,
                                .box_x = pair.x,
                                .box_y = pair.y,
                                .n_noise = pair.n_noise};
    memcpy(place->noise_x, pair.noise_x, sizeof place->noise_x);
    memcpy(place->noise_y, pair.noise_y, sizeof place->noise_y);
    return SHEAR_OK;
}

/* ---- the PSF ---- */

/* Convert from square samples to square pixels. */
static void scale_moments(double c[3], const shear_psf_model *m, const double jacobian[4]) {
    const double turn = 2.0 * acos(-1.0);
    const bool modes = m->axes == SHEAR_PSF_AXES_MODES;
    const double x = modes ? turn / m->nx : m->step;
    const double y = modes ? turn / m->ny : m->step;
    c[0] *= x * x;
    c[1] *= x * y;
    c[2] *= y * y;
    if (modes) {
        second_moments_of_power(c);
    } else if (m->axes == SHEAR_PSF_AXES_SKY) {
        second_moments_to_pixels(c, jacobian);
    }
}

int shear_chip_psf(const shear_field *field, int64_t stamp, double cov[3], shear_error *err) {
    TRY(check_stamp(field, stamp, err));
    const exposure *e = (const exposure *)field;
    const exposure_chip *chip = &e->chips[exposure_find_chip(e, stamp)];
    const shear_psf_model *m = &e->base.models[chip->model];
    const int64_t i = stamp - chip->first;
    CLEANUP(release_free) double *image = psf_image(e, chip, i);
    if (image == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF");
    if (second_moments(image, m->nx, m->ny, cov))
        scale_moments(cov, m, chip->stamps.jacobian[i]);
    return SHEAR_OK;
}

/* ---- pixels ---- */

int shear_chip_read(shear_field *field, int chip, const shear_chip_box *box, shear_error *err) {
    TRY(check_chip(field, chip, err));
    TRY(exposure_hold(exposure_of(field), chip, err));
    const pixel_box pixels = {.x = box->x,
                              .y = box->y,
                              .nx = box->nx,
                              .ny = box->ny,
                              .value = box->value,
                              .sigma = box->sigma,
                              .defect = box->defect,
                              .owner = box->owner};
    return chip_pixels_read(exposure_of(field)->held.pixels, &pixels, err);
}

CLEANUP_DEFINE(chip_pixels, chip_pixels_close)

int shear_chip_unowned(shear_field *field, int chip, int64_t *looked_at, int64_t *unowned,
                       shear_error *err) {
    enum { MOST = 64 };
    *looked_at = *unowned = 0;
    TRY(check_chip(field, chip, err));
    const exposure *e = exposure_of(field);
    const chip_stamps *s = &e->chips[chip].stamps;
    if (exposure_images_hdu(e->images, chip, SHEAR_PART_SEGMENTATION) < 0)
        return SHEAR_OK;
    CLEANUP(chip_pixels_release) chip_pixels *pixels = NULL; /* without the statistics of a hold */
    TRY(chip_pixels_open(&pixels, e->images, chip, NULL, 0, err));
    for (int64_t i = 0; i < s->n && *looked_at < MOST; i++) {
        if ((s->flags[i] & (unsigned)SHEAR_FLAG_NO_POSITION) != 0)
            continue;
        int32_t owner = 0;
        const pixel_box at = {.x = (int)floor(s->x[i] - 0.5),
                              .y = (int)floor(s->y[i] - 0.5),
                              .nx = 1,
                              .ny = 1,
                              .owner = &owner};
        TRY(chip_pixels_read(pixels, &at, err));
        ++*looked_at;
        *unowned += owner == 0;
    }
    return SHEAR_OK;
}

int shear_chip_weight_slope(shear_field *field, int chip, double *slope, shear_error *err) {
    TRY(check_chip(field, chip, err));
    TRY(exposure_hold(exposure_of(field), chip, err));
    *slope = mesh_relation_slope(cutter_noise(exposure_of(field)->held.cutter));
    return SHEAR_OK;
}
