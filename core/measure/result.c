/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/result.h"

#include "measure/field_sums.h"

#include "shear/settings.h"

#include <math.h>
#include <string.h>

/* For very faint units (pixels of 1e-75) squares below this lose digits: the errors are unknown
 * then. */
static const double smallest_square = 1e-290;
/* A field has a shear only if its denominator is this many sigma of the noise above 0. */
static const double least_signal = 5.0;
/* Equal stamps have powers that differ by less than this fraction, because transforms round ... */
static const double rounding = 1e-9;
/* ... or, if each stamp loses a level of its own before a filter, by less than these: a fraction of
 * D; a square of the difference at high k, where a filter has no power; and a flux, as a fraction
 * of a border pixel's noise, so that galaxies in exactly the noise of the noise stamps are not
 * mistaken for equal stamps. */
static const double of_levels = 0.15;
static const double of_levels_at_high_k2 = 1e-8;
static const double of_levels_in_flux = 1e-4;

shear_ratio shear_ratio_of(const double x[SHEAR_N_COMPONENTS]) {
    const double noise = x[SHEAR_C_HIGH_NOISE];
    const double level = noise > 0.0 ? x[SHEAR_C_HIGH_GALAXY] / noise : 1.0;
    return (shear_ratio){.n1 = x[SHEAR_C_N1] + (1.0 - level) * x[SHEAR_C_NOISE_N1],
                         .n2 = x[SHEAR_C_N2] + (1.0 - level) * x[SHEAR_C_NOISE_N2],
                         .d = x[SHEAR_C_D] + (1.0 - level) * x[SHEAR_C_NOISE_D],
                         .level = level};
}

/* All of a field's sums, rounded. */
typedef struct rounded {
    double t[SHEAR_N_TERMS];
    shear_ratio at_level;
} rounded;

static double component(const rounded *r, int i) {
    return r->t[SHEAR_S_COMPONENT + i];
}

static double product(const rounded *r, int i, int j) {
    return r->t[shear_term_product(i, j)];
}

/* A linear combination of a stamp's components. */
typedef struct combination {
    double c[SHEAR_N_COMPONENTS];
} combination;

/* sum w^2 (a x) (b x) */
static double product_of(const rounded *r, const combination *a, const combination *b) {
    double sum = 0.0;
    for (int i = 0; i < SHEAR_N_COMPONENTS; i++) {
        for (int j = 0; j < SHEAR_N_COMPONENTS; j++)
            sum += a->c[i] != 0.0 && b->c[j] != 0.0 ? a->c[i] * b->c[j] * product(r, i, j) : 0.0;
    }
    return sum;
}

/* Return a stamp's contribution to the noise level (minus its mean): (G_hi - alpha N_hi) / sum
 * N_hi. */
static combination of_level(const rounded *r) {
    combination c = {{0.0}};
    const double noise = component(r, SHEAR_C_HIGH_NOISE);
    if (noise > 0.0) {
        c.c[SHEAR_C_HIGH_GALAXY] = 1.0 / noise;
        c.c[SHEAR_C_HIGH_NOISE] = -r->at_level.level / noise;
    }
    return c;
}

/* Return a stamp's contribution to N - g D at the noise level, where N is component `n`, and
 * `noise_n` that of the noise: its own terms and, through the noise level, those of all noise
 * stamps. */
static combination of_ratio(const rounded *r, int n, int noise_n, double g) {
    const combination level = of_level(r);
    const double by_level = component(r, noise_n) - g * component(r, SHEAR_C_NOISE_D);
    combination c = {{0.0}};
    c.c[n] = 1.0;
    c.c[noise_n] = 1.0 - r->at_level.level;
    c.c[SHEAR_C_D] = -g;
    c.c[SHEAR_C_NOISE_D] = -g * (1.0 - r->at_level.level);
    for (int i = 0; i < SHEAR_N_COMPONENTS; i++)
        c.c[i] -= by_level * level.c[i];
    return c;
}

/* Compute the mean of a term, whose square is the next term, over the used stamps, and the error of
 * that mean. */
static void mean_of(const double *t, int term, double n, double *mean, double *mean_err) {
    *mean = t[term] / n;
    const double variance = fmax(0.0, t[term + 1] / n - *mean * *mean);
    *mean_err = sqrt(variance / (n - 1.0));
}

