/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Artefacts: pixels that are no sky light. The limits of a sum of PSFs are known in closed form for
 * Gaussians: beside a PSF's centre the neighbours have exp(-1/(2 s^2)) of it, and nowhere less. */
#include "gaussian.h"
#include "measure/artefact.h"
#include "measure/sharpness.h"
#include "shear.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 64 };

static double uniform(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(*seed >> 11) + 0.5) * 0x1p-53;
}

static double normal(uint64_t *seed) {
    const double r = sqrt(-2.0 * log(uniform(seed)));
    return r * cos(2.0 * M_PI * uniform(seed));
}

/* A field of one Gaussian PSF, and one pair of it. */
typedef struct scene {
    int nx, ny;
    double psf_px;
    double psf[48 * 48];
    double galaxy[MOST * MOST], noise[MOST * MOST];
    shear_settings settings;
    uint64_t seed;
} scene;

static scene *scene_new(int nx, int ny, double psf_px) {
    scene *s = calloc(1, sizeof *s);
    assert_non_null(s);
    s->nx = nx;
    s->ny = ny;
    s->psf_px = psf_px;
    s->seed = 1;
    shear_settings_init(&s->settings);
    s->settings.interpolation = SHEAR_INTERP_NONE;
    s->settings.beta_px = fmax(1.2, 1.5 * psf_px);
    const gaussian g = {1.0, psf_px * psf_px, psf_px * psf_px, 0.0, 6.0, 6.0};
    gaussian_draw(&g, 48, 48, 4, s->psf);
    return s;
}

static void add_object(scene *s, double flux, double size_px, double stretch, double x, double y) {
    double image[MOST * MOST];
    const double xx = size_px * size_px * stretch;
    const double yy = size_px * size_px / stretch;
    const gaussian g = {flux / (2.0 * M_PI * sqrt(xx * yy)), xx, yy, 0.0, x, y};
    gaussian_draw(&g, s->nx, s->ny, 1, image);
    for (int i = 0; i < s->nx * s->ny; i++)
        s->galaxy[i] += image[i];
}

static void clear(scene *s) {
    memset(s->galaxy, 0, sizeof s->galaxy);
    memset(s->noise, 0, sizeof s->noise);
}

/* White noise of 1 in both, and in the galaxy stamp its photons' where `electrons` make 1. */
static void add_noise(scene *s, double electrons) {
    for (int i = 0; i < s->nx * s->ny; i++) {
        const double more = electrons > 0.0 ? fmax(0.0, s->galaxy[i]) / electrons : 0.0;
        s->galaxy[i] += sqrt(1.0 + more) * normal(&s->seed);
        s->noise[i] += normal(&s->seed);
    }
}

typedef struct tool {
    shear_plan *plan;
    shear_workspace *ws;
} tool;

static tool tool_new(const scene *s) {
    tool t;
    shear_error err = {0};
    const shear_geometry g = {s->nx, s->ny, 48, 48, 4};
    if (shear_plan_new(
            &t.plan, &(shear_plan_request){.settings = &s->settings, .geometry = g, .psf = s->psf},
            &err) != SHEAR_OK) {
        fail_msg("%s", err.message);
    }
    assert_int_equal(shear_workspace_new(&t.ws, t.plan, NULL), SHEAR_OK);
    return t;
}

static void tool_free(tool *t) {
    shear_workspace_free(t->ws);
    shear_plan_free(t->plan);
}

static shear_stamps stamps_of(const scene *s) {
    return (shear_stamps){
        .count = 1, .nx = s->nx, .ny = s->ny, .galaxy = s->galaxy, .noise = s->noise};
}

/* Measured and examined: both say the same. */
static shear_row look(const tool *t, const scene *s) {
    shear_row row;
    shear_row seen;
    const shear_stamps stamps = stamps_of(s);
    assert_int_equal(shear_measure(t->plan, t->ws, &stamps, 0, &row, NULL), SHEAR_OK);
    assert_int_equal(shear_examine(t->plan, t->ws, &stamps, 0, &seen, NULL), SHEAR_OK);
    assert_int_equal(seen.flags, row.flags);
    assert_int_equal(seen.artefact_x, row.artefact_x);
    assert_int_equal(seen.artefact_y, row.artefact_y);
    return row;
}

