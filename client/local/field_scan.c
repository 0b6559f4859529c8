/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/field_scan.h"

#include "base/cleanup.h"

#include "local/weight_check.h"

#include "shear/symmetry.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { BLOCK_BYTES = 8 << 20, MAX_BLOCK = 256 };

/* Sums over noise stamps: mean pixels, their squares, and the variances of the pixels. Means are
 * relative to the first one, because a bright sky would cost precision. */
typedef struct noise_levels {
    double n, first, mean, mean2, var;
} noise_levels;

typedef struct scan_state {
    const shear_plan *plan;
    shear_workspace *ws;
    bool is_log;
    double pedestal;
    shear_block *block;
    shear_row *rows; /* [block->capacity] */
    noise_levels levels;
    weight_check weights;
    shear_block_sums under_way;
    shear_field_sums *sums;
    chip_scan *chips;
    sheard_validation_report *v;
} scan_state;

typedef struct pixel_statistics {
    double lowest; /* of the finite pixels */
    double mean, var;
} pixel_statistics;

/* Collect statistics of n pixels. `bad`: the setting bad-value; a file of floats holds the nearest
 * float. */
static pixel_statistics look_at(const double *pixel, size_t n, double bad) {
    double narrow = fabs(bad) <= (double)FLT_MAX ? (double)(float)bad : bad;
    pixel_statistics p = {.lowest = INFINITY};
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(pixel[i]) && pixel[i] < p.lowest && pixel[i] != bad && pixel[i] != narrow)
            p.lowest = pixel[i];
        double d = pixel[i] - pixel[0]; /* relative to the first: see noise_levels */
        sum += d;
        squares += d * d;
    }
    p.mean = pixel[0] + sum / (double)n;
    p.var = fmax(0.0, squares / (double)n - sum / (double)n * (sum / (double)n));
    return p;
}

/* Treat all noise stamps of stamp i as one. */
static pixel_statistics look_at_noise(const shear_stamps *t, int i, double bad) {
    const int planes = t->noise_planes > 1 ? t->noise_planes : 1;
    const size_t n = (size_t)t->nx * (size_t)t->ny;
    pixel_statistics all = {.lowest = INFINITY};
    for (int k = 0; k < planes; k++) {
        pixel_statistics p =
            look_at(t->noise + ((size_t)i * (size_t)planes + (size_t)k) * n, n, bad);
        all.lowest = fmin(all.lowest, p.lowest);
        all.mean += p.mean / planes;
        all.var += p.var / planes;
    }
    return all;
}

static void levels_add(noise_levels *l, const pixel_statistics *noise) {
    l->first = l->n > 0.0 ? l->first : noise->mean;
    double d = noise->mean - l->first;
    l->n += 1.0;
    l->mean += d;
    l->mean2 += d * d;
    l->var += noise->var;
}

static void set_noise(const noise_levels *l, sheard_validation_report *v) {
    double mean = l->mean / l->n;
    double scatter2 = fmax(0.0, l->mean2 / l->n - mean * mean);
    v->noise_mean = l->first + mean; /* 0/0 if there are no noise stamps */
    v->noise_mean_err = l->n > 1.0 ? sqrt(scatter2 / (l->n - 1.0)) : NAN;
    v->noise_rms = sqrt(l->var / l->n);
}

static void fault_add(sheard_fault *f, int64_t index) {
    if (f->count < SHEARD_FAULT_SAMPLES)
        f->first[f->count] = index;
    f->count++;
}

/* Return whether the stamp has an artefact: its lowest pixel may then not be typical. */
static bool has_artefact(unsigned flags) {
    return (flags & ((unsigned)SHEAR_FLAG_ARTEFACT | (unsigned)SHEAR_FLAG_NOISE_ARTEFACT)) != 0;
}

/* Determine everything about stamp i that needs no measurement; *flags gets all flags except
 * SHEAR_FLAG_OVERFLOW. */
static int look_at_stamp(scan_state *s, const shear_stamps *t, int i, unsigned *flags,
                         shear_error *err) {
    size_t n = (size_t)t->nx * (size_t)t->ny;
    double bad = shear_plan_get_settings(s->plan)->bad_value;
    pixel_statistics galaxy = look_at(t->galaxy + (size_t)i * n, n, bad);
    pixel_statistics noise = look_at_noise(t, i, bad);
    shear_row row;
    TRY(shear_examine(s->plan, s->ws, t, i, &row, err));
    *flags = row.flags;
    if (!has_artefact(row.flags))
        s->v->lowest_pixel = fmin(s->v->lowest_pixel, fmin(galaxy.lowest, noise.lowest));
    if (row.flags == 0)
        levels_add(&s->levels, &noise);
    if (row.flags == 0 && s->is_log && fmin(galaxy.lowest, noise.lowest) + s->pedestal < 0.0)
        fault_add(&s->v->negative, t->first + i);
    return SHEAR_OK;
}

static void count_flags(sheard_validation_report *v, unsigned flags, int64_t index) {
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        if (flags & (1u << bit))
            fault_add(&v->flags[bit], index);
    }
    v->n_measurable += flags == 0;
}

