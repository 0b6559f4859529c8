/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chip_map.h: the panels of the figure of a chip. */
#pragma once

#include "plot/chip_survey.h"
#include "shear_figures/figure.h"

/* The kinds of galaxies that are told apart by their colour, in the order of the legend. */
typedef struct chip_kind {
    const char *name;
    unsigned flags; /* a galaxy with one of them is of this kind, unless of one before; 0: none */
    int hue;
} chip_kind;
enum { CHIP_KINDS = 8 };
extern const chip_kind chip_kinds[CHIP_KINDS];
/* Return the kind of a galaxy: an index into chip_kinds. */
int chip_kind_of(const chip_galaxy *g);

/* Draw the chip's pixels with its galaxies and their noise stamps of `stamp` pixels. */
int chip_map_draw(shear_figure *f, shear_rect cell, const chip_survey *s, int stamp,
                  shear_error *err);
/* Draw the PSF over the chip, and where North and East are. */
void chip_map_draw_psf(shear_figure *f, shear_rect cell, const chip_survey *s);