static void assert_clean(const tool *t, const scene *s) {
    const shear_row row = look(t, s);
    assert_int_equal(row.flags, 0);
    assert_int_equal(row.artefact_x, -1);
    assert_int_equal(row.artefact_y, -1);
    assert_true(isfinite(row.d));
}

static void assert_at(const tool *t, const scene *s, uint32_t flag, int x, int y) {
    const shear_row row = look(t, s);
    assert_int_equal(row.flags, flag);
    assert_int_equal(row.artefact_x, x);
    assert_int_equal(row.artefact_y, y);
    assert_true(isnan(row.n1) && isnan(row.d) && isnan(row.flux));
}

/* ---- the PSF's sharpness ---- */

static double ratio_of(double size_px, int q, double dx, double dy) {
    double psf[48 * 48];
    const gaussian g = {3.0, size_px * size_px, size_px * size_px,
                        0.0, 24.0 / q + dx,     24.0 / q + dy};
    gaussian_draw(&g, 48, 48, q, psf);
    return sharpness_of(psf, 48, 48, q).ratio;
}

/* Of a round Gaussian, exp(1/(2 s^2)), on its axes; wherever the image has its centre. */
static void test_ratio_of_gaussians(void **state) {
    (void)state;
    static const double sizes[] = {0.5, 0.7, 1.0, 1.5, 2.5};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        const double r = exp(0.5 / (sizes[i] * sizes[i]));
        assert_near(ratio_of(sizes[i], 1, 0.0, 0.0), r, 1e-9, r, "centred, a sample a pixel");
        assert_near(ratio_of(sizes[i], 1, 0.5, 0.25), r, 1e-3, r, "between samples");
        assert_near(ratio_of(sizes[i], 2, 0.0, 0.0), r, 1e-9, r, "two a pixel");
        assert_near(ratio_of(sizes[i], 2, 0.25, 0.0), r, 1e-3, r, "two a pixel, between");
        if (sizes[i] < 2.0)
            assert_near(ratio_of(sizes[i], 5, 0.1, 0.1), r, 1e-3, r, "five a pixel, between");
    }
}

static void test_ratio_without_bound(void **state) {
    (void)state;
    double psf[9 * 9] = {[4 * 9 + 4] = 1.0};
    assert_true(isinf(sharpness_of(psf, 9, 9, 1).ratio));
    memset(psf, 0, sizeof psf);
    assert_true(isinf(sharpness_of(psf, 9, 9, 1).ratio));
}

/* A spike in the PSF's faint wings does not raise the ratio, but what may leak. */
static void test_leak(void **state) {
    (void)state;
    double psf[48 * 48];
    const gaussian g = {1.0, 36.0, 36.0, 0.0, 24.0, 24.0};
    gaussian_draw(&g, 48, 48, 1, psf);
    const sharpness plain = sharpness_of(psf, 48, 48, 4);
    psf[4 * 48 + 5] += 0.01;
    const sharpness spiked = sharpness_of(psf, 48, 48, 4);
    double sum = 0.0;
    for (int i = 0; i < 48 * 48; i++)
        sum += psf[i] / 16.0;
    assert_near(spiked.ratio, plain.ratio, 1e-12, 1.0, "ratio");
    assert_true(plain.leak < 1e-6);
    assert_near(spiked.leak, 0.01 / sum, 2e-2, 0.01 / sum, "leak");
}

/* ---- nothing is found where there is nothing ---- */

/* Objects as sharp as the PSF and broader, anywhere between the pixels and at the borders, without
 * noise and with little of it. */
