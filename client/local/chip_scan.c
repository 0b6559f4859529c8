/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/chip_scan.h"

#include "base/cleanup.h"
#include "local/weight_map.h"

#include <math.h>
#include <stdlib.h>

enum { BAND = 64 }; /* rows that are read at once */

static int describe(chip_scan *s, shear_error *err) {
    int64_t most = 0;
    for (int i = 0; i < s->n; i++) {
        shear_chip *c = &s->chips[i].chip;
        TRY(shear_field_get_chip(s->field, i, c, err));
        s->chips[i].masked = s->chips[i].weight_slope = NAN;
        shear_centring_summarize(&s->chips[i].centring, 0, s->dx, s->dy, 0);
        most = c->n_stamps > most ? c->n_stamps : most;
    }
    s->dx = calloc((size_t)most + 1, sizeof *s->dx);
    s->dy = calloc((size_t)most + 1, sizeof *s->dy);
    return s->dx != NULL && s->dy != NULL ? SHEAR_OK
                                          : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
}

int chip_scan_init(chip_scan *s, shear_field *field, sheard_validation_report *v,
                   shear_error *err) {
    *s = (chip_scan){.field = field,
                     .n = shear_field_chips(field),
                     .current = -1,
                     .distortion_min = NAN,
                     .distortion_max = NAN};
    s->chips = calloc((size_t)s->n + 1, sizeof *s->chips);
    if (s->chips == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    TRY(describe(s, err));
    v->chips = s->chips;
    v->n_chips = s->n;
    v->distortion_min = v->distortion_max = NAN;
    return SHEAR_OK;
}

void chip_scan_deinit(chip_scan *s) {
    free(s->dx);
    free(s->dy);
    free(s->chips);
    *s = (chip_scan){0};
}

/* ---- one chip after the other ---- */

/* Look at all pixels of a chip: how many are bad, and what the weight map says of the others. */
static int look_at_pixels(const chip_scan *s, int i, shear_error *err) {
    sheard_chip_report *r = &s->chips[i];
    const size_t nx = (size_t)r->chip.nx;
    int64_t bad = 0;
    sigma_range range = {0};
    CLEANUP(release_free) uint8_t *defect = malloc(BAND * nx);
    CLEANUP(release_free) float *sigma = malloc(BAND * nx * sizeof *sigma);
    if (defect == NULL || sigma == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    for (int y = 0; y < r->chip.ny; y += BAND) {
        const int rows = r->chip.ny - y < BAND ? r->chip.ny - y : BAND;
        const size_t n = nx * (size_t)rows;
        const shear_chip_box box = {
            .y = y, .nx = r->chip.nx, .ny = rows, .sigma = sigma, .defect = defect};
        TRY(shear_chip_read(s->field, i, &box, err));
        for (size_t k = 0; k < n; k++)
            bad += defect[k] != 0;
        sigma_range_add(&range, sigma, defect, n);
    }
    r->masked = (double)bad / ((double)r->chip.nx * r->chip.ny);
    r->n_extreme = sigma_range_extreme(&range);
    TRY(shear_chip_unowned(s->field, i, &r->n_segmented, &r->n_unowned, err));
    return shear_chip_weight_slope(s->field, i, &r->weight_slope, err);
}

static void end_chip(chip_scan *s) {
    if (s->current >= 0) {
        shear_centring_summarize(&s->chips[s->current].centring, s->looked_at, s->dx, s->dy,
                                 s->found);
    }
    s->looked_at = s->found = 0;
}

/* Begin the chip of this stamp, whose pixels are those that are held. */
static int begin_chip(chip_scan *s, int64_t stamp, shear_error *err) {
    end_chip(s);
    do {
        s->current++;
        TRY(look_at_pixels(s, s->current, err));
    } while (stamp >= s->chips[s->current].chip.first + s->chips[s->current].chip.n_stamps);
    return SHEAR_OK;
}

int chip_scan_add(chip_scan *s, const shear_block *b, int i, unsigned flags, const shear_row *row,
                  shear_error *err) {
    const int64_t stamp = b->stamps.first + i;
    if (s->n == 0)
        return SHEAR_OK;
    if (s->current < 0 ||
        stamp >= s->chips[s->current].chip.first + s->chips[s->current].chip.n_stamps) {
        TRY(begin_chip(s, stamp, err));
    }
    sheard_chip_report *r = &s->chips[s->current];
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++)
        r->flags[bit] += flags >> bit & 1;
    r->n_measurable += flags == 0;
    r->n_bright += row != NULL && shear_row_is_bright(row) ? 1 : 0;
    r->n_sharp += row != NULL && shear_row_is_sharp(row) ? 1 : 0;
    if (b->dropped[i] == 0) {
        s->looked_at++;
        s->found += shear_centring_find(&b->stamps, i, b->x[i], b->y[i], &s->dx[s->found],
                                        &s->dy[s->found]);
    }
    if (b->gf1 != NULL && (flags & (unsigned)SHEAR_FLAG_NO_POSITION) == 0) {
        const double g = hypot(b->gf1[i], b->gf2[i]);
        s->distortion_min = fmin(s->distortion_min, g);
        s->distortion_max = fmax(s->distortion_max, g);
    }
    return SHEAR_OK;
}

int chip_scan_finish(chip_scan *s, sheard_validation_report *v, shear_error *err) {
    end_chip(s);
    while (s->current + 1 < s->n)
        TRY(look_at_pixels(s, ++s->current, err));
    v->distortion_min = s->distortion_min;
    v->distortion_max = s->distortion_max;
    return SHEAR_OK;
}
