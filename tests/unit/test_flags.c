/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reasons to leave a stamp out: each flag by itself and together with others, the NaNs of
 * flagged rows, and unchanged neighbours in the batch. */
#include "batch.h"
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const shear_geometry geometry = {
    .nx = 18, .ny = 17, .psf_nx = 15, .psf_ny = 11, .psf_oversample = 1};
enum { COUNT = 9, PIXELS = 18 * 17, SAMPLES = 15 * 11, BAD = 4 };

static void assert_no_numbers(const shear_row *row) {
    const double numbers[] = {
        row->n1,  row->n2,           row->d,           row->u,          row->v,
        row->m20, row->m02,          row->m11,         row->m4,         row->flux,
        row->snr, row->flux_removed, row->border_mean, row->border_var, row->border_var_noise};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        assert_true(isnan(numbers[i]));
}

/* Measure COUNT stamps, the one in the middle spoilt by `spoil`: it carries `flags`, and every
 * other row is as without it. */
static void check(const shear_settings *settings, void (*spoil)(batch *), uint32_t flags) {
    batch b;
    shear_row before[COUNT];
    shear_row after[COUNT];
    batch_init(&b, COUNT, &geometry, 1.2, 40);
    b.psf_index[BAD] = BAD;
    for (int i = 0; i < COUNT; i++)
        b.psf_index[i] = i != BAD && b.psf_index[i] == BAD ? 0 : b.psf_index[i];
    shear_plan *plan = batch_plan(&b, settings, true, true);
    const shear_stamps stamps = batch_full(&b);
    batch_measure(plan, &stamps, before);
    spoil(&b);
    batch_measure(plan, &stamps, after);
    for (int i = 0; i < COUNT; i++) {
        if (i == BAD) {
            assert_int_equal(after[i].flags, flags);
            assert_no_numbers(&after[i]);
            assert_true(after[i].weight == b.weight[i] || isnan(b.weight[i]));
        } else {
            assert_int_equal(after[i].flags, 0);
            assert_same_rows(&after[i], &before[i], 1);
        }
    }
    shear_plan_free(plan);
    batch_deinit(&b);
}

static void galaxy_nan(batch *b) {
    b->galaxy[BAD * PIXELS + PIXELS - 1] = NAN;
}

static void galaxy_infinite(batch *b) {
    b->galaxy[BAD * PIXELS] = -INFINITY;
}

static void noise_nan(batch *b) {
    b->noise[BAD * PIXELS + 77] = -NAN;
}

static void noise_infinite(batch *b) {
    b->noise[BAD * PIXELS + PIXELS - 1] = INFINITY;
}

static void masked(batch *b) {
    b->mask[BAD] = INT32_MIN;
}

static void constant(batch *b) {
    for (int i = 0; i < PIXELS; i++)
        b->galaxy[BAD * PIXELS + i] = 0.7;
}

static void zero(batch *b) {
    memset(b->galaxy + BAD * PIXELS, 0, PIXELS * sizeof(double));
}

static void negative_weight(batch *b) {
    b->weight[BAD] = -1e-300;
}

static void tiny_weight(batch *b) {
    b->weight[BAD] = 1e-300;
}

static void nan_weight(batch *b) {
    b->weight[BAD] = NAN;
}

static void infinite_weight(batch *b) {
    b->weight[BAD] = INFINITY;
}

static void no_r_gal(batch *b) {
    b->r_gal[BAD] = NAN;
}

static void zero_r_gal(batch *b) {
    b->r_gal[BAD] = 0.0;
}

static void infinite_r_gal(batch *b) {
    b->r_gal[BAD] = INFINITY;
}

static void scale(batch *b, double a) {
    for (int i = 0; i < PIXELS; i++) {
        b->galaxy[BAD * PIXELS + i] *= a;
        b->noise[BAD * PIXELS + i] *= a;
    }
}

