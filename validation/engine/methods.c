/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/methods.h"

#include <math.h>

const method methods[N_METHODS] = {
    {"Bilinear", SHEAR_INTERP_BILINEAR, -1, SHEAR_SKY, SHEAR_TRIANGLE},
    {"Bicubic", SHEAR_INTERP_BICUBIC, -1, SHEAR_BLUE, SHEAR_SQUARE},
    {"Spline", SHEAR_INTERP_SPLINE, -1, SHEAR_PURPLE, SHEAR_DISC},
    {"Log-Bilinear", SHEAR_INTERP_LOG_BILINEAR, 0, SHEAR_GREEN, SHEAR_TRIANGLE},
    {"Log-Bicubic", SHEAR_INTERP_LOG_BICUBIC, 1, SHEAR_VERMILION, SHEAR_SQUARE},
    {"Log-Spline", SHEAR_INTERP_LOG_SPLINE, 2, SHEAR_BLACK, SHEAR_DISC},
};

const char *const psf_sampling_names[N_PSF_SAMPLINGS] = {"fine", "coarse"};

int psf_oversample(enum psf_sampling sampling, double r_psf_px) {
    enum { SAMPLES = 16, MOST = 64 };
    int k = 1;
    while (sampling == PSF_FINE && k < MOST && k * r_psf_px < SAMPLES)
        k *= 2;
    return k;
}

static bool is_smooth(int n) {
    static const int primes[] = {2, 3, 5};
    for (int i = 0; i < 3; i++) {
        while (n % primes[i] == 0)
            n /= primes[i];
    }
    return n == 1;
}

int good_side(double side) {
    int n = 2 * (int)ceil(0.5 * side);
    n = n < SHEAR_MIN_SIDE ? SHEAR_MIN_SIDE : n;
    while (!is_smooth(n))
        n += 2;
    return n;
}

/* On the axes of its spikes W_B is proportional to exp(-r^2 / 5), 1e-10 of the peak at 10 R_PSF. */
int stamp_side(double r_gal_px, double r_psf_px) {
    static const double reach = 10.0;
    return good_side(2.0 * (1.1 * r_gal_px + reach * r_psf_px + 1.0));
}

/* Return the smallest power of two s with 1/s < R/4, the paper's rule. R is the radius of a circle
 * with the area of the PSF's contour at exp(-1/2), 0.8^(-1/4) R_PSF. */
static int fine_factor(double r_psf_px) {
    static const double circular = 1.057;
    int s = 2;
    while (1.0 / s >= 0.25 * circular * r_psf_px)
        s *= 2;
    return s;
}

series method_series(int i_method, enum psf_sampling sampling, double r_psf_px,
                     const shear_settings *settings) {
    series s = {.psf_oversample = psf_oversample(sampling, r_psf_px), .settings = *settings};
    s.settings.interpolation = methods[i_method].interpolation;
    if (s.settings.oversample == 0)
        s.settings.oversample = fine_factor(r_psf_px);
    s.settings.power_tolerance = sampling == PSF_COARSE ? 1.0 : settings->power_tolerance;
    return s;
}

void method_series_all(series all[N_METHOD_SERIES], double r_psf_px,
                       const shear_settings *settings) {
    for (int i = 0; i < N_METHOD_SERIES; i++) {
        all[i] =
            method_series(i % N_METHODS, (enum psf_sampling)(i / N_METHODS), r_psf_px, settings);
    }
}
