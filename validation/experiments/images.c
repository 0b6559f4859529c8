/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Section 4.3, first figure: one pixelated image, the truth, and its six interpolations. */
#include "engine/experiment.h"
#include "engine/methods.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

static const char *const fixed[] = {"interpolation", "filter", "rotate",
                                    "galaxies",      "groups", NULL};

static void defaults(struct request *r) {
    shear_mock_spec *m = &r->mock;
    m->nx = m->ny = 20;
    m->g1 = m->g2 = 0.0;
    m->rotate = 1;
    m->shift = false;
    m->galaxy = SHEAR_MOCK_IRREGULAR;
    m->r_gal_px = 5.0;
    m->step_px = 0.5;
    m->r_psf_px = 0.5;
    r->galaxies = r->groups = 1;
    r->settings.filter = SHEAR_FILTER_NONE;
    r->settings.oversample = 16;
    r->settings.zeros = SHEAR_ZEROS_FLOOR;
}

/* ---- images ---- */

struct image {
    int nx, ny;
    double *pixels; /* [ny][nx], owned */
};

static int draw(const shear_mock_spec *spec, struct image *image, shear_error *err) {
    shear_mock_spec m = *spec;
    shear_mock *mock = NULL;
    m.n_stamps = 1;
    size_t n = (size_t)m.nx * (size_t)m.ny;
    *image = (struct image){m.nx, m.ny, calloc(2 * n, sizeof(double))};
    int code = image->pixels != NULL
                   ? shear_mock_new(&mock, &m, err)
                   : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for an image");
    code = code != SHEAR_OK
               ? code
               : shear_mock_stamps(mock, 0, 1, 1, image->pixels, image->pixels + n, err);
    shear_mock_free(mock);
    return code;
}

/* The same galaxy on the fine grid itself, whose pixel k is at k / s pixels. */
static int draw_truth(const struct request *r, struct image *image, shear_error *err) {
    shear_mock_spec m = r->mock;
    int s = r->settings.oversample;
    m.nx *= s;
    m.ny *= s;
    m.r_gal_px *= s;
    m.step_px *= s;
    m.r_psf_px *= s;
    m.offset_x = s * m.offset_x - 0.5 * (s - 1);
    m.offset_y = s * m.offset_y - 0.5 * (s - 1);
    return draw(&m, image, err);
}

static int interpolate(const struct request *r, int method, const struct image *coarse,
                       struct image *fine, shear_error *err) {
    struct sampler *s = NULL;
    const struct scene scene = {.spec = r->mock};
    const struct series series = method_series(0, method, PSF_FINE, r->mock.r_psf_px, &r->settings);
    const sample_spec spec = {.name = "images",
                              .stamps = 1,
                              .groups = 1,
                              .threads = 1,
                              .n_scenes = 1,
                              .scenes = &scene,
                              .n_series = 1,
                              .series = &series};
    shear_inspection steps = {0};
    const double *pixels = coarse->pixels;
    const shear_stamps stamps = {.count = 1,
                                 .nx = coarse->nx,
                                 .ny = coarse->ny,
                                 .galaxy = pixels,
                                 .noise = pixels + (size_t)coarse->nx * (size_t)coarse->ny};
    int code = sampler_new(&s, &spec, err);
    code = code != SHEAR_OK ? code : sampler_inspect(s, 0, &stamps, 0, &steps, err);
    if (code == SHEAR_OK) {
        *fine = (struct image){steps.fine_nx, steps.fine_ny, steps.galaxy_fine};
        steps.galaxy_fine = NULL;
    }
    shear_inspection_deinit(&steps);
    sampler_free(s);
    return code;
}

/* ---- figure ---- */

static void show(shear_figure *f, shear_rect cell, const char *title, const struct image *image,
                 double peak) {
    shear_image_begin(f, &(shear_image){.cell = cell,
                                        .title = title,
                                        .pixels = image->pixels,
                                        .nx = image->nx,
                                        .ny = image->ny,
                                        .map = SHEAR_MAP_GREY,
                                        .limits = {0.0, peak},
                                        .stretch = SHEAR_ASINH,
                                        .knee = 0.05 * peak,
                                        .mark_negative = true});
    shear_axes_end(f);
}

