/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The computed memory of plans, workspaces and workers is what malloc gives them. */
#include "gaussian.h"
#include "shear/work.h"
#include "test.h"

#include <malloc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A shape and its settings; a PSF for all stamps, or one for each. */
typedef struct shape {
    int nx, ny, psf, psf_oversample;
    bool each;
    const char *settings; /* "name=value name=value" */
    bool r_gal;
} shape;

static const shape shapes[] = {
    {32, 32, 17, 1, false, "", false},
    {64, 64, 33, 1, false, "filter=edge", false},
    {64, 48, 33, 1, false, "interpolation=bicubic oversample=4", false},
    {64, 64, 33, 1, false, "interpolation=spline oversample=16 beta=2.5", false},
    {128, 128, 33, 1, false, "interpolation=spline oversample=16 beta=2.5", false},
    {128, 128, 33, 1, false, "interpolation=log-bicubic oversample=16 beta=2.5 filter=edge", false},
    {48, 96, 65, 2, false, "interpolation=bilinear oversample=8", false},
    {97, 101, 21, 1, false, "", false},
    {53, 47, 21, 1, false, "interpolation=bicubic oversample=8", false},
    {64, 64, 33, 1, false, "shot-noise=plateau interpolation=none", false},
    {64, 64, 33, 1, true, "", false},
    {64, 64, 33, 1, true, "interpolation=bicubic oversample=8", false},
    {64, 64, 33, 1, true, "interpolation=bicubic oversample=8 filter=paper", true},
    {64, 64, 65, 4, true, "interpolation=spline oversample=8", false},
    {256, 256, 65, 1, false, "interpolation=bicubic oversample=8", false},
    {32, 32, 17, 1, false, "estimator=pdf-sym", false},
};
enum { N_SHAPES = sizeof shapes / sizeof *shapes, SLACK = 32768 };

static int64_t in_use(void) {
    const struct mallinfo2 m = mallinfo2();
    return (int64_t)(m.uordblks + m.hblkhd);
}

static double *make_psf(const shape *s) {
    double *psf = malloc((size_t)s->psf * (size_t)s->psf * sizeof *psf);
    const double r = 1.4 * s->psf_oversample;
    const gaussian g = {.amplitude = 1.0,
                        .xx = r * r,
                        .yy = r * r,
                        .x0 = 0.5 * (s->psf - 1),
                        .y0 = 0.5 * (s->psf - 1)};
    gaussian_draw(&g, s->psf, s->psf, 1, psf);
    return psf;
}

static void read_settings(shear_settings *settings, const char *text) {
    char copy[200];
    shear_settings_init(settings);
    snprintf(copy, sizeof copy, "%s", text);
    for (char *at = strtok(copy, " "); at != NULL; at = strtok(NULL, " ")) {
        char *value = strchr(at, '=');
        *value++ = '\0';
        assert_int_equal(shear_settings_set(settings, at, value, NULL), SHEAR_OK);
    }
}

/* Within a hundredth, or what many small allocations and whole pages may come to. */
static void expect_near(const shape *s, const char *what, int64_t said, int64_t taken) {
    const int64_t off = said > taken ? said - taken : taken - said;
    if (off > taken / 100 + SLACK) {
        fail_msg("%s of %d x %d, %s: said %lld bytes, taken %lld", what, s->nx, s->ny, s->settings,
                 (long long)said, (long long)taken);
    }
}

static void check_worker(const shape *s, const shear_plan *plan) {
    const shear_unit_size size = {.blocks = 3, .stamps = 48};
    shear_worker *worker = NULL;
    const int64_t before = in_use();
    assert_int_equal(shear_worker_new(&worker, plan, size, 0, NULL), SHEAR_OK);
    expect_near(s, "worker", shear_worker_bytes(plan, size), in_use() - before);
    shear_worker_free(worker);
}

static void check(const shape *s, bool warm) {
    shear_settings settings;
    shear_memory memory;
    shear_error err = {0};
    shear_plan *plan = NULL;
    double *psf = s->each ? NULL : make_psf(s);
    const shear_geometry g = {.nx = s->nx,
                              .ny = s->ny,
                              .psf_nx = s->psf,
                              .psf_ny = s->psf,
                              .psf_oversample = s->psf_oversample};
    read_settings(&settings, s->settings);
    assert_int_equal(shear_plan_memory(&memory,
                                       &(shear_plan_request){.settings = &settings,
                                                             .geometry = g,
                                                             .psf = psf,
                                                             .r_psf_px = 1.4,
                                                             .has_r_gal = s->r_gal},
                                       &err),
                     SHEAR_OK);
    const int64_t before = in_use();
    if (shear_plan_new(&plan,
                       &(shear_plan_request){.settings = &settings,
                                             .geometry = g,
                                             .psf = psf,
                                             .r_psf_px = 1.4,
                                             .has_r_gal = s->r_gal},
                       &err) != SHEAR_OK) {
        fail_msg("%s", err.message);
    }
    if (!warm) { /* FFTW keeps things of its own from the first time on */
        expect_near(s, "plan", shear_plan_bytes(plan), in_use() - before);
        assert_int_equal(memory.plan, shear_plan_bytes(plan));
        assert_true(memory.workspace >= shear_workspace_bytes(plan));
        assert_true(psf != NULL || memory.workspace == shear_workspace_bytes(plan));
        check_worker(s, plan);
    }
    shear_plan_free(plan);
    free(psf);
}

static void test_taken_as_said(void **state) {
    (void)state;
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < N_SHAPES; i++)
            check(&shapes[i], round == 0);
    }
}

/* What is larger than any plan may be is refused before anything is taken. */
static void test_refused(void **state) {
    (void)state;
    shear_settings settings;
    shear_memory memory = {.plan = 1};
    shear_error err = {0};
    const shear_geometry g = {512, 512, 33, 33, 1};
    shear_settings_init(&settings);
    assert_int_equal(shear_settings_set(&settings, "interpolation", "spline", NULL), SHEAR_OK);
    assert_int_equal(shear_settings_set(&settings, "oversample", "64", NULL), SHEAR_OK);
    assert_int_equal(
        shear_plan_memory(
            &memory, &(shear_plan_request){.settings = &settings, .geometry = g, .r_psf_px = 1.4},
            &err),
        SHEAR_E_SETTING);
    assert_int_equal(memory.plan, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_taken_as_said),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
