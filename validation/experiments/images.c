/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `images` (section 4.3, first figure): a pixelated image, the truth, and its six
 * interpolations. */
#include "engine/methods.h"
#include "engine/must.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

/* ---- images ---- */

typedef struct image {
    int nx, ny;
    double *pixels; /* [ny][nx], owned; in a drawn image the noise stamp follows */
} image;

/* Draw the same galaxy on the fine grid, whose pixel k is at k / s pixels. */
static image draw_truth(const options *o) {
    shear_mock_spec m = o->mock;
    const int s = o->settings.oversample;
    m.nx *= s;
    m.ny *= s;
    m.r_gal_px *= s;
    m.step_px *= s;
    m.r_psf_px *= s;
    m.offset_x = s * m.offset_x - 0.5 * (s - 1);
    m.offset_y = s * m.offset_y - 0.5 * (s - 1);
    return (image){m.nx, m.ny, sampler_draw(&m, 1)};
}

static image interpolate(const options *o, int i_method, const image *coarse) {
    const sample only = {
        "images", .n_scenes = 1, .scenes = {{.spec = o->mock}}, .n_series = 1,
        .series = {method_series(i_method, PSF_FINE, o->mock.r_psf_px, &o->settings)}};
    CLEANUP(sampler_release) sampler *s = sampler_new(&only, 1, 1);
    const size_t n = (size_t)coarse->nx * (size_t)coarse->ny;
    const shear_stamps pair = {.count = 1,
                               .nx = coarse->nx,
                               .ny = coarse->ny,
                               .galaxy = coarse->pixels,
                               .noise = coarse->pixels + n};
    shear_inspection steps = {0};
    sampler_inspect(s, 0, &pair, 0, &steps);
    const image fine = {steps.fine_nx, steps.fine_ny, steps.galaxy_fine};
    steps.galaxy_fine = NULL;
    shear_inspection_deinit(&steps);
    return fine;
}

/* ---- table and figure ---- */

static double peak_of(const image *im) {
    return shear_range_of(im->pixels, (size_t)im->nx * (size_t)im->ny).hi;
}

static const column columns[] = {
    {"method", TABLE_TEXT, 0, .help = "interpolation"},
    {"rms", TABLE_NUMBER, 4, .help = "root of the squared error over the squared truth"},
    {"worst", TABLE_NUMBER, 4, .help = "largest error over the peak"},
    {"lowest", TABLE_NUMBER, 5, .help = "lowest value over the peak"},
    {"negative", TABLE_NUMBER, 4, .help = "part of the fine pixels that are negative"},
    {0}};

/* Add a row. Returns the root mean square error. */
static double add_row(table *t, const char *label, const image *truth, const image *fine) {
    const size_t n = (size_t)truth->nx * (size_t)truth->ny;
    const double peak = peak_of(truth);
    double power = 0.0;
    double square = 0.0;
    double worst = 0.0;
    double negative = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double d = fine->pixels[i] - truth->pixels[i];
        power += truth->pixels[i] * truth->pixels[i];
        square += d * d;
        worst = fmax(worst, fabs(d) / peak);
        negative += fine->pixels[i] < 0.0 ? 1.0 / (double)n : 0.0;
    }
    table_texts(t, label);
    table_numbers(t, sqrt(square / power), worst, shear_range_of(fine->pixels, n).lo / peak,
                  negative);
    return sqrt(square / power);
}

static void tabulate(table *t, const image *truth, const image *fine) {
    double rms[N_METHODS];
    int better = 0;
    table_columns(t, columns);
    for (int i = 0; i < N_METHODS; i++) {
        const int plain = methods[i].plain;
        rms[i] = add_row(t, methods[i].label, truth, &fine[i]);
        better += plain >= 0 && rms[i] < rms[plain];
    }
    table_meta(t, TABLE_CONCLUSION, "%d of 3 methods are nearer to the truth with the logarithm",
               better);
}

static void show(shear_figure *f, shear_rect cell, const char *title, const image *im,
                 double peak) {
    shear_image_begin(f, &(shear_image){cell, title, im->pixels, im->nx, im->ny, SHEAR_ASINH,
                                        .limits = {0.0, peak}, .knee = 0.05 * peak,
                                        .map = SHEAR_MAP_GREY, .mark_negative = true});
    shear_axes_end(f);
}

/* Draw as in the paper: pixels and truth in the first row, then the three methods, then the same
 * with logarithms. */
static void draw(run *r, const image *coarse, const image *truth, const image *fine) {
    enum { WIDTH = 700, ROW = 250 };
    const shear_grid grid = {{6, 6, WIDTH - 12, 3 * ROW - 12}, 3, 6, .gap_x = 3, .gap_y = 4};
    const double peak = peak_of(truth);
    shear_figure *f = run_figure(r, NULL, WIDTH, 3 * ROW);
    show(f, shear_grid_cell(&grid, 0, 0, 1, 3), "pixels", coarse, peak);
    show(f, shear_grid_cell(&grid, 0, 3, 1, 3), "truth", truth, peak);
    for (int i = 0; i < N_METHODS; i++) {
        show(f, shear_grid_cell(&grid, 1 + i / 3, i % 3 * 2, 1, 2), methods[i].label, &fine[i],
             peak);
    }
}

static void run_images(run *r) {
    const options *o = r->options;
    const image coarse = {o->mock.nx, o->mock.ny, sampler_draw(&o->mock, 1)};
    const image truth = draw_truth(o);
    image fine[N_METHODS];
    for (int i = 0; i < N_METHODS; i++)
        fine[i] = interpolate(o, i, &coarse);
    tabulate(r->table, &truth, fine);
    draw(r, &coarse, &truth, fine);
    for (int i = 0; i < N_METHODS; i++)
        free(fine[i].pixels);
    free(coarse.pixels);
    free(truth.pixels);
}

const experiment experiment_images = {
    "images",
    "section 4.3: one pixelated image and its six interpolations",
    "One irregular galaxy of 1000 steps on pixels twice as large as R_PSF, the same galaxy\n"
    "drawn on the fine grid itself, and what the six methods make of the pixels; negative\n"
    "values are blue.",
    .defaults = "size=20 shear=0,0 rotate=1 no-shift=yes galaxy=irregular r-gal=5 step-size=0.5 "
                "r-psf=0.5 galaxies=1 groups=1 filter=none oversample=16 zeros=floor",
    .fixed = "interpolation filter rotate galaxies groups",
    .run = run_images};
