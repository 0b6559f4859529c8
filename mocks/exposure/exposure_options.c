/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The options of a mock exposure, their defaults, and what they must fulfil together. */
#include "shear_mocks/exposure.h"

#include "base/cleanup.h"
#include "option.h"

#include <math.h>

static const char *const moffat_names[] = {"2.5", "3.5", "4.5", NULL};

static const double max_objects = 1e6; /* of a chip */

#define AT(member) offsetof(shear_mock_exposure, member)

static const shear_mock_option table[] = {
    ROW("seed", SEED, seed, 0, 0, "S", "same seed: same objects and noise, at any shear"),
    ROW("shear", PAIR, g1, -0.9, 0.9, "G1,G2", "the true shear on the sky"),
    ROW("chips", SIZE, chips_x, 1, 32, "NX[xNY]", "chips of the mosaic"),
    ROW("chip-size", SIZE, nx, 64, 16384, "NX[xNY]", "pixels of a chip"),
    ROW("gap", DOUBLE, gap_px, 0, 4096, "PX", "between chips"),
    ROW("pointing", PAIR, ra_deg, -90, 360, "RA,DEC", "the field's centre, degrees"),
    ROW("pixel-scale", DOUBLE, pixel_scale_arcsec, 0.01, 10, "ARCSEC", "of a pixel"),
    ROW("rotation", DOUBLE, rotation_deg, -360, 360, "DEG", "turns the chips on the sky"),
    SWITCH("mirrored", ON, mirrored, "x is reversed, before the rotation"),
    ROW("distortion", DOUBLE, distortion, -0.2, 0.2, "SHEAR",
        "radial distortion: its shear at the field's corner"),
    ROW("skew", PAIR, skew1, -0.3, 0.3, "S1,S2", "constant shear of the coordinates"),
    ROW("galaxies", DOUBLE, galaxies, 0, 1000, "N", "per square arcmin"),
    ROW("stars", DOUBLE, stars, 0, 1000, "N", "per square arcmin"),
    ROW("spacing", DOUBLE, spacing_px, 0, 4096, "PX", "of a jittered grid; 0: random places"),
    SWITCH("shear-places", ON, shear_places, "distances between galaxies are sheared, too"),
    SWITCH("fours", ON, fours, "each galaxy at 0, 45, 90 and 135 degrees, in different places"),
    ROW("flux", PAIR, flux_min, 1e-6, 1e12, "MIN,MAX", "of galaxies, ADU"),
    ROW("flux-slope", DOUBLE, flux_slope, 0, 10, "X", "N(> F) is proportional to F^-X"),
    ROW("r-half", PAIR, r_half_min, 1e-3, 60, "MIN,MAX", "half-light radius of galaxies, arcsec"),
    ROW("ellipticity", DOUBLE, ellipticity, 0, 0.6, "SIGMA", "of galaxies, each component"),
    ROW("star-flux", PAIR, star_flux_min, 1e-6, 1e12, "MIN,MAX", "of stars, ADU"),
    ROW("star-flux-slope", DOUBLE, star_flux_slope, 0, 10, "X", "the same for stars"),
    CHOICE("moffat", moffat, moffat_names, "2.5|3.5|4.5", "exponent of the PSF's profile"),
    ROW("fwhm", DOUBLE, fwhm_px, 1.5, 50, "PX", "width of the PSF"),
    ROW("psf-shape", PAIR, psf_e1, -0.5, 0.5, "E1,E2", "mean ellipticity of the PSF"),
    ROW("psf-variation", DOUBLE, psf_variation, 0, 0.5, "X",
        "change of its size from the field's centre to a corner"),
    ROW("sky", DOUBLE, sky, 0, 1e9, "ADU", "background per pixel"),
    ROW("gain", DOUBLE, gain, 1e-6, 1e6, "E", "electrons per ADU"),
    ROW("read-noise", DOUBLE, read_noise, 0, 1e6, "E", "electrons"),
    SWITCH("source-noise", ON, source_noise, "the objects' photon noise, too"),
    ROW("correlation", DOUBLE, correlation, 0, 0.6, "RHO", "of the noise of neighbouring pixels"),
    ROW("saturation", DOUBLE, saturation, 1, 1e12, "ADU", "level of saturated pixels"),
    ROW("bad-columns", INT, bad_columns, 0, 16384, "N", "per chip"),
    ROW("cosmic-rays", INT, cosmic_rays, 0, 1e6, "N", "tracks per chip"),
    ROW("exposure-time", DOUBLE, exposure_time, 0.001, 1e6, "S", "keyword EXPTIME"),
};

static const option_table options = {table, sizeof table / sizeof *table};

