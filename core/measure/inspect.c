/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All steps of one pair's measurement as images: shear_inspect(). */
#include "measure/internal.h"

#include "base/cleanup.h"
#include "measure/moments.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

static bool allocate(shear_inspection *out) {
    const size_t points = (size_t)out->fine_nx * (size_t)out->fine_ny;
    const size_t modes = (size_t)out->spec_nx * (size_t)out->spec_ny;
    out->galaxy_fine = calloc(points, sizeof(double));
    out->noise_fine = calloc(points, sizeof(double));
    out->galaxy_filtered = calloc(points, sizeof(double));
    out->power = calloc(modes, sizeof(double));
    out->target_power = calloc(modes, sizeof(double));
    out->transfer = calloc(modes, sizeof(double));
    return out->galaxy_fine != NULL && out->noise_fine != NULL && out->galaxy_filtered != NULL &&
           out->power != NULL && out->target_power != NULL && out->transfer != NULL;
}

void shear_inspection_deinit(shear_inspection *out) {
    if (out != NULL) {
        free(out->galaxy_fine);
        free(out->noise_fine);
        free(out->galaxy_filtered);
        free(out->power);
        free(out->target_power);
        free(out->transfer);
        *out = (shear_inspection){0};
    }
}

static void copy_image(const shear_plan *plan, shear_workspace *ws, surface *s, double *out) {
    const surface_grid *g = &plan->grid;
    for (int x = 0; x < g->fine_nx; x++) {
        const int x0 = x / FFT_LANES * FFT_LANES;
        if (x == x0)
            surface_strip(s, g, x0, 0, g->fine_ny, ws->strip.re);
        for (int y = 0; y < g->fine_ny; y++) {
            out[(size_t)y * (size_t)g->fine_nx + (size_t)x] =
                ws->strip.re[(size_t)y * FFT_LANES + (size_t)(x - x0)];
        }
    }
}

/* Copy the fine images. A noise stamp that is not corrected for may be negative under a log method;
 * then its image is NaN. */
static void copy_images(const stamp_pair *s, bool has_noise, shear_inspection *out) {
    const shear_plan *plan = s->plan;
    shear_workspace *ws = s->ws;
    const size_t points = (size_t)out->fine_nx * (size_t)out->fine_ny;
    copy_image(plan, ws, &ws->galaxy, out->galaxy_fine);
    if (has_noise)
        copy_image(plan, ws, &ws->noise, out->noise_fine);
    for (size_t i = 0; i < points; i++) {
        out->noise_fine[i] = has_noise ? out->noise_fine[i] : NAN;
        out->galaxy_filtered[i] = s->filter != NULL
                                      ? s->filter->fine.value[i] * (out->galaxy_fine[i] - ws->level)
                                      : out->galaxy_fine[i];
    }
}

/* Store mode (jx, jy), jy >= 0, and its mirror image. */
static void put_mode(const mode_plane *p, int s, const transfer *t, int jx, int jy, double power,
                     shear_inspection *out) {
    const double s2 = (double)s * s;
    const double norm = (double)p->nx * p->ny * s2 * s2;
    const double both_halves = jy > 0 ? 2.0 : 1.0; /* T's weight */
    const double weight = t->t[mode_plane_column(p, jx) + (size_t)jy];
    for (int sign = -1; sign <= 1; sign += 2) {
        const size_t at = (size_t)(sign * jy + p->max_jy) * (size_t)out->spec_nx +
                          (size_t)(sign * jx + p->max_jx);
        out->power[at] = power / norm;
        out->transfer[at] = weight / both_halves * norm;
        out->target_power[at] = out->transfer[at] * out->power[at];
    }
}

/* Return the shot noise in every mode. */
static double shot_power(const shear_plan *plan, shear_workspace *ws) {
    double power = 0.0;
    double of_noise = 0.0;
    if (plan->settings.shot_noise == SHEAR_SHOT_PLATEAU) {
        for (int group = 0; group <= plan->plateau.last_group; group++) {
            const mode_rows rows = pack_transform_rows(plan, ws, group);
            plateau_add(&plan->plateau, &rows, &power, &of_noise);
        }
    }
    return power;
}

static void copy_spectra(const shear_plan *plan, shear_workspace *ws, const transfer *t,
                         shear_inspection *out) {
    const mode_plane *p = &plan->transfer_plan.plane;
    const double flat = shot_power(plan, ws);
    for (int group = 0; group * FFT_LANES <= t->jy; group++) {
        const mode_rows rows = pack_transform_rows(plan, ws, group);
        const int left = t->jy - group * FFT_LANES;
        for (int l = 0; l < FFT_LANES && l <= left; l++) {
            for (int jx = -t->jx; jx <= t->jx; jx++) {
                put_mode(p, plan->info.oversample, t, jx, group * FFT_LANES + l,
                         moments_power(&rows, jx, l) - flat, out);
            }
        }
    }
}

/* Fill *out for a pair that has been measured without a flag. */
static void fill(stamp_pair *s, shear_inspection *out) {
    uint32_t flags = 0;
    measure_choose_filter(s, &flags);
    pair_transfer_choose(s, &flags);
    assert(flags == 0 && s->transfer != NULL);
    int bad;
    const bool has_noise = surface_load(&s->ws->noise, &s->plan->grid, s->noise, &bad, &bad);
    pack_pair(s->plan, s->ws, s->filter, s->galaxy, s->noise, false, s->transfer, &s->ph,
              &s->failure);
    copy_images(s, has_noise, out);
    copy_spectra(s->plan, s->ws, s->transfer, out);
}

int shear_inspect(const shear_plan *plan, shear_workspace *ws, const shear_stamps *stamps, int i,
                  shear_inspection *out, shear_error *err) {
    const mode_plane *p = &plan->transfer_plan.plane;
    shear_row row;
    *out = (shear_inspection){0};
    TRY(shear_measure(plan, ws, stamps, i, &row, err));
    if (row.flags != 0) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "stamp %lld is flagged (0x%x) and cannot be shown",
                          (long long)stamps->first + i, row.flags);
    }
    *out = (shear_inspection){.fine_nx = plan->info.fine_nx,
                              .fine_ny = plan->info.fine_ny,
                              .spec_nx = 2 * p->max_jx + 1,
                              .spec_ny = 2 * p->max_jy + 1};
    if (!allocate(out)) {
        shear_inspection_deinit(out);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for an inspection");
    }
    stamp_pair s = measure_pair_at(plan, ws, stamps, i);
    fill(&s, out);
    return SHEAR_OK;
}
