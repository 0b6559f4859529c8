/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/row.h"

#include "measure/block_sums.h"

#include <math.h>

void row_init(shear_row *row, int64_t stamp, double weight, enum shear_frame frame,
              uint32_t flags) {
    *row = (shear_row){.frame = frame,
                       .weight = weight,
                       .stamp = stamp,
                       .artefact_x = -1,
                       .artefact_y = -1,
                       .flags = flags};
    row->n1 = row->n2 = row->d = row->d_err = row->u = row->v = NAN;
    row->m20 = row->m02 = row->m11 = row->m4 = NAN;
    row->flux = row->snr = row->flux_removed = NAN;
    row->border_mean = row->border_var = row->border_var_noise = NAN;
    row->border_step_x = row->border_step_y = row->border_step2 = NAN;
}

static double step2(const border *b) {
    return b->step_x * b->step_x + b->step_y * b->step_y;
}

void row_fill_photometry(shear_row *row, const shear_stamps *st, const double *galaxy,
                         const double *noise, const photometry *ph) {
    const double pixels = (double)st->nx * st->ny;
    row->flux = ph->flux;
    row->snr = ph->noise_var > 0.0 ? row->flux / sqrt(2.0 * pixels * ph->noise_var) : NAN;
    const border of_galaxy = border_of(galaxy, st->nx, st->ny);
    const border of_noise = border_of(noise, st->nx, st->ny);
    row->border_mean = of_galaxy.mean - of_noise.mean;
    row->border_var = of_galaxy.var - of_noise.var;
    row->border_var_noise = of_noise.var;
    row->border_step_x = of_galaxy.step_x - of_noise.step_x;
    row->border_step_y = of_galaxy.step_y - of_noise.step_y;
    row->border_step2 = step2(&of_galaxy) - step2(&of_noise);
}

/* Fill in what a stamp's noise stamp adds to the terms of PDF symmetrization (docs/method.md,
 * section 6): `a` times the cross spectrum's terms, with beta^2 lowered so that the noise has no
 * preferred sign. A small `a` costs little precision; a smaller one would cost more again, because
 * `lower` grows. */
void row_fill_cross(shear_row *row, const moments *m, double beta, double r_psf) {
    static const double a = 0.3;
    const double beta2 = beta * beta;
    const double lower = beta2 - r_psf * r_psf * (1.0 + a * a) / (2.0 * a * a);
    row->cross_n1 = -0.5 * a * (m->m20 - m->m02);
    row->cross_n2 = -a * m->m11;
    row->cross_d = a * (m->m20 + m->m02 - 0.5 * lower * m->m4);
    row->cross_u = a * lower / beta2 * m->u;
    row->cross_v = a * lower / beta2 * m->v;
}

/* The noise's M20 + M02 tells its power, the galaxy's the flux. The rest are integrals over modes
 * with a Gaussian PSF of R_PSF (docs/method.md, section 5.1). */
void row_fill_d_err(shear_row *row, const spectra *sp, const shear_plan *plan, double area) {
    const double r2 = plan->info.r_psf_px * plan->info.r_psf_px;
    const double beta2 = plan->info.beta_px * plan->info.beta_px;
    const double a = fmax(beta2 - r2, 0.1 * r2);
    const double c = beta2 + a;
    const double weights = (2.0 - 6.0 * beta2 / c + 6.0 * beta2 * beta2 / (c * c)) / (c * c * c);
    const double power = sp->difference.m20 + sp->difference.m02;
    const double noise = sp->noise.m20 + sp->noise.m02;
    if (plan->settings.noise_correction)
        row->d_err = beta2 * a * sqrt(16.0 * M_PI * weights * fmax(power, 0.0) * noise / area);
}

void row_fill_moments(shear_row *row, const moments *m, double beta) {
    row->m20 = m->m20;
    row->m02 = m->m02;
    row->m11 = m->m11;
    row->m4 = m->m4;
    row->u = m->u;
    row->v = m->v;
    row->n1 = -0.5 * (m->m20 - m->m02);
    row->n2 = -m->m11;
    row->d = m->m20 + m->m02 - 0.5 * beta * beta * m->m4;
    double terms[SHEAR_N_TERMS];
    const double cross = row->cross_n1 + row->cross_n2 + row->cross_d + row->cross_u + row->cross_v;
    if (!block_terms(row, terms) || !isfinite(m->m4) || !isfinite(m->u + m->v + cross))
        row_init(row, row->stamp, row->weight, row->frame, SHEAR_FLAG_OVERFLOW);
}

void row_fill_noise(shear_row *row, const spectra *sp, const shear_plan *plan) {
    const moments *m = &sp->noise;
    const double beta2 = plan->info.beta * plan->info.beta;
    const shear_geometry *g = &plan->info.geometry;
    row->noise_n1 = -0.5 * (m->m20 - m->m02);
    row->noise_n2 = -m->m11;
    row->noise_d = m->m20 + m->m02 - 0.5 * beta2 * m->m4;
    row->noise_u = -0.5 * beta2 * m->u;
    row->noise_v = -2.0 * beta2 * m->v;
    if (high_band_is_set(&plan->high)) {
        const double all =
            (plan->high.n_edge + plan->high.n_corner) * (double)g->nx * (double)g->ny;
        row->corner_galaxy = sp->high.corner_galaxy / all;
        row->corner_noise = sp->high.corner_noise / all;
        row->high_galaxy = sp->high.edge_galaxy / all + row->corner_galaxy;
        row->high_noise = sp->high.edge_noise / all + row->corner_noise;
    }
}
