/* SPDX-License-Identifier: GPL-3.0-or-later */
/* psf.h: the PSFs W_A and W_B of the paper at any angle, as functions of a displacement in pixels.
 *
 * Eq. (9) of Zhang (2010):
 *
 *   W_A(u, v) = exp[-(u^2 + 0.8 v^2) / (2 R^2)]
 *   W_B(u, v) = W_A(u, v) + 0.03 exp[-(u^2/R^2 + 0.2) (v^2/R^2 + 0.2)]     (diffraction spikes)
 *
 * (u, v) is the displacement in the PSF's own frame, which is rotated by `angle` from x towards y.
 */
#pragma once

#include "shear_mocks/mock.h"

#include <stdbool.h>

typedef struct psf_shape {
    double r;        /* R_PSF, px */
    double cos, sin; /* of the angle */
    double a, b, c;  /* W_A = exp -(a dx^2 + 2 b dx dy + c dy^2) */
    bool spikes;     /* W_B */
} psf_shape;

/* Create a PSF. Multiples of 90 degrees are exact. */
psf_shape psf_make(enum shear_mock_psf kind, double r_px, double angle_deg);

/* Return W(0). */
double psf_peak(enum shear_mock_psf kind);
/* Return the integral of W over the plane, px^2. */
double psf_flux(enum shear_mock_psf kind, double r_px);
/* Return the distance beyond which W is below 1e-20 of its peak for any angle: of the Gaussian, of
 * the spikes, of W. */
double psf_gaussian_reach(double r_px);
double psf_spikes_reach(double r_px);
double psf_reach(enum shear_mock_psf kind, double r_px);

/* Return whether the Gaussian term (below: the spikes) may exceed 1e-20 of the peak somewhere
 * within `radius` px of (dx, dy). */
bool psf_gaussian_reaches(const psf_shape *p, double dx, double dy, double radius);
bool psf_spikes_reach_to(const psf_shape *p, double dx, double dy, double radius);

/* Set out[i] = amplitude * term at (dx + i step, dy), i = 0 .. n-1. The loop is vectorised: results
 * are the same to the last bit only if `out` has the same alignment. */
void psf_gaussian_row(const psf_shape *p, double amplitude, double dx, double dy, double step,
                      int n, double *out);
void psf_spikes_row(const psf_shape *p, double amplitude, double dx, double dy, double step, int n,
                    double *out);

/* Sample W at `oversample` points per px, centred at ((nx-1)/2, (ny-1)/2): out [ny][nx]. */
void psf_image(enum shear_mock_psf kind, double r_px, double angle_deg, int oversample, int nx,
               int ny, double *out);
