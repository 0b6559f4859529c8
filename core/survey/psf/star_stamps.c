/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/star_stamps.h"

#include "base/cleanup.h"
#include "base/sort.h"
#include "base/text.h"
#include "survey/psf/mode_fit.h"
#include "survey/psf/places.h"
#include "survey/psf/star_power.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROUNDS = 10,     /* of leaving out stars */
    LEAST_STARS = 5, /* of which outliers can be told */
    FLAGS_BAD = 4,   /* SExtractor: saturated, cut off, damaged */
    MOST_STARS = 100000
};
/* Fluxes are compared at modes where |W|^2 is above this. */
static const double bright_modes = 0.5;
/* They agree well enough then. */
static const double flux_accuracy = 1e-3;
/* An outlier's chi-square is more than this many standard deviations above the median. */
static const double outlier_sigmas = 5.0;
/* Stamps whose median chi-square is larger are not all of stars. */
static const double worst_chi2 = 10.0;
/* No star is an outlier below this chi-square. */
static const double least_chi2 = 3.0;
/* Error of the |W|^2 of a model at best, over |W|. */
static const double accuracy = 0.02;

/* The stamps of one table. */
typedef struct star_table {
    psf_record record;
    const sf_column *stamps, *weights; /* weights: NULL if there are none */
    int nx, ny, n;
    bool cell; /* all stamps are in one cell */
} star_table;

static void close_table(star_table *t) {
    psf_record_deinit(&t->record);
}

/* ---- the table ---- */

static int find_columns(star_table *t, shear_error *err) {
    const sf_table *table = &t->record.table;
    TRY(sf_table_find(table, "VIGNET", &t->stamps, err));
    const char *name = t->stamps != NULL ? "VIGNET" : "IMAGE";
    TRY(sf_table_find(table, name, &t->stamps, err));
    if (t->stamps == NULL)
        return SHEAR_OK;
    TRY(sf_table_find_numbers(table, name, &t->stamps, err));
    TRY(sf_table_find(table, "WEIGHT", &t->weights, err));
    if (t->weights != NULL && t->weights->repeat != t->stamps->repeat)
        t->weights = NULL; /* a weight of each star, not of its pixels */
    return t->weights != NULL ? sf_table_find_numbers(table, "WEIGHT", &t->weights, err) : SHEAR_OK;
}

/* Open the table and find its stamps; t->stamps is NULL if it has none. */
static int open_table(star_table *t, const psf_models *p, const sf_hdu *hdu, shear_error *err) {
    int64_t axes[SF_AXES];
    TRY(psf_record_init(&t->record, &p->file, hdu, err));
    TRY(find_columns(t, err));
    if (t->stamps == NULL)
        return SHEAR_OK;
    TRY(sf_table_shape(&t->record.table, t->stamps, axes, err));
    t->cell = axes[2] > 1;
    const int64_t n = t->cell ? axes[2] : t->record.rows;
    if (axes[0] < 8 || axes[1] < 8 || axes[0] > PSF_SIDE || axes[1] > PSF_SIDE || n > MOST_STARS ||
        (t->cell && t->record.rows != 1)) {
        return psf_record_fail(&t->record, t->stamps->name,
                               "must hold a stamp of 8 x 8 to 1024 x 1024 pixels per row (TDIMn), "
                               "or those of at most 100000 stars in one row",
                               err);
    }
    t->nx = (int)axes[0];
    t->ny = (int)axes[1];
    t->n = (int)n;
    return SHEAR_OK;
}

/* Read stamp i of a column, out[ny][nx]. */
static int read_stamp(const star_table *t, const sf_column *column, int i, double *out,
                      shear_error *err) {
    sf_column one = *column;
    one.repeat = (int64_t)t->nx * t->ny;
    one.offset += t->cell ? i * (column->width / t->n) : 0;
    return sf_table_cell(&t->record.table, &one, t->cell ? 0 : i, out, err);
}

/* Return, in bad[n], which stars have FLAGS >= 4. */
static int read_flags(const star_table *t, double *flags, shear_error *err) {
    const sf_column *column = NULL;
    TRY(sf_table_find(&t->record.table, "FLAGS", &column, err));
    if (column == NULL || t->cell)
        return SHEAR_OK;
    TRY(sf_table_find_number(&t->record.table, "FLAGS", &column, err));
    return sf_table_doubles(&t->record.table, column, 0, t->n, flags, err);
}

/* Return the weight of a star: the variance of its bright modes is in proportion to its noise. */
static double weight_of(double level) {
    return 1.0 / (level + 1e-4);
}

/* Compute the spectra of all stars, and their noise in the same units; NaN: the star cannot be
 * used. */
