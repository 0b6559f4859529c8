/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PSFs that are linear in numbers of each galaxy, in all the ways that their samples may lie. */
#include "pair.h"
#include "sky_scene.h"
#include "test.h"

#include "measure/lanczos.h"
#include "shear/run.h"

#include <math.h>
#include <string.h>

enum { SAMPLES = SCENE_PSF_SIDE * SCENE_PSF_SIDE };

static shear_psf_model model_of(const double *samples, double step) {
    return (shear_psf_model){
        .nx = SCENE_PSF_SIDE, .ny = SCENE_PSF_SIDE, .terms = 1, .step = step, .samples = samples};
}

/* A scene on pixels of an arcsec, of which R_PSF is about 1.5. */
static void make(sky_scene *s) {
    sky_scene_init(s, 1.0, 0.0, false, 0.0, 0.0);
    s->galaxy = (gaussian){.amplitude = 7.0, .xx = 11.0, .yy = 8.0, .xy = -1.5};
    s->psf = (gaussian){.amplitude = 1.0, .xx = 2.4, .yy = 2.0, .xy = 0.3};
    sky_scene_draw(s);
    sky_scene_draw_psf(s, 0.5, 0.1, -0.3);
}

static const double beta = 3.2;

/* A model of one term is the image with as many samples. */
static void test_one_term(void **state) {
    (void)state;
    static sky_scene s;
    make(&s);
    for (int q = 1; q <= 3; q++) {
        sky_scene_draw_psf(&s, 1.0 / q, 0.1, -0.3);
        const shear_psf_model model = model_of(s.samples, 1.0 / q);
        const sky_way image = {.oversample = q, .beta_px = beta};
        const sky_way of_model = {.model = &model, .beta_px = beta};
        const shear_row a = sky_scene_measure(&s, &image, NULL);
        const shear_row b = sky_scene_measure(&s, &of_model, NULL);
        assert_rows_near(&b, &a, 1e-12);
    }
}

/* Any step: what counts is the closed form. */
static void test_any_step(void **state) {
    (void)state;
    static sky_scene s;
    make(&s);
    const shear_row exact = gaussian_row(&s.galaxy, &s.psf, beta);
    for (double step = 0.3; step < 1.25; step += 0.137) {
        sky_scene_draw_psf(&s, step, 0.1, -0.3);
        const shear_psf_model model = model_of(s.samples, step);
        const sky_way ways[] = {{.model = &model, .beta_px = beta},
                                {.model = &model, .typical = true, .beta_px = beta},
                                {.oversample = 1.0 / step, .beta_px = beta},
                                {.oversample = 1.0 / step, .own_psf = true, .beta_px = beta}};
        for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
            const shear_row row = sky_scene_measure(&s, &ways[i], NULL);
            assert_int_equal(row.flags, 0);
            assert_rows_near(&row, &exact, step < 1.0 ? 1e-9 : 1e-7);
        }
    }
}

/* The sum of terms is the PSF; its scale and the place of its peak do not matter. */
static void test_linear(void **state) {
    (void)state;
    static sky_scene s;
    static double planes[3 * SAMPLES];
    make(&s);
    const double sizes[3] = {1.0, 1.3, 0.8};
    const double c[3] = {0.5, 0.3, -0.1};
    const gaussian psf = s.psf;
    for (int t = 0; t < 3; t++) {
        s.psf.xx = psf.xx * sizes[t];
        s.psf.xy = t * 0.1;
        sky_scene_draw_psf(&s, 0.6, 0.2 * t, 0.0);
        memcpy(planes + t * SAMPLES, s.samples, sizeof s.samples);
    }
    for (int i = 0; i < SAMPLES; i++)
        s.samples[i] =
            c[0] * planes[i] + c[1] * planes[SAMPLES + i] + c[2] * planes[2 * SAMPLES + i];
    const shear_psf_model sum = model_of(s.samples, 0.6);
    shear_psf_model three = model_of(planes, 0.6);
    three.terms = 3;
    sky_way way = {.model = &sum, .beta_px = beta};
    const shear_row one = sky_scene_measure(&s, &way, NULL);
    for (double scale = 1e-30; scale < 1e50; scale *= 1e20) {
        const double scaled[3] = {scale * c[0], scale * c[1], scale * c[2]};
        way = (sky_way){.model = &three, .terms = scaled, .beta_px = beta};
        const shear_row row = sky_scene_measure(&s, &way, NULL);
        assert_rows_near(&row, &one, 1e-12);
    }
}

