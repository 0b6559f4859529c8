/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "chip_fixture.h"

#include "test.h"

#include <math.h>
#include <stdlib.h>

int __wrap_chip_pixels_read(chip_pixels *c, const pixel_box *box, shear_error *err);

static double uniform_of(uint64_t *seed) {
    uint64_t z = *seed += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return ((double)((z ^ (z >> 31)) >> 12) + 0.5) * 0x1p-52;
}

double chip_normal(uint64_t *seed) {
    const double r = sqrt(-2.0 * log(uniform_of(seed)));
    return r * cos(6.283185307179586 * uniform_of(seed));
}

chip_pixels *chip_new(int nx, int ny, double sigma, uint64_t seed) {
    const size_t n = (size_t)nx * (size_t)ny;
    chip_pixels *c = calloc(1, sizeof *c);
    assert_non_null(c);
    *c = (chip_pixels){.nx = nx,
                       .ny = ny,
                       .value = calloc(n, sizeof *c->value),
                       .sigma = calloc(n, sizeof *c->sigma),
                       .defect = calloc(n, 1),
                       .owner = calloc(n, sizeof *c->owner),
                       .reads = -1};
    assert_true(c->value != NULL && c->sigma != NULL && c->defect != NULL && c->owner != NULL);
    for (size_t i = 0; i < n; i++) {
        c->value[i] = sigma == 0.0 ? 0.0 : sigma * chip_normal(&seed);
        c->sigma[i] = NAN;
    }
    return c;
}

void chip_free(chip_pixels *c) {
    free(c->value);
    free(c->sigma);
    free(c->defect);
    free(c->owner);
    free(c);
}

void chip_own(chip_pixels *c, double x, double y, double r, int32_t owner) {
    for (int j = (int)fmax(y - r, 0.0); j <= y + r && j < c->ny; j++) {
        for (int i = (int)fmax(x - r, 0.0); i <= x + r && i < c->nx; i++) {
            if (hypot(i - x, j - y) <= r)
                c->owner[(size_t)j * (size_t)c->nx + (size_t)i] = owner;
        }
    }
}

void chip_damage(chip_pixels *c, int x, int y, int nx, int ny, enum pixel_defect defect) {
    for (int j = y; j < y + ny; j++) {
        for (int i = x; i < x + nx; i++) {
            c->defect[(size_t)j * (size_t)c->nx + (size_t)i] |= (uint8_t)defect;
            c->value[(size_t)j * (size_t)c->nx + (size_t)i] = 1e6;
        }
    }
}

/* Copy one pixel, whose index in the box is `to`. */
static void read_pixel(const chip_pixels *c, int x, int y, const pixel_box *box, size_t to) {
    const bool inside = x >= 0 && x < c->nx && y >= 0 && y < c->ny;
    const size_t at = inside ? (size_t)y * (size_t)c->nx + (size_t)x : 0;
    if (box->value != NULL)
        box->value[to] = inside ? c->value[at] : NAN;
    if (box->sigma != NULL)
        box->sigma[to] = inside ? c->sigma[at] : NAN;
    if (box->defect != NULL)
        box->defect[to] = inside ? c->defect[at] : PIXEL_OUTSIDE;
    if (box->owner != NULL)
        box->owner[to] = inside ? c->owner[at] : 0;
}

int __wrap_chip_pixels_read(chip_pixels *c, const pixel_box *box, shear_error *err) {
    if (c->reads >= 0 && c->reads-- == 0)
        return shear_fail(err, SHEAR_E_IO, NULL, "cannot read the chip");
    size_t to = 0;
    for (int y = box->y; y < box->y + box->ny; y++) {
        for (int x = box->x; x < box->x + box->nx; x++)
            read_pixel(c, x, y, box, to++);
    }
    return SHEAR_OK;
}

cutter_options chip_options(const chip_pixels *c) {
    return (cutter_options){.nx = c->nx,
                            .ny = c->ny,
                            .stamp = 32,
                            .noise_stamps = 1,
                            .noise = SHEAR_NOISE_NEAR,
                            .chip = 3,
                            .r_psf_px = 1.5};
}

void cut_init(cut_fixture *f, chip_pixels *pixels, chip_pixels *noise,
              const cutter_options *options) {
    shear_error err = {0};
    const size_t n = (size_t)options->stamp * (size_t)options->stamp;
    *f = (cut_fixture){.options = *options};
    if (cutter_new(&f->cutter, pixels, noise, options, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    f->pair.galaxy = calloc(n, sizeof(double));
    f->pair.noise = calloc(n * (size_t)options->noise_stamps, sizeof(double));
    assert_true(f->pair.galaxy != NULL && f->pair.noise != NULL);
}

void cut_deinit(cut_fixture *f) {
    cutter_free(f->cutter);
    free(f->pair.galaxy);
    free(f->pair.noise);
}

uint32_t cut_at(cut_fixture *f, double x, double y, double r_gal, int64_t id) {
    const cutter_source source = {.x = x, .y = y, .r_gal = r_gal, .id = id};
    shear_error err = {0};
    if (cutter_cut(f->cutter, &source, &f->pair, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    return f->pair.flags;
}