static void huge(batch *b) {
    scale(b, 1e200);
}

static void largest(batch *b) {
    scale(b, DBL_MAX / 8.0);
}

/* The moments are finite, but the squares that the field's errors need are not. */
static void large(batch *b) {
    scale(b, 1e120);
}

static void huge_noise(batch *b) {
    b->noise[BAD * PIXELS + 5] = 1e250;
}

static void large_weight(batch *b) {
    b->weight[BAD] = 1e200;
}

static void psf_nan(batch *b) {
    b->psf[BAD * SAMPLES + 3] = NAN;
}

static void psf_zero(batch *b) {
    memset(b->psf + BAD * SAMPLES, 0, SAMPLES * sizeof(double));
}

/* Two points 9 px apart: W = cos(4.5 kx) is zero at the first mode of 18 px, long before the
 * target's power ends. */
static void psf_double(batch *b) {
    psf_zero(b);
    b->psf[BAD * SAMPLES + 5 * 15 + 3] = 1.0;
    b->psf[BAD * SAMPLES + 5 * 15 + 12] = 1.0;
}

static void psf_missing(batch *b) {
    b->psf_index[BAD] = -1;
}

static void psf_beyond(batch *b) {
    b->psf_index[BAD] = COUNT;
}

static const struct {
    void (*spoil)(batch *);
    uint32_t flags;
} cases[] = {
    {galaxy_nan, SHEAR_FLAG_GALAXY_NOT_FINITE},
    {galaxy_infinite, SHEAR_FLAG_GALAXY_NOT_FINITE},
    {noise_nan, SHEAR_FLAG_NOISE_NOT_FINITE},
    {noise_infinite, SHEAR_FLAG_NOISE_NOT_FINITE},
    {masked, SHEAR_FLAG_MASKED},
    {constant, SHEAR_FLAG_EMPTY},
    {zero, SHEAR_FLAG_EMPTY},
    {negative_weight, SHEAR_FLAG_BAD_WEIGHT},
    {tiny_weight, SHEAR_FLAG_BAD_WEIGHT},
    {nan_weight, SHEAR_FLAG_BAD_WEIGHT},
    {infinite_weight, SHEAR_FLAG_BAD_WEIGHT},
    {no_r_gal, SHEAR_FLAG_BAD_R_GAL},
    {zero_r_gal, SHEAR_FLAG_BAD_R_GAL},
    {infinite_r_gal, SHEAR_FLAG_BAD_R_GAL},
    {huge, SHEAR_FLAG_OVERFLOW},
    {large, SHEAR_FLAG_OVERFLOW},
    {largest, SHEAR_FLAG_OVERFLOW},
    {huge_noise, SHEAR_FLAG_OVERFLOW},
    {large_weight, SHEAR_FLAG_OVERFLOW},
    {psf_nan, SHEAR_FLAG_PSF_UNUSABLE},
    {psf_zero, SHEAR_FLAG_PSF_UNUSABLE},
    {psf_double, SHEAR_FLAG_PSF_UNUSABLE},
    {psf_missing, SHEAR_FLAG_PSF_UNUSABLE},
    {psf_beyond, SHEAR_FLAG_PSF_UNUSABLE},
};

static void test_each_flag(void **state) {
    (void)state;
    for (int m = 0; m < PAIR_METHODS; m += 2) { /* none, bicubic, log-bilinear, log-spline */
        shear_settings settings;
        shear_settings_init(&settings);
        settings.artefacts = SHEAR_ARTEFACTS_KEEP; /* one pixel of 1e200 would be one */
        assert_int_equal(shear_settings_set(&settings, "interpolation", pair_methods[m], NULL),
                         SHEAR_OK);
        for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
            check(&settings, cases[i].spoil, cases[i].flags);
    }
}

static void several(batch *b) {
    galaxy_nan(b);
    noise_infinite(b);
    masked(b);
    nan_weight(b);
    no_r_gal(b);
}

