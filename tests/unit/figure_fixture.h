/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/figure_fixture.h: pictures of SIDE x SIDE pixels, saved in a directory of the test's
 * own. */
#pragma once

#include "shear_figures/figure.h"

#include <stdint.h>

enum { SIDE = 300 };

extern char directory[64];

/* Group setup and teardown. The teardown fails if files are left. */
int make_directory(void **state);
int remove_directory(void **state);

/* A name in the test's directory; good until the next call. */
const char *in_directory(const char *name);

/* Count the files in the test's directory. */
int entries(void);

shear_figure *new_figure(void);

/* A colour as shear_figure_pixel returns it. */
uint32_t packed(shear_colour c);

/* 0 for white, 765 for black. */
int darkness(shear_figure *f, double x, double y);

/* Check that the figure has failed with this code and that nothing is written; free it. */
void assert_failed(shear_figure *f, int code);

/* Check that nothing went wrong, so that the picture can be written; free it. */
void assert_saves(shear_figure *f);
