/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sky_scene.h"

#include "test.h"

#include <math.h>

void sky_scene_init(sky_scene *s, double scale, double angle, bool mirrored, double g1, double g2) {
    const double c = scale * cos(angle);
    const double n = scale * sin(angle);
    const double u = mirrored ? -1.0 : 1.0;
    *s = (sky_scene){.galaxy = {.amplitude = 7.0, .xx = 0.44, .yy = 0.32, .xy = -0.06},
                     .psf = {.amplitude = 1.0, .xx = 0.096, .yy = 0.08, .xy = 0.012},
                     .jacobian = {u * (c * (1.0 + g1) - n * g2), u * (c * g2 - n * (1.0 - g1)),
                                  n * (1.0 + g1) + c * g2, n * g2 + c * (1.0 - g1)},
                     .shift_x = 0.3,
                     .shift_y = -0.2};
    sky_scene_draw(s);
    sky_scene_draw_psf(s, 0.5, 0.17, 0.0);
}

static double determinant(const double *j) {
    return j[0] * j[3] - j[1] * j[2];
}

double sky_scene_pixel_scale(const sky_scene *s) {
    return sqrt(fabs(determinant(s->jacobian)));
}

gaussian sky_scene_on_pixels(const sky_scene *s, const gaussian *g) {
    const double *j = s->jacobian;
    const double det = determinant(j);
    const double a = j[3] / det;
    const double b = -j[1] / det;
    const double c = -j[2] / det;
    const double d = j[0] / det;
    gaussian out = {.amplitude = g->amplitude * fabs(det)};
    out.xx = a * a * g->xx + 2.0 * a * b * g->xy + b * b * g->yy;
    out.xy = a * c * g->xx + (a * d + b * c) * g->xy + b * d * g->yy;
    out.yy = c * c * g->xx + 2.0 * c * d * g->xy + d * d * g->yy;
    return out;
}

void sky_scene_draw(sky_scene *s) {
    gaussian g = sky_scene_on_pixels(s, &s->galaxy);
    g.x0 = SCENE_SIDE / 2 + s->shift_x;
    g.y0 = SCENE_SIDE / 2 + s->shift_y;
    gaussian_draw(&g, SCENE_SIDE, SCENE_SIDE, 1, s->pixels);
}

static void draw_samples(sky_scene *s, gaussian p, double step, double x, double y) {
    p.xx /= step * step; /* in samples */
    p.xy /= step * step;
    p.yy /= step * step;
    p.x0 = 0.5 * (SCENE_PSF_SIDE - 1) + x;
    p.y0 = 0.5 * (SCENE_PSF_SIDE - 1) + y;
    gaussian_draw(&p, SCENE_PSF_SIDE, SCENE_PSF_SIDE, 1, s->samples);
}

void sky_scene_draw_psf(sky_scene *s, double step, double x, double y) {
    draw_samples(s, sky_scene_on_pixels(s, &s->psf), step, x, y);
}

void sky_scene_draw_sky_psf(sky_scene *s, double step, double x, double y) {
    draw_samples(s, s->psf, step, x, y);
}

static shear_plan_request request_of(const sky_scene *s, const sky_way *way,
                                     const shear_settings *settings, const double *terms) {
    shear_plan_request r = {.settings = settings,
                            .geometry = {.nx = SCENE_SIDE, .ny = SCENE_SIDE},
                            .r_psf_px = 1.5,
                            .frame = way->frame,
                            .pixel_scale = sky_scene_pixel_scale(s)};
    if (way->model != NULL) {
        r.models = way->model;
        r.n_models = 1;
        r.terms = way->typical ? terms : NULL;
    } else {
        r.geometry.psf_nx = r.geometry.psf_ny = SCENE_PSF_SIDE;
        r.geometry.psf_oversample = way->oversample;
        r.psf = way->own_psf ? NULL : s->samples;
    }
    return r;
}

static void set(shear_settings *settings, const char *name, const char *value) {
    if (value != NULL)
        assert_int_equal(shear_settings_set(settings, name, value, NULL), SHEAR_OK);
}

shear_row sky_scene_measure(const sky_scene *s, const sky_way *way, shear_plan_info *info) {
    static const double one = 0.37;
    const double *terms = way->terms != NULL ? way->terms : &one;
    shear_settings settings;
    shear_settings_init(&settings);
    settings.beta_px = way->beta_px;
    settings.filter = SHEAR_FILTER_NONE;
    set(&settings, "estimator", way->estimator);
    set(&settings, "shot-noise", way->shot_noise);
    const shear_plan_request request = request_of(s, way, &settings, terms);
    const shear_stamps stamps = {.count = 1,
                                 .nx = SCENE_SIDE,
                                 .ny = SCENE_SIDE,
                                 .galaxy = s->pixels,
                                 .noise = s->noise,
                                 .jacobian = way->jacobian != NULL ? way->jacobian : s->jacobian,
                                 .flags = &way->flags,
                                 .n_psf = way->own_psf ? 1 : 0,
                                 .psf = way->own_psf ? s->samples : NULL,
                                 .psf_terms = terms};
    shear_error err = {0};
    shear_plan *plan;
    shear_workspace *ws;
    shear_row row;
    const int code = shear_plan_new(&plan, &request, &err);
    if (code != SHEAR_OK)
        print_error("%s\n", err.message);
    assert_int_equal(code, SHEAR_OK);
    assert_int_equal(shear_workspace_new(&ws, plan, &err), SHEAR_OK);
    assert_int_equal(shear_measure(plan, ws, &stamps, 0, &row, &err), SHEAR_OK);
    if (info != NULL)
        *info = *shear_plan_get_info(plan);
    shear_workspace_free(ws);
    shear_plan_free(plan);
    return row;
}
