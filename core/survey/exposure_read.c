/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cut blocks of stamps out of the chips of an exposure. */
#include "survey/internal.h"

#include "base/cleanup.h"

#include <math.h>
#include <string.h>

/* ---- the pixels of one chip at a time ---- */

void exposure_let_go(held_chip *h) {
    cutter_free(h->cutter);
    chip_pixels_close(h->noise);
    chip_pixels_close(h->pixels);
    *h = (held_chip){.chip = -1};
}

int64_t exposure_middle_stamp(const exposure *e, int chip) {
    int nx;
    int ny;
    exposure_images_size(e->images, chip, &nx, &ny);
    const chip_stamps *s = &e->chips[chip].stamps;
    int64_t nearest = -1;
    double least = INFINITY;
    for (int64_t i = 0; i < s->n; i++) {
        const double d = hypot(s->x[i] - 0.5 * nx, s->y[i] - 0.5 * ny);
        if (s->flags[i] == 0 && d < least) {
            least = d;
            nearest = i;
        }
    }
    return nearest;
}

int exposure_r_psf(const exposure *e, int chip, double *r) {
    const chip_stamps *s = &e->chips[chip].stamps;
    const shear_psf_model *m = &e->base.models[e->chips[chip].model];
    const int64_t nearest = exposure_middle_stamp(e, chip);
    const double scale = m->axes == SHEAR_PSF_AXES_SKY ? e->base.info.pixscale : 1.0;
    return nearest >= 0
               ? shear_psf_model_radius(m, s->psf_terms + nearest * s->terms, scale, r, NULL)
               : SHEAR_E_PSF;
}

int exposure_hold(exposure *e, int chip, shear_error *err) {
    held_chip *h = &e->held;
    const chip_stamps *s = &e->chips[chip].stamps;
    if (h->chip == chip)
        return SHEAR_OK;
    exposure_let_go(h);
    double r_psf_px = 1.5; /* if no stamp of this chip can be measured */
    if (exposure_r_psf(e, chip, &r_psf_px) == SHEAR_E_NOMEM)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a PSF");
    cutter_options options = {.stamp = e->base.info.geometry.nx,
                              .noise_stamps = e->base.info.noise_planes,
                              .noise = e->options.noise,
                              .amplifiers = e->options.amplifiers,
                              .chip = chip,
                              .r_psf_px = r_psf_px};
    exposure_images_size(e->images, chip, &options.nx, &options.ny);
    chip_stamps_size_shapes(&e->chips[chip].stamps, options.r_psf_px);
    TRY(chip_pixels_open(&h->pixels, e->images, chip, s->shapes, s->n_shapes, err));
    if (e->noise_images != NULL)
        TRY(chip_pixels_open(&h->noise, e->noise_images, e->chips[chip].noise, NULL, 0, err));
    TRY(cutter_new(&h->cutter, h->pixels, h->noise, &options, err));
    h->chip = chip;
    return SHEAR_OK;
}

/* ---- blocks of stamps ---- */

int exposure_find_chip(const exposure *e, int64_t stamp) {
    int chip = 0;
    while (chip + 1 < e->n_chips && e->chips[chip + 1].first <= stamp)
        chip++;
    return chip;
}

/* Copy what is known without pixels of a stamp. */
static int fill_columns(const exposure *e, int64_t stamp, shear_block *b, int to,
                        shear_error *err) {
    const exposure_chip *chip = &e->chips[exposure_find_chip(e, stamp)];
    const chip_stamps *s = &chip->stamps;
    const int64_t from = stamp - chip->first;
    b->id[to] = s->id[from];
    b->x[to] = s->x[from];
    b->y[to] = s->y[from];
    b->dropped[to] = s->flags[from];
    b->psf_index[to] = chip->model;
    memcpy(b->psf_terms + (size_t)to * (size_t)s->terms, s->psf_terms + from * s->terms,
           (size_t)s->terms * sizeof *b->psf_terms);
    if (b->weight != NULL)
        b->weight[to] = s->weight != NULL ? s->weight[from] : 1.0;
    if (b->r_gal != NULL)
        b->r_gal[to] = s->r_gal != NULL ? s->r_gal[from] : NAN;
    if (b->jacobian != NULL) {
        const sky_distortion d = sky_distortion_of(s->jacobian[from]);
        b->ra[to] = s->ra[from];
        b->dec[to] = s->dec[from];
        memcpy(b->jacobian + 4 * (size_t)to, s->jacobian[from], sizeof s->jacobian[from]);
        b->gf1[to] = d.g1;
        b->gf2[to] = d.g2;
    }
    return b->carried == NULL
               ? SHEAR_OK
               : carry_rows_read(&chip->carried, s->row[from],
                                 b->carried + (size_t)to * (size_t)e->carried.bytes, err);
}

int exposure_read_columns(shear_field *field, int64_t first, int count, shear_block *block,
                          shear_error *err) {
    for (int i = 0; i < count; i++)
        TRY(fill_columns(exposure_of(field), first + i, block, i, err));
    return SHEAR_OK;
}

int exposure_cut(exposure *e, int chip, int64_t i, cutter_pair *pair, shear_error *err) {
    const chip_stamps *s = &e->chips[chip].stamps;
    const cutter_source source = {
        .x = s->x[i] - 1.0, .y = s->y[i] - 1.0, .r_gal = chip_stamps_light(s, i), .id = s->id[i]};
    TRY(exposure_hold(e, chip, err));
    return cutter_cut(e->held.cutter, &source, pair, err);
}

static int cut(exposure *e, int64_t stamp, shear_block *b, int to, shear_error *err) {
    const shear_field_info *info = &e->base.info;
    const int chip = exposure_find_chip(e, stamp);
    const int64_t from = stamp - e->chips[chip].first;
    const size_t pixels = (size_t)info->geometry.nx * (size_t)info->geometry.ny;
    cutter_pair pair = {.galaxy = b->galaxy + (size_t)to * pixels,
                        .noise = b->noise + (size_t)to * (size_t)info->noise_planes * pixels};
    TRY(exposure_cut(e, chip, from, &pair, err));
    TRY(fill_columns(e, stamp, b, to, err));
    b->dropped[to] |= pair.flags;
    return SHEAR_OK;
}

int exposure_read(shear_field *field, int64_t first, int count, shear_block *block,
                  shear_error *err) {
    for (int i = 0; i < count; i++)
        TRY(cut(exposure_of(field), first + i, block, i, err));
    return SHEAR_OK;
}
