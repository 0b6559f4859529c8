/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many stamps through one plan: PSFs of their own, independence of the neighbours, and errors
 * that name the stamp. */
#include "batch.h"
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include <math.h>
#include <string.h>

static const shear_geometry geometry = {
    .nx = 20, .ny = 21, .psf_nx = 13, .psf_ny = 12, .psf_oversample = 1};
enum { COUNT = 12, PIXELS = 20 * 21, SAMPLES = 13 * 12 };

static void use(shear_settings *settings, int method) {
    shear_settings_init(settings);
    settings->artefacts = SHEAR_ARTEFACTS_KEEP; /* images of any kind */
    assert_int_equal(shear_settings_set(settings, "interpolation", pair_methods[method], NULL),
                     SHEAR_OK);
}

/* A PSF that comes with the stamps gives the same bits as one in the plan. */
static void test_psf_of_plan_or_stamp(void **state) {
    (void)state;
    for (int m = 0; m < PAIR_METHODS; m++) {
        batch b;
        shear_settings settings;
        shear_row common[COUNT];
        shear_row own[COUNT];
        batch_init(&b, COUNT, &geometry, 0.95, 7);
        memset(b.psf_index, 0, COUNT * sizeof *b.psf_index);
        use(&settings, m);
        shear_plan *one = batch_plan(&b, &settings, false, false);
        shear_plan *each = batch_plan(&b, &settings, true, false);
        const shear_stamps plain = batch_plain(&b);
        shear_stamps full = batch_plain(&b);
        full.psf = b.psf;
        full.n_psf = 1;
        full.psf_index = b.psf_index;
        batch_measure(one, &plain, common);
        batch_measure(each, &full, own);
        assert_same_rows(own, common, COUNT);
        shear_plan_free(one);
        shear_plan_free(each);
        batch_deinit(&b);
    }
}

/* By index in any order, or stamp i with PSF i, each row is that of its own pair alone. */
static void test_psf_by_index(void **state) {
    (void)state;
    batch b;
    shear_settings settings;
    batch_init(&b, COUNT, &geometry, 1.1, 8);
    use(&settings, 2);
    shear_plan *each = batch_plan(&b, &settings, true, false);
    shear_stamps stamps = batch_full(&b);
    for (int by_index = 0; by_index < 2; by_index++) {
        shear_row rows[COUNT];
        stamps.psf_index = by_index != 0 ? b.psf_index : NULL;
        batch_measure(each, &stamps, rows);
        for (int i = 0; i < COUNT; i++) {
            shear_row alone;
            shear_stamps one = stamps;
            const int psf = by_index != 0 ? b.psf_index[i] : i;
            one.count = one.n_psf = 1;
            one.galaxy += i * PIXELS;
            one.noise += i * PIXELS;
            one.psf += psf * SAMPLES;
            one.psf_index = NULL;
            one.weight += i;
            batch_measure(each, &one, &alone);
            assert_int_equal(rows[i].flags, 0);
            assert_same_rows(&rows[i], &alone, 1);
        }
    }
    shear_plan_free(each);
    batch_deinit(&b);
}

/* The same memory may hold other PSFs at the next call: nothing is remembered. */
static void test_psf_memory_reused(void **state) {
    (void)state;
    batch b;
    shear_settings settings;
    shear_row first;
    shear_row second;
    shear_row again;
    shear_workspace *ws = NULL;
    batch_init(&b, 2, &geometry, 1.1, 9);
    use(&settings, 0);
    shear_plan *plan = batch_plan(&b, &settings, true, false);
    assert_int_equal(shear_workspace_new(&ws, plan, NULL), SHEAR_OK);
    shear_stamps stamps = batch_plain(&b);
    stamps.psf = b.psf;
    stamps.n_psf = 1;
    assert_int_equal(shear_measure(plan, ws, &stamps, 0, &first, NULL), SHEAR_OK);
    memcpy(b.psf, b.psf + SAMPLES, SAMPLES * sizeof(double));
    assert_int_equal(shear_measure(plan, ws, &stamps, 0, &second, NULL), SHEAR_OK);
    batch_measure(plan,
                  &(shear_stamps){.count = 1,
                                  .nx = 20,
                                  .ny = 21,
                                  .galaxy = b.galaxy,
                                  .noise = b.noise,
                                  .n_psf = 1,
                                  .psf = b.psf},
                  &again);
    assert_true(first.d != second.d);
    assert_same_rows(&second, &again, 1);
    shear_workspace_free(ws);
    shear_plan_free(plan);
    batch_deinit(&b);
}