void shear_mock_exposure_init(shear_mock_exposure *e) {
    *e = (shear_mock_exposure){.seed = 1,
                               .g1 = 0.02,
                               .g2 = -0.03,
                               .chips_x = 1,
                               .chips_y = 1,
                               .nx = 2048,
                               .ny = 2048,
                               .gap_px = 100,
                               .ra_deg = 150.1,
                               .dec_deg = 2.2,
                               .pixel_scale_arcsec = 0.263,
                               .galaxies = 10.0,
                               .stars = 2.0,
                               .flux_min = 2000.0,
                               .flux_max = 50000.0,
                               .flux_slope = 1.0,
                               .r_half_min = 0.35,
                               .r_half_max = 0.7,
                               .ellipticity = 0.2,
                               .star_flux_min = 5000.0,
                               .star_flux_max = 2e6,
                               .star_flux_slope = 0.3,
                               .moffat = SHEAR_MOCK_MOFFAT_35,
                               .fwhm_px = 3.8,
                               .psf_e1 = 0.02,
                               .psf_e2 = -0.01,
                               .psf_variation = 0.05,
                               .sky = 400.0,
                               .gain = 2.5,
                               .read_noise = 5.0,
                               .saturation = 40000.0,
                               .bad_columns = 2,
                               .cosmic_rays = 50,
                               .exposure_time = 90.0};
}

const shear_mock_option *shear_mock_exposure_options(size_t *n) {
    *n = options.n;
    return table;
}

int shear_mock_exposure_set(shear_mock_exposure *e, const char *name, const char *text,
                            shear_error *err) {
    return option_set(&options, e, name, text, err);
}

char *shear_mock_exposure_format(const shear_mock_exposure *e, const shear_mock_option *option,
                                 char *buf, size_t size) {
    return option_format(e, option, buf, size);
}

/* Return the length of the field's diagonal, degrees, without distortion. */
static double diagonal_deg(const shear_mock_exposure *e) {
    const double width = e->chips_x * (e->nx + e->gap_px);
    const double height = e->chips_y * (e->ny + e->gap_px);
    return hypot(width, height) * e->pixel_scale_arcsec / 3600.0;
}

static int check_sky(const shear_mock_exposure *e, shear_error *err) {
    if (hypot(e->g1, e->g2) > 0.9 || hypot(e->skew1, e->skew2) > 0.3) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "mock options 'shear' and 'skew': |g| is at most 0.9 and 0.3");
    }
    if (!(e->ra_deg >= 0.0 && e->dec_deg <= 90.0)) {
        return shear_fail(err, SHEAR_E_SETTING, "give RA from 0 to 360 and Dec from -90 to 90",
                          "mock option 'pointing': there is no place %g,%g on the sky", e->ra_deg,
                          e->dec_deg);
    }
    if (diagonal_deg(e) > 20.0) {
        return shear_fail(err, SHEAR_E_SETTING, "give fewer or smaller chips, or a finer scale",
                          "mock option 'chips': the field would be %.3g degrees wide, more than 20",
                          diagonal_deg(e));
    }
    return SHEAR_OK;
}

static int check_range(const char *name, double min, double max, shear_error *err) {
    if (min <= max)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_SETTING, "give the smaller number first",
                      "mock option '%s': the range from %g to %g is empty", name, min, max);
}

static int check_objects(const shear_mock_exposure *e, shear_error *err) {
    TRY(check_range("flux", e->flux_min, e->flux_max, err));
    TRY(check_range("star-flux", e->star_flux_min, e->star_flux_max, err));
    TRY(check_range("r-half", e->r_half_min, e->r_half_max, err));
    if (e->spacing_px > 0.0 && e->spacing_px < 8.0) {
        return shear_fail(err, SHEAR_E_SETTING, "give 0 for random places",
                          "mock option 'spacing': a grid of %g px is finer than 8 px",
                          e->spacing_px);
    }
    const double side = e->pixel_scale_arcsec / 60.0;
    const double objects = (e->galaxies + e->stars) * side * side * e->nx * e->ny;
    if (objects > max_objects) {
        return shear_fail(err, SHEAR_E_SETTING, "lower the densities, or give smaller chips",
                          "mock option 'galaxies': a chip would have %.3g objects, more than %.3g",
                          objects, max_objects);
    }
    if (hypot(e->psf_e1, e->psf_e2) + e->psf_variation > 0.8) {
        return shear_fail(err, SHEAR_E_SETTING, "lower psf-shape or psf-variation",
                          "mock option 'psf-shape': the PSF would be too elongated at a corner");
    }
    return SHEAR_OK;
}

int shear_mock_exposure_check(const shear_mock_exposure *e, shear_error *err) {
    TRY(option_check_ranges(&options, e, err));
    TRY(check_sky(e, err));
    return check_objects(e, err);
}
