/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/oracle.h: docs/method.md section 1 written down as directly as C allows: slow, plain,
 * with no FFT and nothing from core/measure. What the fast code returns must be this. */
#pragma once

#include "shear/plan.h"

/* The fine image [ny s][nx s] of pixels [ny][nx], malloc'd. */
double *oracle_interpolate(const double *pixels, int nx, int ny,
                           enum shear_interpolation interpolation, int s, enum shear_zeros zeros,
                           double pedestal);

/* The border filter at fine pixel (x, y) of a stamp of nx x ny pixels, s fine ones a pixel. */
double oracle_filter(int nx, int ny, int s, int x, int y, double core, double width);

/* One pair, with the decisions that `info` reports and the other settings. Sets n1 ... m4 only. The
 * radius inside which modes are kept is found here too: *k_cut. */
shear_row oracle_measure(const shear_plan_info *info, const shear_settings *settings,
                         const double *galaxy, const double *noise, const double *psf,
                         double *k_cut);