static int compute_spectra(const star_table *t, mode_spectra *s, double *level, shear_error *err) {
    const size_t pixels = (size_t)t->nx * (size_t)t->ny;
    CLEANUP(release_free) double *stamp = calloc(2 * pixels, sizeof *stamp);
    CLEANUP(release_free) double *flags = calloc((size_t)t->n, sizeof *flags);
    CLEANUP(star_power_deinit) star_power power = {0};
    if (stamp == NULL || flags == NULL || !star_power_init(&power, t->nx, t->ny, s->stamp))
        return sf_fail_memory(err, t->record.cards.at);
    TRY(read_flags(t, flags, err));
    for (int i = 0; i < t->n; i++) {
        double *weights = t->weights != NULL ? stamp + pixels : NULL;
        TRY(read_stamp(t, t->stamps, i, stamp, err));
        if (weights != NULL)
            TRY(read_stamp(t, t->weights, i, weights, err));
        const bool used = flags[i] < FLAGS_BAD &&
                          star_power_of(&power, stamp, weights, mode_spectra_of(s, i), &level[i]);
        s->weight[i] = used ? weight_of(level[i]) : 0.0;
        level[i] = used ? level[i] : NAN;
    }
    return SHEAR_OK;
}

/* ---- outliers ---- */

static int count_used(const mode_spectra *s) {
    int n = 0;
    for (int i = 0; i < s->n; i++)
        n += s->weight[i] > 0.0 ? 1 : 0;
    return n;
}

static int degree_of(int stars) {
    return stars < 12 ? 0 : stars < 30 ? 1 : 2;
}

/* Return chi-square per mode of star i, of modes where the model is above its noise. */
static double chi2_of(const mode_spectra *s, int i, double level, const double *model) {
    const double *power = mode_spectra_of(s, i);
    double sum = 0.0;
    int n = 0;
    for (int j = 0; j < s->stamp * s->stamp; j++) {
        const double m = fmax(model[j], 0.0);
        if (m < level || m < 1e-3)
            continue;
        const double d = power[j] - model[j];
        sum += d * d / (level * level + 2.0 * level * m + accuracy * accuracy * m);
        n++;
    }
    return n > 0 ? sum / n : level; /* NaN if that is NaN */
}