static void empty_and_masked(batch *b) {
    constant(b);
    masked(b);
}

static void test_several_flags(void **state) {
    (void)state;
    shear_settings settings;
    shear_settings_init(&settings);
    check(&settings, several,
          SHEAR_FLAG_GALAXY_NOT_FINITE | SHEAR_FLAG_NOISE_NOT_FINITE | SHEAR_FLAG_MASKED |
              SHEAR_FLAG_BAD_WEIGHT | SHEAR_FLAG_BAD_R_GAL);
    check(&settings, empty_and_masked, SHEAR_FLAG_EMPTY | SHEAR_FLAG_MASKED);
}

/* R_GAL matters only where the filter follows it; a weight of zero is a weight. */
static void test_not_flagged(void **state) {
    (void)state;
    batch b;
    shear_row rows[COUNT];
    shear_settings settings;
    batch_init(&b, COUNT, &geometry, 1.2, 41);
    shear_settings_init(&settings);
    settings.filter = SHEAR_FILTER_NONE;
    b.r_gal[2] = NAN;
    b.weight[3] = 0.0;
    b.weight[4] = 1e-100;
    shear_plan *plan = batch_plan(&b, &settings, false, true);
    const shear_stamps stamps = batch_full(&b);
    batch_measure(plan, &stamps, rows);
    for (int i = 0; i < COUNT; i++) {
        assert_int_equal(rows[i].flags, 0);
        assert_true(isfinite(rows[i].d) && rows[i].weight == b.weight[i]);
    }
    shear_plan_free(plan);
    batch_deinit(&b);
}

/* Every row is counted, by flag; flagged ones add nothing to the sums. */
static void test_counts(void **state) {
    (void)state;
    batch b;
    shear_row rows[COUNT];
    shear_settings settings;
    shear_block_sums all;
    shear_block_sums good;
    batch_init(&b, COUNT, &geometry, 1.2, 41);
    shear_settings_init(&settings);
    shear_plan *plan = batch_plan(&b, &settings, true, true);
    const shear_stamps stamps = batch_full(&b);
    several(&b);
    b.mask[0] = 1;
    b.galaxy[PIXELS] = NAN;
    batch_measure(plan, &stamps, rows);
    shear_block_sums_init(&all);
    shear_block_sums_init(&good);
    for (int i = 0; i < COUNT; i++) {
        shear_block_sums_add(&all, &rows[i]);
        if (rows[i].flags == 0)
            shear_block_sums_add(&good, &rows[i]);
    }
    assert_int_equal(all.n_stamps, COUNT);
    assert_int_equal(all.n_used, COUNT - 3);
    const int64_t expected[SHEAR_N_FLAGS] = {2, 1, 2, 0, 0, 1, 1, 0};
    assert_memory_equal(all.flagged, expected, sizeof expected);
    assert_memory_equal(all.hi, good.hi, sizeof all.hi);
    assert_memory_equal(all.lo, good.lo, sizeof all.lo);
    shear_plan_free(plan);
    batch_deinit(&b);
}

static void test_names(void **state) {
    (void)state;
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        assert_true(strlen(shear_flag_name(i)) > 3 && strlen(shear_flag_help(i)) > 10);
        for (int j = 0; j < i; j++)
            assert_string_not_equal(shear_flag_name(i), shear_flag_name(j));
    }
    assert_string_equal(shear_flag_name(0), "galaxy_not_finite");
    assert_string_equal(shear_flag_name(7), "overflow");
    assert_null(shear_flag_name(-1));
    assert_null(shear_flag_name(SHEAR_N_FLAGS));
    assert_null(shear_flag_help(-1));
    assert_null(shear_flag_help(SHEAR_N_FLAGS));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_flag),   cmocka_unit_test(test_several_flags),
        cmocka_unit_test(test_not_flagged), cmocka_unit_test(test_counts),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
