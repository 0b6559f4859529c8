/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spec.h"

#include "base/cleanup.h"
#include "galaxy.h"
#include "options.h"
#include "psf.h"

#include <gsl/gsl_math.h>
#include <math.h>

/* Keeps the numbers of points and photons within 32 bits. */
static const double max_sources = 1e8;
static const double max_photons = 4e9;

void shear_mock_spec_init(shear_mock_spec *s) {
    *s = (shear_mock_spec){.n_stamps = 2000,
                           .nx = 64,
                           .ny = 64,
                           .seed = 1,
                           .g1 = 0.02,
                           .g2 = -0.03,
                           .rotate = 2,
                           .shift = true,
                           .galaxy = SHEAR_MOCK_REGULAR,
                           .r_gal_px = 6.0,
                           .points = 600,
                           .bulge_fraction = 1.0 / 3.0,
                           .disk_scale = 1.0,
                           .bulge_ratio = 3.0,
                           .inclination_min_deg = 0.0,
                           .inclination_max_deg = 30.0,
                           .steps = 1000,
                           .step_px = 0.375,
                           .psf = SHEAR_MOCK_PSF_A,
                           .r_psf_px = 1.5,
                           .psf_angle_deg = 30.0,
                           .oversample = 1,
                           .noise_stamps = 1,
                           .noise_density = NAN,
                           .photon_snr = 1.0,
                           .layout = SHEAR_LAYOUT_CUBE,
                           .bitpix = -32,
                           .write_r_gal = true};
}

double spec_noise_density(const shear_mock_spec *s) {
    return isnan(s->noise_density) ? 1.0 / (s->r_psf_px * s->r_psf_px) : s->noise_density;
}

/* Noise and galaxies have equal mean flux densities if density * amplitude * flux(W) = ratio *
 * points * flux(W) / (pi R_G^2). */
double spec_noise_amplitude(const shear_mock_spec *s) {
    double area = M_PI * s->r_gal_px * s->r_gal_px;
    return s->noise_ratio * galaxy_max_points(s) / (area * spec_noise_density(s));
}

double spec_point_amplitude(const shear_mock_spec *s) {
    if (s->photons <= 0.0)
        return 1.0;
    double area = M_PI * s->r_gal_px * s->r_gal_px;
    double flux = galaxy_max_points(s) * psf_flux(s->psf, s->r_psf_px);
    return s->photon_snr * s->photons * area / flux;
}

/* In double: a size beyond the range of int is rejected later. */
static double auto_psf_side(const shear_mock_spec *s) {
    return 2.0 * ceil(psf_reach(s->psf, s->r_psf_px) * s->oversample) + 1.0;
}

int spec_psf_side(const shear_mock_spec *s) {
    return s->psf_size > 0 ? s->psf_size : (int)auto_psf_side(s);
}

static int check_geometry(const shear_mock_spec *s, shear_error *err) {
    double g = hypot(s->g1, s->g2);
    double reach =
        s->r_gal_px * (1.0 + g) + hypot(s->offset_x, s->offset_y) + (s->shift ? 0.5 : 0.0);
    int side = s->nx < s->ny ? s->nx : s->ny;
    if (g >= 1.0) {
        return shear_fail(
            err, SHEAR_E_SETTING, NULL,
            "mock option 'shear': |g| = %.4g turns images inside out; it must be below 1", g);
    }
    if (s->rotate == 3) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "mock option 'rotate': 3 is not one of 1, 2, 4");
    }
    if (s->turn_stamps && (s->rotate == 1 || s->nx != s->ny)) {
        return shear_fail(err, SHEAR_E_SETTING, "give rotate 2 or 4, and square stamps",
                          "mock option 'turn-stamps': rotate is %d and the stamps are %dx%d",
                          s->rotate, s->nx, s->ny);
    }
    if (reach > 0.5 * side) {
        return shear_fail(
            err, SHEAR_E_SETTING, "make the stamps larger or the galaxies smaller",
            "mock option 'size': galaxies reach %.4g px from the stamp's centre, but the "
            "stamps are %dx%d",
            reach, s->nx, s->ny);
    }
    return SHEAR_OK;
}

static int check_galaxy(const shear_mock_spec *s, shear_error *err) {
    if (s->inclination_min_deg > s->inclination_max_deg) {
        return shear_fail(err, SHEAR_E_SETTING, "give the smaller angle first",
                          "mock option 'inclination': the range from %g to %g degrees is empty",
                          s->inclination_min_deg, s->inclination_max_deg);
    }
    if (s->galaxy == SHEAR_MOCK_IRREGULAR && s->step_px > s->r_gal_px) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "mock option 'step-size': steps of %g px leave R_G = %g px at once",
                          s->step_px, s->r_gal_px);
    }
    return SHEAR_OK;
}

static int check_psf(const shear_mock_spec *s, shear_error *err) {
    if (s->psf_per_stamp && s->psf_ids > 0) {
        return shear_fail(err, SHEAR_E_SETTING, "choose one of the two",
                          "mock option 'psf-ids' contradicts psf-per-stamp");
    }
    if (s->psf_size == 0 && auto_psf_side(s) > SHEAR_MAX_PSF_SIDE) {
        return shear_fail(
            err, SHEAR_E_SETTING, "lower oversamp, or choose psf-size",
            "mock option 'psf-size': auto would be %.0f samples per side, more than %d",
            auto_psf_side(s), SHEAR_MAX_PSF_SIDE);
    }
    return SHEAR_OK;
}

static int check_noise(const shear_mock_spec *s, shear_error *err) {
    double reach = 2.0 * (psf_reach(s->psf, s->r_psf_px) + 2.0);
    double sources = spec_noise_density(s) * (s->nx + reach) * (s->ny + reach);
    if (s->noise_ratio > 0.0 && sources > max_sources) {
        return shear_fail(
            err, SHEAR_E_SETTING, NULL,
            "mock option 'noise-density': %.3g points would fall around each stamp, more "
            "than %.3g",
            sources, max_sources);
    }
    double light = spec_point_amplitude(s) * psf_peak(s->psf) * galaxy_max_points(s);
    if (s->noise_ratio > 0.0) {
        light += spec_point_amplitude(s) * spec_noise_amplitude(s) * psf_peak(s->psf) *
                 (sources + 10.0 * sqrt(sources));
    }
    if (s->photons > 0.0 && s->photons + light > max_photons) {
        return shear_fail(
            err, SHEAR_E_SETTING, "lower photons or photon-snr",
            "mock option 'photons': a pixel could receive %.3g photons, more than %.3g",
            s->photons + light, max_photons);
    }
    if (s->subtract_background && s->photons <= 0.0) {
        return shear_fail(err, SHEAR_E_SETTING, "give photons as well",
                          "mock option 'subtract-background': there is no photon counting");
    }
    return SHEAR_OK;
}

static int check_file(const shear_mock_spec *s, shear_error *err) {
    if (s->bitpix != -32 && s->bitpix != -64) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "mock option 'bitpix': %d is neither -32 nor -64", s->bitpix);
    }
    return SHEAR_OK;
}

int shear_mock_spec_check(const shear_mock_spec *s, shear_error *err) {
    static int (*const checks[])(const shear_mock_spec *, shear_error *) = {
        options_check_ranges, check_geometry, check_galaxy, check_psf, check_noise, check_file};
    for (size_t i = 0; i < sizeof checks / sizeof *checks; i++)
        TRY(checks[i](s, err));
    return SHEAR_OK;
}