static void test_sky_without_noise(void **state) {
    (void)state;
    static const double sizes[] = {0.4, 0.6, 1.0, 1.5};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        scene *s = scene_new(32, 28, sizes[i]);
        tool t = tool_new(s);
        for (int k = 0; k < 200; k++) {
            clear(s);
            for (int n = 0; n < 1 + k % 3; n++) {
                const double size =
                    k % 2 == 0 ? sizes[i] : sizes[i] * (1.0 + 2.0 * uniform(&s->seed));
                add_object(s, pow(10.0, 3.0 * uniform(&s->seed)), size,
                           size > 1.5 * sizes[i] ? 1.3 : 1.0, 32 * uniform(&s->seed) - 0.5,
                           28 * uniform(&s->seed) - 0.5);
            }
            for (int j = 0; j < 32 * 28 && k >= 100; j++) {
                s->galaxy[j] += 1e-6 * normal(&s->seed);
                s->noise[j] += 1e-6 * normal(&s->seed);
            }
            assert_clean(&t, s);
        }
        tool_free(&t);
        free(s);
    }
}

/* Stars and galaxies under noise, sources' photons too; with fixed seeds none may be found. */
static void check_false_alarms(int nx, int ny, double psf_px, double electrons, double correlated) {
    scene *s = scene_new(nx, ny, psf_px);
    tool t = tool_new(s);
    for (int k = 0; k < 1500; k++) {
        static const double snr[] = {10, 30, 100, 200};
        const double size = k % 3 == 0 ? psf_px : psf_px * (1.0 + 2.0 * uniform(&s->seed));
        const double flux = snr[k % 4] * sqrt(4.0 * M_PI) * size;
        clear(s);
        add_object(s, flux, size, k % 5 == 0 ? 1.5 : 1.0, 0.5 * nx + 2 * uniform(&s->seed) - 1.5,
                   0.5 * ny + 2 * uniform(&s->seed) - 1.5);
        add_noise(s, electrons);
        for (int i = nx * ny - 1; i > 0; i--) { /* along x, either sign */
            s->galaxy[i] += correlated * s->galaxy[i - 1];
            s->noise[i] += correlated * s->noise[i - 1];
        }
        const shear_row row = look(&t, s);
        if (row.flags != 0) {
            fail_msg("stamp %d: flags %#x at (%d, %d)", k, row.flags, row.artefact_x,
                     row.artefact_y);
        }
    }
    tool_free(&t);
    free(s);
}

static void test_false_alarms(void **state) {
    (void)state;
    check_false_alarms(48, 48, 1.5, 0.0, 0.0);
    check_false_alarms(48, 40, 1.5, 10.0, 0.0);
    check_false_alarms(32, 32, 0.9, 5.0, 0.0);
    check_false_alarms(24, 24, 0.5, 10.0, 0.0);
    check_false_alarms(32, 32, 1.5, 0.0, 0.4);
    check_false_alarms(32, 32, 1.5, 0.0, -0.3);
    check_false_alarms(8, 8, 1.2, 0.0, 0.0);
}

/* ---- what is there is found ---- */

static void prepare(scene *s, double flux, double size_px) {
    clear(s);
    add_object(s, flux, size_px, 1.2, 0.5 * s->nx - 0.3, 0.5 * s->ny + 0.2);
    add_noise(s, 0.0);
}

/* A pixel of 15 sigma, streaks of 3 px of 45 in any direction, everywhere but under a bright core;
 * a third of those along x in the first row. */
static void test_cosmic_rays(void **state) {
    (void)state;
    static const int steps[][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {0, 0}};
    scene *s = scene_new(48, 40, 1.5);
    tool t = tool_new(s);
    for (int k = 0; k < 400; k++) {
        const int *step = steps[k % 5];
        const int on_x = step[0] != 0; /* streaks end in the stamp, and may run along its border */
        const int on_y = step[1] != 0;
        const int x = on_x + (int)((48 - 2 * on_x) * uniform(&s->seed));
        const int y = k % 3 == 0 ? on_y : on_y + (int)((40 - 2 * on_y) * uniform(&s->seed));
        const double streak = step[0] != 0 && y == 0 ? 30.0 : 45.0;
        prepare(s, 400.0, 2.5); /* S/N 45 */
        assert_clean(&t, s);
        for (int j = -1; j <= 1; j++) {
            s->galaxy[(y + j * step[1]) * 48 + x + j * step[0]] +=
                step[0] != 0 || step[1] != 0 ? streak : 15.0;
        }
        const shear_row row = look(&t, s);
        assert_int_equal(row.flags, SHEAR_FLAG_ARTEFACT);
        assert_true(abs(row.artefact_x - x) <= abs(step[0]));
        assert_true(abs(row.artefact_y - y) <= abs(step[1]));
    }
    tool_free(&t);
    free(s);
}