/* Apply the delta method to the ratio of sums g = sum w N / sum w D, including the noise level. */
static void fill_shear(shear_result *out, const rounded *r) {
    const double d = r->at_level.d;
    out->g1 = r->at_level.n1 / d;
    out->g2 = r->at_level.n2 / d;
    const combination e1 = of_ratio(r, SHEAR_C_N1, SHEAR_C_NOISE_N1, out->g1);
    const combination e2 = of_ratio(r, SHEAR_C_N2, SHEAR_C_NOISE_N2, out->g2);
    out->g1_err = sqrt(fmax(0.0, product_of(r, &e1, &e1))) / d;
    out->g2_err = sqrt(fmax(0.0, product_of(r, &e2, &e2))) / d;
    out->cov12 = product_of(r, &e1, &e2) / (d * d);
    if (!(product(r, SHEAR_C_D, SHEAR_C_D) > smallest_square))
        out->g1_err = out->g2_err = out->cov12 = NAN;
    out->delta_g1_err = out->g1_err;
    out->delta_g2_err = out->g2_err;
}

/* Return the summed squares of the noise stamps' scatter: of their w d about the value expected
 * from their own power, so that differing weights or depths do not count as noise; if that is
 * unknown, about the mean. */
static double scatter_of_noise(const rounded *r, double n) {
    const double sum = component(r, SHEAR_C_NOISE_D);
    const double power = component(r, SHEAR_C_HIGH_NOISE);
    combination c = {{0.0}};
    c.c[SHEAR_C_NOISE_D] = 1.0;
    c.c[SHEAR_C_HIGH_NOISE] = power > 0.0 ? -sum / power : 0.0;
    return fmax(0.0, product_of(r, &c, &c) - (power > 0.0 ? 0.0 : sum * sum / n));
}

/* Return the scatter of sum w D from noise alone: that of two stamps with noise at the galaxies'
 * level, and the noise level's error. */
static double noise_of_d(const rounded *r, double n, double level_err) {
    const double level = r->at_level.level;
    const double by_level = isfinite(level_err) ? component(r, SHEAR_C_NOISE_D) * level_err : 0.0;
    return sqrt(2.0 * level * level * scatter_of_noise(r, n) + by_level * by_level);
}

/* Return a sum of ones. Text may say anything. */
static int64_t count_of(double sum) {
    return sum >= 0.0 && sum < 9007199254740992.0 ? (int64_t)sum : 0;
}

/* Count what is sharper than its PSF (docs/method.md, section 5.1). */
static void fill_resolution(shear_result *out, const rounded *r) {
    out->n_bright = count_of(r->t[SHEAR_S_BRIGHT]);
    out->n_sharp = count_of(r->t[SHEAR_S_SHARP]);
    out->bright_triples = count_of(r->t[SHEAR_S_BRIGHT_TRIPLES]);
    out->sharp_triples = count_of(r->t[SHEAR_S_SHARP_TRIPLES]);
    if (r->t[SHEAR_S_POWER] > 0.0)
        out->resolution = out->sum_d / r->t[SHEAR_S_POWER];
}

static void fill_influence(shear_result *out, const rounded *r, shear_influence top) {
    combination d = {{0.0}};
    d.c[SHEAR_C_D] = 1.0;
    d.c[SHEAR_C_NOISE_D] = 1.0 - r->at_level.level;
    out->n_eff = out->sum_d * out->sum_d / product_of(r, &d, &d);
    /* `top` is a stamp's D before the noise level; if the levels differ, most of it is noise */
    out->top_size = top.size;
    out->top_share = top.size / fmax(fabs(out->sum_d), fabs(component(r, SHEAR_C_D)));
    out->top_stamp = top.size > 0.0 ? top.stamp : -1;
}

/* Compare the level beyond Nyquist with that below it. Each band's error is that of all modes,
 * scaled up for its fewer modes. */
