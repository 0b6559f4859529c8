/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "options.h"

#include "option.h"

static const char *const galaxy_names[] = {"regular", "irregular", NULL};
static const char *const psf_names[] = {"a", "b", NULL};
static const char *const layout_names[] = {"cube", "mosaic", NULL};

#define AT(member) offsetof(shear_mock_spec, member)

static const shear_mock_option table[] = {
    ROW("stamps", COUNT, n_stamps, 1, 1e9, "N", "stamp pairs"),
    ROW("size", SIZE, nx, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE, "NX[xNY]", "pixels of a stamp"),
    ROW("seed", SEED, seed, 0, 0, "S", "same seed: same galaxies and noise, at any shear"),
    ROW("shear", PAIR, g1, -0.99, 0.99, "G1,G2", "the true shear"),
    ROW("rotate", INT, rotate, 1, 4, "1|2|4",
        "each galaxy at 0, at 0 and 90, or at 0, 45, 90 and 135 degrees, in neighbouring stamps"),
    SWITCH("no-shift", OFF, shift, "no random sub-pixel position of the galaxies"),
    ROW("offset", PAIR, offset_x, -512, 512, "DX,DY", "move every galaxy by this much, px"),
    SWITCH("share-shift", ON, share_shift,
           "the rotated copies of a galaxy have the same sub-pixel position"),
    SWITCH("share-noise", ON, share_noise, "the rotated copies of a galaxy have the same noise"),
    SWITCH(
        "turn-stamps", ON, turn_stamps,
        "copies at 90 degrees are whole stamps turned, position and noise too, under the same PSF"),
    CHOICE("galaxy", galaxy, galaxy_names, "regular|irregular", "disk and bulge, or random walk"),
    ROW("r-gal", DOUBLE, r_gal_px, 0.01, 512, "PX", "radius R_G at which galaxies are cut"),
    ROW("points", INT, points, 1, 1e6, "N", "points of a regular galaxy"),
    ROW("bulge-fraction", DOUBLE, bulge_fraction, 0, 100, "X",
        "f_b/d, central brightness of the bulge over the disk's"),
    ROW("disk-scale", DOUBLE, disk_scale, 0.05, 1000, "X", "r_disk / R_G"),
    ROW("bulge-ratio", DOUBLE, bulge_ratio, 0.01, 100, "X", "r_disk / r_bulge"),
    ROW("inclination", PAIR, inclination_min_deg, 0, 90, "MIN,MAX",
        "range of the regular galaxies' inclinations, degrees"),
    ROW("steps", INT, steps, 1, 1e6, "N", "steps of an irregular galaxy"),
    ROW("step-size", DOUBLE, step_px, 1e-3, 512, "PX", "length of a step"),
    CHOICE("psf", psf, psf_names, "a|b", "PSF form: a, or b with diffraction spikes"),
    ROW("r-psf", DOUBLE, r_psf_px, 0.1, 100, "PX", "scale radius of the PSF"),
    ROW("psf-angle", DOUBLE, psf_angle_deg, -360, 360, "DEG", "turns the PSF from x towards y"),
    ROW("oversamp", INT, oversample, 1, SHEAR_MAX_PSF_OVERSAMPLE, "K",
        "samples of the PSF image per pixel"),
    ROW_AUTO("psf-size", INT, psf_size, SHEAR_MIN_PSF_SIDE, SHEAR_MAX_PSF_SIDE, "N",
             "samples per side of the PSF image (auto: all above 1e-20 of the peak)"),
    SWITCH("psf-per-stamp", ON, psf_per_stamp, "every stamp has its own PSF, at a random angle"),
    ROW("psf-ids", INT, psf_ids, 0, 1e6, "K",
        "K PSFs at random angles, told apart by PSF_ID (0: one)"),
    ROW("noise-stamps", INT, noise_stamps, 1, SHEAR_MAX_NOISE_PLANES, "N",
        "noise stamps per galaxy"),
    ROW("noise-ratio", DOUBLE, noise_ratio, 0, 1e6, "X",
        "astronomical noise: I_N/I_G, its mean flux density over the galaxy's (0: none)"),
    ROW_AUTO("noise-density", DOUBLE, noise_density, 1e-9, 1e4, "N",
             "its point sources per square pixel (auto: 1/R_PSF^2)"),
    ROW("white", DOUBLE, white_sigma, 0, 1e12, "SIGMA",
        "white Gaussian noise per pixel, in units of a point's peak or in photons (0: none)"),
    ROW("photons", DOUBLE, photons, 0, 1e8, "N",
        "photon counting: mean number of background photons per pixel (0: none)"),
    ROW("photon-snr", DOUBLE, photon_snr, 1e-9, 1e6, "X",
        "mean surface brightness of the galaxy over that of the background"),
    SWITCH("subtract-background", ON, subtract_background,
           "take the mean background off the photon counts"),
    ROW("field", TEXT, field, 0, 0, "NAME", "the field's name (none: the file's)"),
    CHOICE("layout", layout, layout_names, "cube|mosaic", "of the stamps in the file"),
    ROW("bitpix", INT, bitpix, -64, -32, "-32|-64", "pixel type: float or double"),
    SWITCH("no-r-gal", OFF, write_r_gal, "leave R_GAL out of the catalog"),
};

static const option_table options = {table, sizeof table / sizeof *table};

const shear_mock_option *shear_mock_options(size_t *n) {
    *n = options.n;
    return table;
}

const shear_mock_option *shear_mock_option_find(const char *name) {
    return option_find(&options, name);
}

int options_check_ranges(const shear_mock_spec *s, shear_error *err) {
    return option_check_ranges(&options, s, err);
}

int shear_mock_set(shear_mock_spec *s, const char *name, const char *text, shear_error *err) {
    return option_set(&options, s, name, text, err);
}

char *shear_mock_format(const shear_mock_spec *s, const shear_mock_option *o, char *buf,
                        size_t size) {
    return option_format(s, o, buf, size);
}