/* Hot pixels and sentinels at every pixel, corners too. */
static void test_every_place(void **state) {
    (void)state;
    static const double values[] = {200.0, -9999.0, -1e30, 1e30, -20.0};
    scene *s = scene_new(11, 9, 1.0);
    tool t = tool_new(s);
    prepare(s, 40.0, 1.3);
    assert_clean(&t, s);
    for (int i = 0; i < 11 * 9; i++) {
        for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
            const double was = s->galaxy[i];
            s->galaxy[i] = values[k];
            assert_at(&t, s, SHEAR_FLAG_ARTEFACT, i % 11, i / 11);
            s->galaxy[i] = was;
        }
    }
    tool_free(&t);
    free(s);
}

static void test_in_noise(void **state) {
    (void)state;
    static const int sides[] = {8, 20, 64};
    for (int k = 0; k < 3; k++) {
        scene *s = scene_new(sides[k], sides[k], 1.5);
        tool t = tool_new(s);
        prepare(s, 100.0, 2.0);
        double *hit = &s->noise[3 * sides[k] + 5];
        *hit = 45.0;
        assert_at(&t, s, SHEAR_FLAG_NOISE_ARTEFACT, 5, 3);
        *hit = -9999.0;
        assert_at(&t, s, SHEAR_FLAG_NOISE_ARTEFACT, 5, 3);
        *hit = -1e30;
        assert_at(&t, s, SHEAR_FLAG_NOISE_ARTEFACT, 5, 3);
        *hit = 1e30;
        assert_at(&t, s, SHEAR_FLAG_NOISE_ARTEFACT, 5, 3);
        *hit = -9999.0;
        s->galaxy[2 * sides[k] + 4] = -9999.0; /* the galaxy's goes first */
        assert_at(&t, s, SHEAR_FLAG_ARTEFACT, 4, 2);
        tool_free(&t);
        free(s);
    }
}

/* Where the PSF is one pixel wide, a bright pixel may be a star; what is below the sky is not. */
static void test_narrow_psf(void **state) {
    (void)state;
    scene *s = scene_new(24, 24, 0.3);
    tool t = tool_new(s);
    prepare(s, 300.0, 1.5);
    s->galaxy[7 * 24 + 5] = 60.0;
    assert_clean(&t, s);
    s->galaxy[7 * 24 + 5] = -60.0;
    assert_at(&t, s, SHEAR_FLAG_ARTEFACT, 5, 7);
    tool_free(&t);
    free(s);
}

/* A sky that both have, or one that was not subtracted alike, changes nothing. */
static void test_sky(void **state) {
    (void)state;
    static const double skies[][2] = {{1e4, 1e4}, {-300.0, -300.0}, {0.0, 40.0}, {3.0, 0.0}};
    for (size_t k = 0; k < sizeof skies / sizeof skies[0]; k++) {
        scene *s = scene_new(32, 32, 1.5);
        tool t = tool_new(s);
        prepare(s, 300.0, 2.0);
        for (int i = 0; i < 32 * 32; i++) {
            s->galaxy[i] += skies[k][0];
            s->noise[i] += skies[k][1];
        }
        assert_clean(&t, s);
        s->galaxy[5 * 32 + 9] += 85.0;
        assert_at(&t, s, SHEAR_FLAG_ARTEFACT, 9, 5);
        tool_free(&t);
        free(s);
    }
}

/* Noise stamps with less noise than the galaxies: no stamp is condemned for that. */
static void test_noise_that_is_too_weak(void **state) {
    (void)state;
    scene *s = scene_new(32, 32, 1.5);
    tool t = tool_new(s);
    for (int k = 0; k < 200; k++) {
        prepare(s, 300.0, 2.0);
        for (int i = 0; i < 32 * 32; i++)
            s->noise[i] *= 0.25;
        assert_clean(&t, s);
    }
    tool_free(&t);
    free(s);
}