static void test_moved_peak(void **state) {
    (void)state;
    static sky_scene s;
    make(&s);
    const shear_row exact = gaussian_row(&s.galaxy, &s.psf, beta);
    for (int i = 0; i < 5; i++) {
        sky_scene_draw_psf(&s, 0.6, 1.3 * i, -2.1 * i);
        const shear_psf_model model = model_of(s.samples, 0.6);
        const sky_way way = {.model = &model, .beta_px = beta};
        const shear_row row = sky_scene_measure(&s, &way, NULL);
        assert_rows_near(&row, &exact, 1e-9);
    }
}

/* Samples along the axes of the sky, on pixels that lie in any way. */
static void test_sky_axes(void **state) {
    (void)state;
    static sky_scene s;
    for (int i = 0; i < 6; i++) {
        sky_scene_init(&s, 0.2 + 0.01 * i, 0.9 * i, i % 2 != 0, 0.02 * i, -0.015 * i);
        const double scale = sky_scene_pixel_scale(&s);
        const double beta_px = 0.6 / scale;
        const gaussian g = sky_scene_on_pixels(&s, &s.galaxy);
        const gaussian p = sky_scene_on_pixels(&s, &s.psf);
        const shear_row on_sky = gaussian_row(&s.galaxy, &s.psf, 0.6);
        const shear_row on_pixels = gaussian_row(&g, &p, beta_px);
        sky_scene_draw_sky_psf(&s, 0.11, 0.3, 0.4);
        shear_psf_model model = model_of(s.samples, 0.11);
        model.axes = SHEAR_PSF_AXES_SKY;
        for (int side = 0; side < 2; side++) { /* odd and even sides */
            sky_way way = {.model = &model, .beta_px = beta_px, .typical = i % 3 == 0};
            const shear_row pixel = sky_scene_measure(&s, &way, NULL);
            way.frame = SHEAR_FRAME_SKY;
            const shear_row sky = sky_scene_measure(&s, &way, NULL);
            assert_rows_near(&pixel, &on_pixels, 1e-9);
            assert_rows_near(&sky, &on_sky, 1e-9);
            model.ny--; /* without the last row */
        }
    }
}

/* The kernel between the samples, along both kinds of axes. */
static void test_lanczos(void **state) {
    (void)state;
    static sky_scene s;
    make(&s);
    sky_scene_draw_psf(&s, 0.6, 0.1, 0.2);
    for (int n = 2; n <= 8; n++) {
        shear_psf_model model = model_of(s.samples, 0.6);
        model.lanczos = n;
        sky_way way = {.model = &model, .beta_px = beta};
        const shear_row pixel = sky_scene_measure(&s, &way, NULL);
        model.axes = SHEAR_PSF_AXES_SKY;
        const shear_row sky = sky_scene_measure(&s, &way, NULL);
        assert_rows_near(&sky, &pixel, 1e-9);
    }
}

/* The transform against a sum over many places. */
static void test_lanczos_transform(void **state) {
    (void)state;
    enum { PLACES = 20000 };
    for (int n = 1; n <= 8; n++) {
        for (double w = 0.0; w < 7.0; w += 0.31) {
            double at_w = 0.0;
            double at_0 = 0.0;
            for (int i = 0; i < PLACES; i++) {
                const double t = n * (i + 0.5) / PLACES;
                const double value = n * sin(M_PI * t) * sin(M_PI * t / n) / (t * t);
                at_w += value * cos(w * t);
                at_0 += value;
            }
            assert_near(lanczos_transform(n, w), at_w / at_0, 1e-7, 1.0, "transform");
        }
    }
    assert_near(lanczos_transform(4, 0.0), 1.0, 1e-15, 1.0, "at 0");
}

