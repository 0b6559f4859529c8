/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/lanczos.h: the Lanczos kernel sinc(t) sinc(t/n), |t| < n, with which PSFEx interpolates
 * between the samples of a PSF. */
#pragma once

/* Return the transform of the kernel of order n at w radians per sample, over that at 0. */
double lanczos_transform(int n, double w);