static void test_keep(void **state) {
    (void)state;
    scene *s = scene_new(24, 24, 1.5);
    s->settings.artefacts = SHEAR_ARTEFACTS_KEEP;
    tool t = tool_new(s);
    prepare(s, 300.0, 2.0);
    s->galaxy[100] = 200.0;
    s->noise[77] = -9999.0;
    assert_clean(&t, s);
    tool_free(&t);
    free(s);
}

/* As doubles, and as a file of floats has them. */
static void test_bad_value(void **state) {
    (void)state;
    static const double values[] = {-9999.0, -1e30, 0.0, 3.75};
    scene *s = scene_new(24, 24, 1.5);
    for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
        for (int narrow = 0; narrow < 2; narrow++) {
            s->settings.bad_value = values[k];
            s->settings.artefacts = SHEAR_ARTEFACTS_KEEP;
            tool t = tool_new(s);
            const double value = narrow != 0 ? (double)(float)values[k] : values[k];
            prepare(s, 300.0, 2.0);
            assert_clean(&t, s);
            s->galaxy[24 * 24 - 1] = value;
            assert_at(&t, s, SHEAR_FLAG_GALAXY_NOT_FINITE, -1, -1);
            s->noise[0] = value;
            assert_at(&t, s, SHEAR_FLAG_GALAXY_NOT_FINITE | SHEAR_FLAG_NOISE_NOT_FINITE, -1, -1);
            tool_free(&t);
        }
    }
    free(s);
}

/* A PSF a stamp: each is held against its own. The first has a broad one, the second one of a
 * pixel. */
static void test_psf_per_stamp(void **state) {
    (void)state;
    enum { N = 24 * 24, P = 48 * 48 };
    static double galaxy[2 * N];
    static double noise[2 * N];
    static double psf[2 * P];
    shear_row rows[2];
    scene *s = scene_new(24, 24, 1.5);
    prepare(s, 300.0, 2.0);
    s->galaxy[7 * 24 + 5] += 60.0;
    for (int k = 0; k < 2; k++) {
        const double size = k == 0 ? 1.5 : 0.3;
        const gaussian g = {1.0, size * size, size * size, 0.0, 6.0, 6.0};
        gaussian_draw(&g, 48, 48, 4, psf + (size_t)k * P);
        memcpy(galaxy + (size_t)k * N, s->galaxy, N * sizeof *galaxy);
        memcpy(noise + (size_t)k * N, s->noise, N * sizeof *noise);
    }
    shear_plan *plan = NULL;
    const shear_geometry geometry = {24, 24, 48, 48, 4};
    const shear_stamps stamps = {
        .count = 2, .nx = 24, .ny = 24, .galaxy = galaxy, .noise = noise, .n_psf = 2, .psf = psf};
    s->settings.beta_px = 2.25;
    assert_int_equal(
        shear_plan_new(
            &plan,
            &(shear_plan_request){.settings = &s->settings, .geometry = geometry, .r_psf_px = 1.5},
            NULL),
        SHEAR_OK);
    assert_int_equal(shear_measure_batch(plan, &stamps, 1, NULL, rows, NULL), SHEAR_OK);
    assert_int_equal(rows[0].flags, SHEAR_FLAG_ARTEFACT);
    assert_int_equal(rows[0].artefact_x, 5);
    assert_int_equal(rows[1].flags, 0);
    shear_plan_free(plan);
    free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ratio_of_gaussians),
        cmocka_unit_test(test_ratio_without_bound),
        cmocka_unit_test(test_leak),
        cmocka_unit_test(test_sky_without_noise),
        cmocka_unit_test(test_false_alarms),
        cmocka_unit_test(test_cosmic_rays),
        cmocka_unit_test(test_every_place),
        cmocka_unit_test(test_in_noise),
        cmocka_unit_test(test_narrow_psf),
        cmocka_unit_test(test_sky),
        cmocka_unit_test(test_noise_that_is_too_weak),
        cmocka_unit_test(test_keep),
        cmocka_unit_test(test_bad_value),
        cmocka_unit_test(test_psf_per_stamp),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