static double lanczos3(double t) {
    const double x = M_PI * t;
    return fabs(t) < 1e-9 ? 1.0 : fabs(t) >= 3.0 ? 0.0 : 3.0 * sin(x) * sin(x / 3.0) / (x * x);
}

/* Return the star at (x, y) from its middle, interpolated from pixels one of which is at (dx, dy),
 * by weights that are divided by their sum. */
static double interpolated(const gaussian *star, double x, double y, double dx, double dy) {
    const double det = star->xx * star->yy - star->xy * star->xy;
    double sum = 0.0;
    double weights = 0.0;
    for (double v = ceil(y - dy - 3.0) + dy; v < y + 3.0; v++) {
        for (double u = ceil(x - dx - 3.0) + dx; u < x + 3.0; u++) {
            const double weight = lanczos3(u - x) * lanczos3(v - y);
            const double q = star->yy * u * u - 2.0 * star->xy * u * v + star->xx * v * v;
            sum += weight * exp(-0.5 * q / det);
            weights += weight;
        }
    }
    return sum / weights;
}

/* A model that is the mean of stars, anywhere on their pixels, that were interpolated from these.
 */
static void test_smoothed(void **state) {
    (void)state;
    enum { PLACES = 5 };
    static sky_scene s;
    const double step = 0.7;
    make(&s);
    const gaussian star = sky_scene_on_pixels(&s, &s.psf);
    for (int i = 0; i < SAMPLES; i++) {
        const double x = step * (i % SCENE_PSF_SIDE - SCENE_PSF_SIDE / 2);
        const double y = step * (i / SCENE_PSF_SIDE - SCENE_PSF_SIDE / 2);
        s.samples[i] = 0.0;
        for (int k = 0; hypot(x, y) < 14.0 && k < PLACES * PLACES; k++)
            s.samples[i] += interpolated(&star, x, y, k % PLACES / 5.0, k / PLACES / 5.0);
    }
    const shear_row exact = gaussian_row(&s.galaxy, &s.psf, beta);
    shear_psf_model model = model_of(s.samples, step);
    const sky_way way = {.model = &model, .beta_px = beta};
    const shear_row raw = sky_scene_measure(&s, &way, NULL);
    model.smoothed_px = 1.0;
    const shear_row divided = sky_scene_measure(&s, &way, NULL);
    const double truth = exact.n1 / exact.d;
    assert_true(fabs(raw.n1 / raw.d / truth - 1.0) > 5e-4);
    assert_true(fabs(divided.n1 / divided.d / truth - 1.0) < 1e-5);
}

/* |W|^2 itself, on the modes. */
static void test_modes(void **state) {
    (void)state;
    static sky_scene s;
    static double power[2 * SCENE_SIDE * SCENE_SIDE];
    make(&s);
    const shear_row exact = gaussian_row(&s.galaxy, &s.psf, beta);
    const double u = 2.0 * M_PI / SCENE_SIDE;
    for (int y = 0; y < SCENE_SIDE; y++) {
        for (int x = 0; x < SCENE_SIDE; x++) {
            const double kx = u * (x - SCENE_SIDE / 2);
            const double ky = u * (y - SCENE_SIDE / 2);
            const double q = s.psf.xx * kx * kx + 2.0 * s.psf.xy * kx * ky + s.psf.yy * ky * ky;
            const size_t at = (size_t)y * SCENE_SIDE + (size_t)x;
            power[at] = 3.0 * exp(-q) - 0.01 * exp(-0.5 * q);
            power[SCENE_SIDE * SCENE_SIDE + at] = 0.02 * exp(-0.5 * q) - 1e-9;
        }
    }
    const double c[2] = {2.0, 1.0};
    const shear_psf_model model = {.nx = SCENE_SIDE,
                                   .ny = SCENE_SIDE,
                                   .terms = 2,
                                   .axes = SHEAR_PSF_AXES_MODES,
                                   .samples = power};
    sky_way way = {.model = &model, .terms = c, .typical = true, .beta_px = beta};
    shear_plan_info info;
    const shear_row row = sky_scene_measure(&s, &way, &info);
    assert_int_equal(row.flags, 0);
    assert_rows_near(&row, &exact, 1e-6); /* the modes that are left out */
    assert_true(info.k_cut > 2.5 && info.k_cut < 3.1);
    double r;
    shear_error err;
    assert_int_equal(shear_psf_model_radius(&model, c, 1.0, &r, &err), SHEAR_OK);
    assert_near(r, pow(s.psf.xx * s.psf.yy - s.psf.xy * s.psf.xy, 0.25), 1e-3, r, "R_PSF");
}

