/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/chip_fixture.h: a chip in memory, which stands in for the room pixels: programs are
 * linked with --wrap=chip_pixels_read. */
#pragma once

#include "survey/cutout/cutter.h"

struct chip_pixels {
    int nx, ny;
    double *value;   /* [ny][nx], like all */
    float *sigma;    /* NaN at first */
    uint8_t *defect; /* none at first */
    int32_t *owner;
    int reads; /* calls until one fails; negative: none does */
};

/* A chip of white noise. */
chip_pixels *chip_new(int nx, int ny, double sigma, uint64_t seed);
void chip_free(chip_pixels *c);

/* A standard normal number. */
double chip_normal(uint64_t *seed);
/* Give the pixels within r of (x, y) to an object. */
void chip_own(chip_pixels *c, double x, double y, double r, int32_t owner);
/* Mark the pixels of a box as defects. */
void chip_damage(chip_pixels *c, int x, int y, int nx, int ny, enum pixel_defect defect);

/* A cutter and the memory of a pair. Options are those of the chip, with stamp and noise_stamps. */
typedef struct cut_fixture {
    cutter *cutter;
    cutter_options options;
    cutter_pair pair;
} cut_fixture;

/* Stamps of 32 px, one noise stamp, R_PSF 1.5 px. */
cutter_options chip_options(const chip_pixels *c);
void cut_init(cut_fixture *f, chip_pixels *pixels, chip_pixels *noise,
              const cutter_options *options);
void cut_deinit(cut_fixture *f);
/* Cut; reading must not fail. Return the flags. */
uint32_t cut_at(cut_fixture *f, double x, double y, double r_gal, int64_t id);