static void fill_shape(shear_result *out, const rounded *r) {
    /* fraction of all modes */
    static const double corners = (4.0 - M_PI) / (4.0 - M_PI * 9.0 / 16.0);
    const double corner_noise = r->t[SHEAR_S_CORNER_NOISE];
    const double edge_noise = component(r, SHEAR_C_HIGH_NOISE) - corner_noise;
    const double edge_galaxy = component(r, SHEAR_C_HIGH_GALAXY) - r->t[SHEAR_S_CORNER_GALAXY];
    if (corner_noise > 0.0 && edge_noise > 0.0 && edge_galaxy > 0.0) {
        const double ratio =
            r->t[SHEAR_S_CORNER_GALAXY] / corner_noise / (edge_galaxy / edge_noise);
        out->noise_shape = ratio - 1.0;
        out->noise_shape_err = ratio * out->noise_level_err / out->noise_level *
                               sqrt(1.0 / corners + 1.0 / (1.0 - corners));
    }
}

static void fill_noise(shear_result *out, const rounded *r) {
    const combination level = of_level(r);
    out->noise_share = component(r, SHEAR_C_NOISE_D) / out->sum_d;
    if (component(r, SHEAR_C_HIGH_GALAXY) > 0.0)
        out->high_galaxy = component(r, SHEAR_C_HIGH_GALAXY) / r->t[SHEAR_S_W];
    if (!(component(r, SHEAR_C_HIGH_NOISE) > 0.0))
        return;
    out->noise_level = r->at_level.level;
    out->noise_level_err = sqrt(fmax(0.0, product_of(r, &level, &level)));
    out->noise_effect = (r->at_level.level - 1.0) * out->noise_share;
    fill_shape(out, r);
}

static void fill_diagnostics(shear_result *r, const double *t) {
    const double n = (double)r->n_used;
    double removed;
    double removed_err;
    r->mean_flux = t[SHEAR_S_FLUX] / n;
    mean_of(t, SHEAR_S_REMOVED, n, &removed, &removed_err);
    r->filter_removed = removed / r->mean_flux;
    r->filter_removed_err = removed_err / fabs(r->mean_flux);
    mean_of(t, SHEAR_S_BORDER_MEAN, n, &r->border_excess, &r->border_excess_err);
    mean_of(t, SHEAR_S_BORDER_VAR, n, &r->border_rough, &r->border_rough_err);
    r->border_noise_var = t[SHEAR_S_BORDER_NOISE] / n;
    mean_of(t, SHEAR_S_BORDER_STEP_X, n, &r->border_step_x, &r->border_step_x_err);
    mean_of(t, SHEAR_S_BORDER_STEP_Y, n, &r->border_step_y, &r->border_step_y_err);
    mean_of(t, SHEAR_S_BORDER_STEP2, n, &r->border_step2, &r->border_step2_err);
}

const char *shear_error_method(const shear_result *r) {
    if (r->jackknife > 0)
        return "jackknife";
    return shear_estimator_is_symmetric(r->estimator) ? "symmetry" : "delta";
}

static rounded round_sums(const shear_field_sums *f) {
    rounded r;
    for (int i = 0; i < SHEAR_N_TERMS; i++)
        r.t[i] = exact_value(f->sums, i);
    r.at_level = shear_ratio_of(r.t + SHEAR_S_COMPONENT);
    return r;
}

/* Return the mean square difference of galaxy and noise stamps at high k, in units of the noise's;
 * INFINITY if the noise has no power there. */
static double difference_at_high_k(const rounded *r) {
    const double noise2 = product(r, SHEAR_C_HIGH_NOISE, SHEAR_C_HIGH_NOISE);
    const double both = product(r, SHEAR_C_HIGH_GALAXY, SHEAR_C_HIGH_NOISE);
    const double galaxy2 = product(r, SHEAR_C_HIGH_GALAXY, SHEAR_C_HIGH_GALAXY);
    return noise2 > 0.0 ? (galaxy2 - 2.0 * both + noise2) / noise2 : INFINITY;
}

/* Return whether the pixels, before anything is subtracted, have flux beyond rounding. */
static bool has_flux(const rounded *r, double n) {
    const double noise = sqrt(r->t[SHEAR_S_BORDER_NOISE] / n);
    return fabs(r->t[SHEAR_S_FLUX] / n) > of_levels_in_flux * noise && noise > 0.0;
}