/* A plan for PSFs of the stamps' own, and stamps without any. */
static void test_no_psf_at_all(void **state) {
    (void)state;
    batch b;
    shear_settings settings;
    shear_row rows[COUNT];
    batch_init(&b, COUNT, &geometry, 1.1, 10);
    use(&settings, 0);
    shear_plan *plan = batch_plan(&b, &settings, true, false);
    shear_stamps stamps = batch_plain(&b);
    batch_measure(plan, &stamps, rows);
    stamps.psf = b.psf; /* fewer PSFs than stamps, and no index */
    stamps.n_psf = 5;
    for (int i = 0; i < COUNT; i++)
        assert_int_equal(rows[i].flags, SHEAR_FLAG_PSF_UNUSABLE);
    batch_measure(plan, &stamps, rows);
    for (int i = 0; i < COUNT; i++)
        assert_int_equal(rows[i].flags, i < 5 ? 0 : SHEAR_FLAG_PSF_UNUSABLE);
    shear_plan_free(plan);
    batch_deinit(&b);
}

static void check_negative(const char *which, bool in_noise, bool correction, int code) {
    batch b;
    shear_settings settings;
    shear_row rows[COUNT];
    shear_error err = {0};
    batch_init(&b, COUNT, &geometry, 0.9, 11);
    use(&settings, 5);
    settings.noise_correction = correction;
    (in_noise ? b.noise : b.galaxy)[7 * PIXELS + 3 * 20 + 5] = -0.5;
    shear_plan *plan = batch_plan(&b, &settings, false, false);
    shear_stamps stamps = batch_plain(&b);
    stamps.first = 1000;
    assert_int_equal(shear_measure_batch(plan, &stamps, 1, NULL, rows, &err), code);
    if (code != SHEAR_OK) {
        assert_non_null(strstr(err.message, which));
        assert_non_null(strstr(err.message, "1007"));
        assert_non_null(strstr(err.message, "(6, 4)"));
        assert_non_null(strstr(err.message, "log-bicubic"));
        assert_non_null(strstr(err.advice, "pedestal"));
        settings.pedestal = 1.0;
        shear_plan_free(plan);
        plan = batch_plan(&b, &settings, false, false);
        assert_int_equal(shear_measure_batch(plan, &stamps, 1, NULL, rows, &err), SHEAR_OK);
    }
    assert_int_equal(rows[7].flags, 0);
    shear_plan_free(plan);
    batch_deinit(&b);
}

static void test_negative_pixels(void **state) {
    (void)state;
    check_negative("galaxy", false, true, SHEAR_E_NEGATIVE);
    check_negative("noise", true, true, SHEAR_E_NEGATIVE);
    check_negative("noise", true, false, SHEAR_OK); /* never interpolated */
}

static void test_wrong_shape(void **state) {
    (void)state;
    batch b;
    shear_settings settings;
    shear_row row;
    shear_error err = {0};
    shear_workspace *ws = NULL;
    batch_init(&b, 1, &geometry, 1.1, 12);
    use(&settings, 0);
    shear_plan *plan = batch_plan(&b, &settings, false, false);
    assert_int_equal(shear_workspace_new(&ws, plan, NULL), SHEAR_OK);
    shear_stamps stamps = batch_plain(&b);
    stamps.nx = 21;
    stamps.ny = 20;
    assert_int_equal(shear_measure(plan, ws, &stamps, 0, &row, &err), SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "21 x 20"));
    shear_workspace_free(ws);
    shear_plan_free(plan);
    batch_deinit(&b);
}