/* Return the median of n values, which are sorted. */
static double median_of(double *values, int n) {
    sort_doubles(values, (size_t)n);
    return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/* Return the median chi-square of the stars in use, and the largest that is no outlier. */
static double median_chi2(const mode_spectra *s, const double *chi2, double *scratch,
                          double *largest) {
    int n = 0;
    for (int i = 0; i < s->n; i++) {
        if (s->weight[i] > 0.0)
            scratch[n++] = chi2[i];
    }
    const double median = median_of(scratch, n);
    for (int i = 0; i < n; i++)
        scratch[i] = fabs(scratch[i] - median);
    *largest = fmax(median + outlier_sigmas * 1.4826 * median_of(scratch, n), least_chi2);
    return median;
}

/* Leave out stars that differ from the model, and use those that do so no more; *median is their
 * chi-square. Return how many were changed. */
static int choose_stars(const psf_chip *c, const psf_places *places, mode_spectra *s,
                        const double *level, double *scratch, double *median) {
    double *chi2 = scratch;
    double *model = scratch + 2 * (size_t)s->n;
    double limit = 0.0;
    int changed = 0;
    for (int i = 0; i < s->n; i++) {
        mode_fit_at(c, places, i, model);
        chi2[i] = chi2_of(s, i, level[i], model);
    }
    *median = median_chi2(s, chi2, scratch + s->n, &limit);
    for (int i = 0; i < s->n; i++) { /* stars that cannot be used have a chi-square of NaN */
        const double weight = chi2[i] <= limit ? weight_of(level[i]) : 0.0;
        changed += (weight > 0.0) != (s->weight[i] > 0.0) ? 1 : 0;
        s->weight[i] = weight;
    }
    return changed;
}

/* ---- fluxes ---- */

/* Return the factor by which the spectrum exceeds the model at bright modes, k = 0 apart, if the
 * model is divided by its own value at 0. */
static double excess_of(const double *power, const double *model, int stamp) {
    const int zero = stamp / 2 * (stamp + 1);
    double both = 0.0;
    double square = 0.0;
    for (int j = 0; j < stamp * stamp; j++) {
        if (model[j] > bright_modes && j != zero) {
            both += power[j] * model[j];
            square += model[j] * model[j];
        }
    }
    return square > 0.0 ? both / square * star_power_at_zero(model, stamp) : 1.0;
}

/* Divide each spectrum by its excess: a flux that all bright modes agree on is less noisy than one
 * extrapolated to k = 0. Return the largest change. */
static double scale_fluxes(const psf_chip *c, const psf_places *places, mode_spectra *s,
                           double *level, double *model) {
    double most = 0.0;
    for (int i = 0; i < s->n; i++) {
        double *power = mode_spectra_of(s, i);
        mode_fit_at(c, places, i, model);
        const double excess = excess_of(power, model, s->stamp);
        if (!(excess > 0.1 && excess < 10.0))
            continue;
        for (int j = 0; j < s->stamp * s->stamp; j++)
            power[j] /= excess;
        level[i] /= excess;
        most = s->weight[i] > 0.0 ? fmax(most, fabs(excess - 1.0)) : most;
    }
    return most;
}

/* Make the model 1 at k = 0, in the middle of the places and, for k = 0 itself, everywhere. */
static int normalize(psf_chip *c, sf_place at, shear_error *err) {
    const int stamp = c->model.nx;
    const size_t modes = (size_t)stamp * (size_t)stamp;
    const double at_zero = star_power_at_zero(c->samples, stamp);
    if (!(at_zero > 0.0))
        return sf_fail(err, SHEAR_E_PSF, at, "use brighter stars", "the stars have too much noise");
    for (size_t i = 0; i < modes * (size_t)c->model.terms; i++)
        c->samples[i] /= at_zero;
    for (int t = 0; t < c->model.terms; t++)
        c->samples[modes * (size_t)t + (size_t)(stamp / 2 * (stamp + 1))] = t == 0 ? 1.0 : 0.0;
    return SHEAR_OK;
}

/* Fit, compare fluxes, leave out outliers, and fit again until nothing changes. *median is the
 * chi-square of the stars; unchanged if there are few. */
static int fit(psf_chip *c, const psf_places *places, mode_spectra *s, double *level,
               double *median, sf_place at, shear_error *err) {
    const size_t modes = (size_t)s->stamp * (size_t)s->stamp;
    CLEANUP(release_free) double *scratch = calloc(2 * (size_t)s->n + modes, sizeof *scratch);
    bool settled = false;
    if (scratch == NULL)
        return sf_fail_memory(err, at);
    TRY(mode_fit(c, places, s, degree_of(count_used(s)), at, err));
    for (int round = 0; round < ROUNDS && !settled; round++) {
        settled = scale_fluxes(c, places, s, level, scratch) < flux_accuracy;
        if (count_used(s) >= LEAST_STARS && choose_stars(c, places, s, level, scratch, median) > 0)
            settled = false;
        TRY(mode_fit(c, places, s, degree_of(count_used(s)), at, err));
    }
    return normalize(c, at, err);
}

/* ---- models ---- */

/* Write what the model was made from, or why there is no model: a catalog of all sources is no
 * catalog of stars. */
static void describe(psf_chip *c, const star_table *t, int used, int usable, double chi2) {
    c->failed = 2 * used < t->n || chi2 > worst_chi2;
    if (2 * used < t->n) {
        text_append(c->text, sizeof c->text,
                    "stars, failed: only %d of %d stamps look like stars of one PSF", used, t->n);
    } else if (c->failed) {
        text_append(c->text, sizeof c->text,
                    "stars, failed: the stamps differ too much, chi2/dof %.1f; are there galaxies "
                    "among them?",
                    chi2);
    }
    if (c->failed)
        return;
    text_append(c->text, sizeof c->text, "power of stars, %d x %d px", t->nx, t->ny);
    psf_chip_describe(c);
    text_append(c->text, sizeof c->text, ", %d of %d stars (%d outliers)", used, t->n,
                usable - used);
    if (!isnan(chi2))
        text_append(c->text, sizeof c->text, ", chi2/dof %.2f", chi2);
}

static int read_table(psf_models *p, const star_table *t, shear_error *err) {
    CLEANUP(psf_places_deinit) psf_places places = {0};
    CLEANUP(mode_spectra_deinit) mode_spectra s = {0};
    const sf_place at = t->record.cards.at;
    CLEANUP(release_free) double *level = calloc((size_t)t->n, sizeof *level);
    psf_chip *c = NULL;
    double chi2 = NAN;
    if (level == NULL)
        return sf_fail_memory(err, at);
    TRY(psf_places_init(&places, &t->record, t->n, err));
    TRY(mode_spectra_init(&s, t->n, p->stamp, at, err));
    TRY(compute_spectra(t, &s, level, err));
    TRY(psf_chip_new(p, &c, err));
    psf_places_set_variables(&places, c);
    const int usable = count_used(&s);
    if (usable > 0)
        TRY(fit(c, &places, &s, level, &chi2, at, err));
    c->stars = count_used(&s);
    describe(c, t, count_used(&s), usable, chi2);
    return SHEAR_OK;
}

static int read_hdu(psf_models *p, const sf_hdu *hdu, shear_error *err) {
    CLEANUP(close_table) star_table t = {0};
    TRY(open_table(&t, p, hdu, err));
    return t.stamps != NULL ? read_table(p, &t, err) : SHEAR_OK;
}

int star_stamps_read(psf_models *p, shear_error *err) {
    for (int i = 0; i < p->file.count; i++) {
        const sf_hdu *hdu = &p->file.hdus[i];
        if ((p->chosen == NULL || p->chosen == hdu) && psf_record_is_table(hdu))
            TRY(read_hdu(p, hdu, err));
    }
    return SHEAR_OK;
}