/* R_PSF and the rest of the quality depend on step and scale as they should. */
static void test_quality(void **state) {
    (void)state;
    static sky_scene s;
    shear_psf_quality q;
    double r;
    make(&s);
    const double truth = pow(s.psf.xx * s.psf.yy - s.psf.xy * s.psf.xy, 0.25);
    const double c = 0.2;
    sky_scene_draw_psf(&s, 0.45, 0.0, 0.0);
    shear_psf_model model = model_of(s.samples, 0.45);
    assert_int_equal(shear_psf_model_examine(&q, &model, &c, 0.0, NULL), SHEAR_OK);
    assert_near(q.r_psf_px, truth, 1e-3, truth, "R_PSF");
    assert_near(q.sampling, truth / 0.45, 1e-3, q.sampling, "sampling");
    model.axes = SHEAR_PSF_AXES_SKY; /* the step is in arcsec */
    assert_int_equal(shear_psf_model_radius(&model, &c, 0.25, &r, NULL), SHEAR_OK);
    assert_near(r, truth / 0.25, 1e-3, r, "R_PSF on the sky");
    const double bad = NAN;
    assert_int_equal(shear_psf_model_examine(&q, &model, &bad, 0.25, NULL), SHEAR_E_PSF);
}

/* Coefficients that make no PSF flag the stamp, and so does a number that is no model's. */
static void test_bad_terms(void **state) {
    (void)state;
    static const double bad[][2] = {{NAN, 1.0},       {1.0, NAN},      {INFINITY, 1.0},
                                    {0.0, 0.0},       {-1.0, 0.0},     {1e308, 1e308},
                                    {1e-320, 1e-320}, {1e308, -1e308}, {1.0, -1.0}};
    static sky_scene s;
    static double planes[2 * SAMPLES];
    make(&s);
    memcpy(planes, s.samples, sizeof s.samples);
    memcpy(planes + SAMPLES, s.samples, sizeof s.samples);
    shear_psf_model model = model_of(planes, 0.5);
    model.terms = 2;
    for (int axes = SHEAR_PSF_AXES_PIXEL; axes <= SHEAR_PSF_AXES_SKY; axes++) {
        model.axes = (enum shear_psf_axes)axes;
        for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
            const sky_way way = {.model = &model, .terms = bad[i], .beta_px = beta};
            assert_int_equal(sky_scene_measure(&s, &way, NULL).flags, SHEAR_FLAG_PSF_UNUSABLE);
        }
    }
    const double good[2] = {1.0, 0.5};
    const double jacobian[4] = {NAN, 0.0, 0.0, 1.0};
    const sky_way way = {.model = &model, .terms = good, .beta_px = beta, .jacobian = jacobian};
    assert_int_equal(sky_scene_measure(&s, &way, NULL).flags, SHEAR_FLAG_PSF_UNUSABLE);
}

/* A cosmic ray is found, a star is none, with models as with the image. */
static void test_artefacts(void **state) {
    (void)state;
    static sky_scene s;
    uint64_t seed = 3;
    make(&s);
    for (int i = 0; i < SCENE_SIDE * SCENE_SIDE; i++)
        s.noise[i] = 0.05 * (uniform(&seed) - 0.5);
    gaussian star = s.psf;
    star.amplitude = 40.0;
    for (int ray = 0; ray < 2; ray++) {
        s.galaxy = star;
        sky_scene_draw(&s);
        for (int i = 0; i < SCENE_SIDE * SCENE_SIDE; i++)
            s.pixels[i] += 0.05 * (uniform(&seed) - 0.5);
        if (ray == 1)
            s.pixels[20 * SCENE_SIDE + 41] += 1.5;
        for (int axes = SHEAR_PSF_AXES_PIXEL; axes <= SHEAR_PSF_AXES_SKY; axes++) {
            shear_psf_model model = model_of(s.samples, 0.6);
            model.axes = (enum shear_psf_axes)axes;
            sky_scene_draw_psf(&s, 0.6, 0.1, -0.3);
            for (int typical = 0; typical < 2; typical++) {
                const sky_way way = {.model = &model, .typical = typical == 1, .beta_px = beta};
                const shear_row row = sky_scene_measure(&s, &way, NULL);
                assert_int_equal(row.flags, ray == 1 ? SHEAR_FLAG_ARTEFACT : 0);
                assert_int_equal(row.artefact_x, ray == 1 ? 41 : -1);
            }
        }
    }
}