/* As in the paper: pixels and truth above, then the three methods, then their logarithmic twins. */
static int draw_figure(const struct image *coarse, const struct image *truth,
                       const struct image *fine, shear_figure **f, shear_error *err) {
    enum { WIDTH = 700, ROW = 250 };
    int code = shear_figure_new(f, WIDTH, 3 * ROW, err);
    const shear_grid grid = {
        .area = {6, 6, WIDTH - 12, 3 * ROW - 12}, .rows = 3, .columns = 6, .gap_x = 3, .gap_y = 4};
    size_t n = (size_t)truth->nx * (size_t)truth->ny;
    double peak = shear_range_of(truth->pixels, n).hi;
    if (code == SHEAR_OK) {
        show(*f, shear_grid_cell(&grid, 0, 0, 1, 3), "pixels", coarse, peak);
        show(*f, shear_grid_cell(&grid, 0, 3, 1, 3), "truth", truth, peak);
        for (int i = 0; i < N_METHODS; i++) {
            show(*f, shear_grid_cell(&grid, 1 + i / 3, i % 3 * 2, 1, 2), methods[i].label, &fine[i],
                 peak);
        }
    }
    return code;
}

/* ---- table ---- */

struct score {
    double rms, worst, lowest, negative; /* as the table's columns */
};

static struct score score_of(const struct image *truth, const struct image *fine) {
    size_t n = (size_t)truth->nx * (size_t)truth->ny;
    double peak = shear_range_of(truth->pixels, n).hi;
    double power = 0.0;
    double square = 0.0;
    struct score s = {.lowest = shear_range_of(fine->pixels, n).lo / peak};
    for (size_t i = 0; i < n; i++) {
        double d = fine->pixels[i] - truth->pixels[i];
        power += truth->pixels[i] * truth->pixels[i];
        square += d * d;
        s.worst = fmax(s.worst, fabs(d) / peak);
        s.negative += fine->pixels[i] < 0.0 ? 1.0 / (double)n : 0.0;
    }
    s.rms = sqrt(square / power);
    return s;
}

static struct table *make_table(const struct request *r, const struct image *truth,
                                const struct image *fine) {
    struct table *t = table_new(r);
    struct score scores[N_METHODS];
    int better = 0;
    table_column(t, "method", TABLE_TEXT, 0, "", "interpolation");
    table_column(t, "rms", TABLE_NUMBER, 4, "", "root of the squared error over the squared truth");
    table_column(t, "worst", TABLE_NUMBER, 4, "", "largest error over the peak");
    table_column(t, "lowest", TABLE_NUMBER, 5, "", "lowest value over the peak");
    table_column(t, "negative", TABLE_NUMBER, 4, "", "part of the fine pixels that are negative");
    for (int i = 0; i < N_METHODS; i++) {
        int plain = methods[i].plain;
        scores[i] = score_of(truth, &fine[i]);
        table_text(t, methods[i].label);
        table_number(t, scores[i].rms);
        table_number(t, scores[i].worst);
        table_number(t, scores[i].lowest);
        table_number(t, scores[i].negative);
        better += plain >= 0 && scores[i].rms < scores[plain].rms;
    }
    table_meta(t, "verdict", "%d of 3 methods are nearer to the truth with the logarithm", better);
    return t;
}

static int exec(const struct request *r, shear_error *err) {
    struct ledger *ledger = NULL;
    struct image coarse = {0};
    struct image truth = {0};
    struct image fine[N_METHODS] = {0};
    struct table *t = NULL;
    shear_figure *f = NULL;
    int code = ledger_open(&ledger, r, 1, err);
    code = code != SHEAR_OK ? code : draw(&r->mock, &coarse, err);
    code = code != SHEAR_OK ? code : draw_truth(r, &truth, err);
    for (int i = 0; code == SHEAR_OK && i < N_METHODS; i++) {
        code = interpolate(r, i, &coarse, &fine[i], err);
    }
    code = code != SHEAR_OK ? code : draw_figure(&coarse, &truth, fine, &f, err);
    if (code == SHEAR_OK) {
        t = make_table(r, &truth, fine);
        code = report_save(r, ledger, t, f, err);
    }
    for (int i = 0; i < N_METHODS; i++) {
        free(fine[i].pixels);
    }
    free(coarse.pixels);
    free(truth.pixels);
    shear_figure_free(f);
    table_free(t);
    ledger_close(ledger);
    return code;
}

const experiment exp_images = {
    .name = "images",
    .summary = "section 4.3: one pixelated image and its six interpolations",
    .about = "One irregular galaxy of 1000 steps on pixels twice as large as R_PSF, the same "
             "galaxy drawn\n"
             "on the fine grid itself, and what the six methods make of the pixels; negative "
             "values are\n"
             "blue.",
    .fixed = fixed,
    .defaults = defaults,
    .exec = exec,
};
