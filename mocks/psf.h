/* SPDX-License-Identifier: GPL-3.0-or-later */
/* psf.h: the two PSFs of Zhang (2010), eq. (9) at any angle, as functions of a displacement in
 * pixels.
 *
 *   W_A(u, v) = exp[-(u^2 + 0.8 v^2) / (2 R^2)]
 *   W_B(u, v) = W_A(u, v) + 0.03 exp[-(u^2/R^2 + 0.2) (v^2/R^2 + 0.2)]     (diffraction spikes)
 *
 * (u, v) is the displacement in the PSF's own frame, which is turned by `angle` from x towards y.
 */
#ifndef MOCKS_PSF_H
#define MOCKS_PSF_H

#include "shear_mocks/mock.h"

#include <stdbool.h>

typedef struct psf_shape {
    double r;        /* R_PSF, px */
    double cos, sin; /* of the angle */
    double a, b, c;  /* W_A = exp -(a dx^2 + 2 b dx dy + c dy^2) */
    bool spikes;     /* W_B */
} psf_shape;

/* Multiples of 90 degrees are exact. */
psf_shape psf_make(enum shear_mock_psf kind, double r_px, double angle_deg);

/* W(0). */
double psf_peak(enum shear_mock_psf kind);
/* The integral of W over the plane, px^2. */
double psf_flux(enum shear_mock_psf kind, double r_px);
/* At larger distances W is below 1e-20 of its peak, whatever the angle: of the Gaussian, of the
 * spikes, of W. */
double psf_gaussian_reach(double r_px);
double psf_spikes_reach(double r_px);
double psf_reach(enum shear_mock_psf kind, double r_px);

/* True where the Gaussian term, or the spikes, may exceed 1e-20 of the peak somewhere within
 * `radius` px of (dx, dy). */
bool psf_gaussian_reaches(const psf_shape *p, double dx, double dy, double radius);
bool psf_spikes_reach_to(const psf_shape *p, double dx, double dy, double radius);

/* out[i] = amplitude * term at (dx + i step, dy), i = 0 .. n-1. Vectorised; for the same bits
 * everywhere give an `out` of the same alignment. */
void psf_gaussian_row(const psf_shape *p, double amplitude, double dx, double dy, double step,
                      int n, double *out);
void psf_spikes_row(const psf_shape *p, double amplitude, double dx, double dy, double step, int n,
                    double *out);

/* W point-sampled at `oversample` samples per px, centred at ((nx-1)/2, (ny-1)/2).  out [ny][nx] */
void psf_image(enum shear_mock_psf kind, double r_px, double angle_deg, int oversample, int nx,
               int ny, double *out);

#endif