/* A model whose PSF is too wide for beta: the plan fails if it knows, else the stamp is flagged. */
static void test_beta(void **state) {
    (void)state;
    static sky_scene s;
    make(&s);
    const shear_psf_model model = model_of(s.samples, 0.5);
    const double one = 1.0;
    const sky_way way = {.model = &model, .terms = &one, .beta_px = 1.1};
    assert_int_equal(sky_scene_measure(&s, &way, NULL).flags, SHEAR_FLAG_PSF_UNUSABLE);
    shear_settings settings;
    shear_settings_init(&settings);
    settings.beta_px = 1.1;
    const shear_plan_request request = {.settings = &settings,
                                        .geometry = {.nx = SCENE_SIDE, .ny = SCENE_SIDE},
                                        .models = &model,
                                        .n_models = 1,
                                        .terms = &one,
                                        .r_psf_px = 1.5};
    shear_plan *plan;
    shear_error err;
    assert_int_equal(shear_plan_new(&plan, &request, &err), SHEAR_E_BETA);
    assert_non_null(strstr(err.message, "smallest beta that works"));
}

/* The reader's flags are the row's, whose stamps are not looked at. */
static void test_flags_of_the_reader(void **state) {
    (void)state;
    static sky_scene s;
    make(&s);
    const sky_way way = {
        .oversample = 2.0, .beta_px = beta, .flags = SHEAR_FLAG_EDGE | SHEAR_FLAG_HOLE};
    memset(s.pixels, 0, sizeof s.pixels);
    const shear_row row = sky_scene_measure(&s, &way, NULL);
    assert_int_equal(row.flags, SHEAR_FLAG_EDGE | SHEAR_FLAG_HOLE);
    assert_true(isnan(row.d) && isnan(row.flux));
}

/* Stamps of a field whose PSFs are those of two models. */
static int read_terms(void *self, int64_t stamp, int *model, double *terms, shear_error *err) {
    const int64_t *failing = self;
    if (stamp == *failing)
        return shear_fail(err, SHEAR_E_IO, NULL, "no such stamp");
    *model = stamp % 4 == 3 ? -1 : (int)(stamp % 2);
    terms[0] = stamp == 6 ? NAN : 1.0;
    return SHEAR_OK;
}

/* A field's request has the median of its galaxies' PSFs, and a typical galaxy. */
static void test_request(void **state) {
    (void)state;
    static sky_scene s;
    static double wide[SAMPLES];
    int64_t failing = -1;
    shear_plan_request request;
    shear_error err;
    make(&s);
    s.psf.xx *= 1.44;
    s.psf.yy *= 1.44;
    s.psf.xy *= 1.44;
    sky_scene_draw_psf(&s, 0.5, 0.0, 0.0);
    memcpy(wide, s.samples, sizeof wide);
    make(&s);
    const shear_psf_model models[2] = {model_of(wide, 0.5), model_of(s.samples, 0.5)};
    const shear_field_info info = {.geometry = {.nx = SCENE_SIDE, .ny = SCENE_SIDE},
                                   .n_stamps = 64,
                                   .n_models = 2,
                                   .psf_terms = 1,
                                   .pixscale = 0.2,
                                   .frame = SHEAR_FRAME_SKY};
    const shear_psf_source source = {.self = &failing, .models = models, .read_terms = read_terms};
    assert_int_equal(shear_plan_request_read(&request, NULL, &info, source, &err), SHEAR_OK);
    assert_int_equal(request.n_psfs, 47); /* every fourth stamp has none */
    assert_int_equal(request.n_unusable, 1);
    assert_int_equal(request.model, 0); /* 31 of 47 */
    assert_int_equal(request.frame, SHEAR_FRAME_SKY);
    assert_near(request.r_psf_px, 1.2 * pow(2.4 * 2.0 - 0.09, 0.25), 2e-3, 1.5, "R_PSF");
    shear_plan_request_deinit(&request);
    failing = 20;
    assert_int_equal(shear_plan_request_read(&request, NULL, &info, source, &err), SHEAR_E_IO);
    assert_null(request.psfs);
}

