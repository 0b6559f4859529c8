/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/psf/mode_power.h: the power spectrum of an image at the modes of a stamp of another size.
 *
 * Neither the image's centre nor its size matters to it, so that no image has to be shifted,
 * padded or interpolated. */
#pragma once

#include <stdbool.h>

typedef struct mode_power {
    int nx, ny;                /* of the image */
    int stamp;                 /* modes along either axis */
    double *along_x, *along_y; /* [stamp][nx][2], [stamp][ny][2] exp(-i k r) */
    double *rows;              /* [ny][stamp][2] scratch */
    void *memory;              /* of all */
} mode_power;

/* Plan for images of nx x ny samples, `step` pixels apart. Return false if out of memory. */
bool mode_power_init(mode_power *m, int nx, int ny, double step, int stamp);
void mode_power_deinit(mode_power *m);

/* Compute power[stamp][stamp] of image[ny][nx]: element [jy + stamp/2][jx + stamp/2] is mode (jx,
 * jy), k = 2 pi j / stamp per pixel. */
void mode_power_of(mode_power *m, const double *image, double *power);