/* Return whether galaxy and noise stamps are the same. */
static bool no_difference(const rounded *r, double n) {
    const double d2 = product(r, SHEAR_C_D, SHEAR_C_D);
    const double noise2 = product(r, SHEAR_C_NOISE_D, SHEAR_C_NOISE_D);
    const bool at_high_k = difference_at_high_k(r) < of_levels_at_high_k2;
    const double part = at_high_k && !has_flux(r, n) ? of_levels : rounding;
    return noise2 > 0.0 ? d2 < part * part * noise2 : component(r, SHEAR_C_D) == 0.0;
}

/* Return why there is no shear; SHEAR_HAS_SHEAR if there may be one. */
static enum shear_no_shear no_shear(const shear_result *out, const rounded *r, int frame) {
    if (out->n_used < 2)
        return SHEAR_NO_STAMPS;
    if (frame == SHEAR_N_FRAMES)
        return SHEAR_NO_FRAME;
    if (r->t[SHEAR_S_W] == 0.0)
        return SHEAR_NO_WEIGHT;
    if (no_difference(r, (double)out->n_used))
        return SHEAR_NO_DIFFERENCE;
    if (out->signal <= -least_signal)
        return r->t[SHEAR_S_POWER] < 0.0 ? SHEAR_SWAPPED : SHEAR_TOO_NARROW;
    const bool only_one = fabs(out->n_eff - 1.0) < 1e-6; /* stamp counts: its error is unknown */
    return out->signal >= least_signal && !only_one ? SHEAR_HAS_SHEAR : SHEAR_NO_SIGNAL;
}

shear_result result_unknown(void) {
    shear_result r = {.top_stamp = -1};
    r.g1 = r.g2 = r.g1_err = r.g2_err = r.cov12 = r.delta_g1_err = r.delta_g2_err = NAN;
    r.signal = r.n_eff = r.top_share = NAN;
    r.noise_level = r.noise_level_err = r.noise_effect = r.noise_share = r.high_galaxy = NAN;
    r.noise_shape = r.noise_shape_err = NAN;
    r.resolution = NAN;
    r.mean_flux = r.filter_removed = r.filter_removed_err = NAN;
    r.border_excess = r.border_excess_err = r.border_rough = r.border_rough_err = NAN;
    r.border_noise_var = r.border_step_x = r.border_step_x_err = NAN;
    r.border_step_y = r.border_step_y_err = r.border_step2 = r.border_step2_err = NAN;
    return r;
}

void shear_field_result(const shear_field_sums *f, shear_result *out) {
    const rounded r = round_sums(f);
    const double n = (double)f->n_used;
    *out = result_unknown();
    out->n_stamps = f->n_stamps;
    out->n_used = f->n_used;
    out->n_flagged = f->n_stamps - f->n_used;
    memcpy(out->flagged, f->flagged, sizeof out->flagged);
    out->sum_weight = r.t[SHEAR_S_W];
    out->sum_d = r.at_level.d;
    if (f->n_used >= 2) {
        fill_diagnostics(out, r.t);
        fill_noise(out, &r);
        fill_influence(out, &r, f->top);
        fill_resolution(out, &r);
        out->signal = out->sum_d / noise_of_d(&r, n, out->noise_level_err);
    }
    out->why = no_shear(out, &r, shear_field_sums_frame(f));
    if (out->why == SHEAR_HAS_SHEAR) {
        fill_shear(out, &r);
        out->valid = isfinite(out->g1) && isfinite(out->g2);
        out->why = out->valid ? SHEAR_HAS_SHEAR : SHEAR_NOT_FINITE;
    }
}

noise_shape noise_shape_of(const shear_field_sums *f) {
    const rounded r = round_sums(f);
    const double high = component(&r, SHEAR_C_HIGH_NOISE);
    if (!(high > 0.0))
        return (noise_shape){0};
    return (noise_shape){.n1 = component(&r, SHEAR_C_NOISE_N1) / high,
                         .n2 = component(&r, SHEAR_C_NOISE_N2) / high,
                         .d = component(&r, SHEAR_C_NOISE_D) / high,
                         .u = r.t[SHEAR_S_NOISE_U] / high,
                         .v = r.t[SHEAR_S_NOISE_V] / high};
}