/* Add the row in the same blocks as shearctl measure, so that the result is the same to the last
 * bit. */
static void add_row(scan_state *s, const shear_row *row, int64_t index) {
    shear_block_sums_add(&s->under_way, row);
    if ((index + 1) % SHEAR_BLOCK == 0) {
        shear_field_sums_add(s->sums, &s->under_way);
        shear_block_sums_init(&s->under_way);
    }
}

static int scan_block(scan_state *s, shear_error *err) {
    const shear_stamps *t = &s->block->stamps;
    unsigned flags[MAX_BLOCK];
    for (int i = 0; i < t->count; i++)
        TRY(look_at_stamp(s, t, i, &flags[i], err));
    /* A log method fails for stamps with negative pixels; those are reported instead. */
    const bool measured = s->v->negative.count == 0;
    if (measured) {
        TRY(shear_measure_batch(s->plan, t, 0, NULL, s->rows, err));
        for (int i = 0; i < t->count; i++) {
            flags[i] |= s->rows[i].flags;
            add_row(s, &s->rows[i], t->first + i);
        }
    }
    for (int i = 0; i < t->count; i++) {
        count_flags(s->v, flags[i], t->first + i);
        TRY(chip_scan_add(s->chips, s->block, i, flags[i], measured ? &s->rows[i] : NULL, err));
        if (flags[i] == 0)
            weight_check_add(&s->weights, t, i);
    }
    return SHEAR_OK;
}

static int block_capacity(const shear_field_info *info) {
    const shear_geometry *g = &info->geometry;
    const int planes = info->noise_planes;
    size_t pair = (1 + (size_t)planes) * sizeof(double) * (size_t)g->nx * (size_t)g->ny;
    size_t psf = sizeof(double) * (size_t)g->psf_nx * (size_t)g->psf_ny;
    size_t fit = BLOCK_BYTES / (pair + psf);
    return fit < 1 ? 1 : fit > MAX_BLOCK ? MAX_BLOCK : (int)fit;
}

static int scan_init(scan_state *s, const shear_field_info *info, shear_error *err) {
    shear_block_sums_init(&s->under_way);
    TRY(shear_field_sums_new(&s->sums, err));
    TRY(shear_block_new(&s->block, info, block_capacity(info), err));
    s->rows = calloc((size_t)s->block->capacity, sizeof *s->rows);
    return s->rows == NULL ? shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory")
                           : shear_workspace_new(&s->ws, s->plan, err);
}

static int scan(scan_state *s, shear_field *field, progress *bar, shear_error *err) {
    const int64_t total = shear_field_get_info(field)->n_stamps;
    TRY(scan_init(s, shear_field_get_info(field), err));
    for (int64_t first = 0; first < total; first += s->block->capacity) {
        const int64_t left = total - first;
        const int count = left < s->block->capacity ? (int)left : s->block->capacity;
        TRY(shear_field_read(field, first, count, s->block, err));
        TRY(scan_block(s, err));
        if (progress_callback(bar, first + count, total) != 0)
            return shear_fail(err, SHEAR_E_CANCELLED, NULL, "interrupted");
    }
    return chip_scan_finish(s->chips, s->v, err);
}

static void scan_deinit(scan_state *s) {
    weight_check_deinit(&s->weights);
    free(s->rows);
    shear_workspace_free(s->ws);
    shear_block_free(s->block);
    shear_field_sums_free(s->sums);
}

/* Report the result of the mean under the name of the estimator that was requested. */
static void set_estimator(shear_result *r, enum shear_estimator estimator) {
    r->estimator = estimator;
    if (shear_estimator_is_symmetric(estimator) && r->valid && r->n_used < SHEAR_SYMMETRY_FEWEST) {
        r->valid = false;
        r->why = SHEAR_NO_SYMMETRY;
        r->g1 = r->g2 = r->g1_err = r->g2_err = r->cov12 = NAN;
    }
}

int field_scan(shear_field *field, const shear_plan *plan, chip_scan *chips, progress *bar,
               sheard_validation_report *v, shear_error *err) {
    const shear_plan_info *resolved = shear_plan_get_info(plan);
    CLEANUP(scan_deinit) scan_state s = {.plan = plan, .chips = chips, .v = v};
    s.is_log = shear_interpolation_is_log(resolved->interpolation);
    s.pedestal = shear_plan_get_settings(plan)->pedestal;
    v->lowest_pixel = INFINITY;
    const int code = scan(&s, field, bar, err);
    v->scanned = code == SHEAR_OK;
    v->measured = v->scanned && v->negative.count == 0;
    set_noise(&s.levels, v);
    const rank_relation relation = rank_relate(s.weights.weight, s.weights.flux, s.weights.n);
    v->weight_follows_flux = relation.correlation;
    v->weight_is_suspect = rank_is_strong(&relation);
    if (v->measured) {
        shear_field_sums_add(s.sums, &s.under_way);
        shear_field_result(s.sums, &v->result);
        set_estimator(&v->result, shear_plan_get_settings(plan)->estimator);
    }
    return code;
}