/* shear_inspect shows what was measured: sums over its target power are the row's moments. */
static void check_inspection(int method, bool correction) {
    batch b;
    shear_settings settings;
    shear_row row;
    shear_inspection in;
    shear_error err = {0};
    shear_workspace *ws = NULL;
    batch_init(&b, 1, &geometry, 1.0, 13);
    use(&settings, method);
    settings.noise_correction = correction;
    if (!correction) {
        b.noise[3] = -1.0; /* not needed, so not refused */
    }
    shear_plan *plan = batch_plan(&b, &settings, false, false);
    assert_int_equal(shear_workspace_new(&ws, plan, NULL), SHEAR_OK);
    const shear_stamps stamps = batch_plain(&b);
    assert_int_equal(shear_measure(plan, ws, &stamps, 0, &row, &err), SHEAR_OK);
    assert_int_equal(shear_inspect(plan, ws, &stamps, 0, &in, &err), SHEAR_OK);
    double m20 = 0.0;
    double m11 = 0.0;
    for (int i = 0; i < in.spec_nx * in.spec_ny; i++) {
        const double kx = 2.0 * M_PI / 20 * (i % in.spec_nx - in.spec_nx / 2);
        const double ky = 2.0 * M_PI / 21 * (i / in.spec_nx - in.spec_ny / 2);
        m20 += kx * kx * in.target_power[i];
        m11 += kx * ky * in.target_power[i];
        assert_near(in.target_power[i], in.transfer[i] * in.power[i], 1e-15, in.target_power[i],
                    "P = T |F|^2");
    }
    assert_near(m20, row.m20, 1e-12, row.m20, "m20");
    assert_near(m11, row.m11, 1e-12, row.m20, "m11");
    const int s = in.fine_nx / 20;
    assert_near(in.galaxy_fine[in.fine_nx * 5 * s + 7 * s], b.galaxy[5 * 20 + 7], 1e-14, 1.0,
                "a pixel");
    const bool shown = correction || method < 4;
    assert_true(!shown || fabs(in.noise_fine[3 * s] - b.noise[3]) < 1e-14);
    assert_true(shown || isnan(in.noise_fine[0]));
    shear_inspection_deinit(&in);
    b.galaxy[0] = NAN;
    assert_int_equal(shear_inspect(plan, ws, &stamps, 0, &in, &err), SHEAR_E_FORMAT);
    shear_inspection_deinit(&in);
    shear_inspection_deinit(NULL);
    shear_workspace_free(ws);
    shear_plan_free(plan);
    batch_deinit(&b);
}

static void test_inspection(void **state) {
    (void)state;
    for (int m = 0; m < PAIR_METHODS; m++) {
        check_inspection(m, true);
        check_inspection(m, false);
    }
}

/* A bright sky does not spoil the signal to noise, nor a noise of known variance it. */
static void test_snr(void **state) {
    (void)state;
    pair p;
    pair_init(&p, 16, 16, 11, 11, 1);
    pair_draw(&p, 1.2, 3);
    for (int i = 0; i < 256; i++) {
        p.noise[i] = i % 2 == 0 ? 1e9 + 1.0 : 1e9 - 1.0; /* rms 1 */
        p.galaxy[i] = p.noise[i] + (i == 100 ? 64.0 : 0.0);
    }
    const shear_row row = pair_measure(&p);
    assert_near(row.flux, 64.0, 1e-12, 64.0, "flux");
    assert_near(row.snr, 64.0 / sqrt(2.0 * 256.0), 1e-12, 1.0, "snr");
    assert_near(row.border_var_noise, 60.0 / 59.0, 1e-9, 1.0, "border variance");
    assert_true(row.border_mean == 0.0 && row.border_var == 0.0 && row.flux_removed == 0.0);
    pair_deinit(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_psf_of_plan_or_stamp), cmocka_unit_test(test_psf_by_index),
        cmocka_unit_test(test_psf_memory_reused),    cmocka_unit_test(test_no_psf_at_all),
        cmocka_unit_test(test_negative_pixels),      cmocka_unit_test(test_wrong_shape),
        cmocka_unit_test(test_inspection),           cmocka_unit_test(test_snr),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