/* What a plan and its workspaces take is known before. */
static void test_memory(void **state) {
    (void)state;
    static sky_scene s;
    make(&s);
    const double one = 1.0;
    shear_psf_model model = model_of(s.samples, 0.5);
    for (int axes = SHEAR_PSF_AXES_PIXEL; axes <= SHEAR_PSF_AXES_SKY; axes++) {
        model.axes = (enum shear_psf_axes)axes;
        const shear_plan_request request = {.geometry = {.nx = SCENE_SIDE, .ny = SCENE_SIDE},
                                            .models = &model,
                                            .n_models = 1,
                                            .terms = &one,
                                            .pixel_scale = 1.0,
                                            .r_psf_px = 1.5};
        shear_plan *plan;
        shear_memory memory;
        shear_error err;
        assert_int_equal(shear_plan_memory(&memory, &request, &err), SHEAR_OK);
        assert_int_equal(shear_plan_new(&plan, &request, &err), SHEAR_OK);
        assert_int_equal(memory.plan, shear_plan_bytes(plan));
        assert_int_equal(memory.workspace, shear_workspace_bytes(plan));
        assert_true(memory.planning > 0);
        shear_plan_free(plan);
    }
}

/* Impossible models are refused. */
static void test_refused(void **state) {
    (void)state;
    static double samples[9];
    const shear_psf_model good = {.nx = 3, .ny = 3, .terms = 1, .step = 0.5, .samples = samples};
    shear_psf_model bad[11];
    for (int i = 0; i < 11; i++)
        bad[i] = good;
    bad[0].terms = 0;
    bad[1].terms = SHEAR_MAX_PSF_TERMS + 1;
    bad[2].nx = 0;
    bad[3].ny = 100000;
    bad[4].step = NAN;
    bad[5].step = 1e9;
    bad[6].lanczos = -1;
    bad[7].axes = SHEAR_PSF_AXES_MODES;
    bad[8].axes = SHEAR_PSF_AXES_SKY; /* without a scale */
    bad[9].smoothed_px = NAN;
    bad[10].smoothed_px = -1.0;
    for (int i = 0; i < 11; i++) {
        const shear_plan_request request = {.geometry = {.nx = SCENE_SIDE, .ny = SCENE_SIDE},
                                            .models = &bad[i],
                                            .n_models = 1,
                                            .r_psf_px = 1.5};
        shear_plan *plan;
        shear_error err;
        assert_int_equal(shear_plan_new(&plan, &request, &err), SHEAR_E_PSF);
        assert_non_null(strstr(err.message, "model 0"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_term),
                                       cmocka_unit_test(test_any_step),
                                       cmocka_unit_test(test_linear),
                                       cmocka_unit_test(test_moved_peak),
                                       cmocka_unit_test(test_sky_axes),
                                       cmocka_unit_test(test_lanczos),
                                       cmocka_unit_test(test_lanczos_transform),
                                       cmocka_unit_test(test_smoothed),
                                       cmocka_unit_test(test_modes),
                                       cmocka_unit_test(test_quality),
                                       cmocka_unit_test(test_bad_terms),
                                       cmocka_unit_test(test_artefacts),
                                       cmocka_unit_test(test_beta),
                                       cmocka_unit_test(test_flags_of_the_reader),
                                       cmocka_unit_test(test_request),
                                       cmocka_unit_test(test_memory),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
