/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_mocks/exposure.h: mock exposures: chips with galaxies and stars on the sky, as a camera
 * takes them.
 *
 * Every object is drawn from a closed form in Fourier space, galaxy times PSF times pixel response,
 * through the local Jacobian of the chip's coordinates: there is no grid and no interpolation.
 * Pixels count from 1, as in FITS.
 *
 * Notes
 *
 * 1. Frame. Shear and galaxies are on the sky, x to the West, y to the North, in the tangent plane
 *    at each galaxy; the PSF is in pixels. Shear conserves a galaxy's area and flux.
 *
 * 2. Galaxies are exponential disks, elliptical before they are sheared; the PSF is a Moffat
 *    profile whose size and ellipticity vary smoothly over the field. The pixel response (a square)
 *    comes on top: the PSF of a star stamp is that of the table PSF_* times the pixel.
 *
 * 3. Every random number is a function of (seed, purpose, chip, number of the object or row). With
 *    the same seed and another shear, an exposure has the same galaxies, places and noise. Places
 *    that are not sheared dilute the shear of galaxies that overlap: shear_places moves them, about
 *    the centres of cells of 400 px.
 *
 * 4. Coordinates are TAN, or TPV with --distortion or --skew: with (x, y) = CD (pixel - CRPIX) in
 *    degrees, xi = x (1 + s1) + y s2 + k x r^2, eta = y (1 - s1) + x s2 + k y r^2.
 */
#ifndef SHEAR_MOCKS_EXPOSURE_H
#define SHEAR_MOCKS_EXPOSURE_H

#include "shear_mocks/mock.h"

/* exp[-x] times a polynomial is the transform of a Moffat profile of these exponents. */
enum shear_mock_moffat { SHEAR_MOCK_MOFFAT_25 = 0, SHEAR_MOCK_MOFFAT_35, SHEAR_MOCK_MOFFAT_45 };

typedef struct shear_mock_exposure {
    uint64_t seed;
    double g1, g2;
    /* chips */
    int chips_x, chips_y; /* in the mosaic */
    int nx, ny;           /* pixels of a chip */
    double gap_px;        /* between chips */
    /* sky */
    double ra_deg, dec_deg;    /* of the field's centre */
    double pixel_scale_arcsec; /* at the field's centre, without skew */
    double rotation_deg;       /* from West to North; at 0 x is West and y North */
    bool mirrored;             /* x is reversed, before the rotation */
    double distortion;         /* radial distortion: its shear at the field's corner */
    double skew1, skew2;       /* constant shear of the coordinates */
    /* objects */
    double galaxies, stars;              /* per square arcmin */
    double spacing_px;                   /* of a jittered grid; 0: random places */
    bool shear_places;                   /* distances between galaxies are sheared, too */
    bool fours;                          /* each galaxy at 0, 45, 90, 135 degrees */
    double flux_min, flux_max;           /* of galaxies, ADU */
    double flux_slope;                   /* N(> F) is proportional to F^-slope */
    double r_half_min, r_half_max;       /* half-light radius, arcsec; uniform between */
    double ellipticity;                  /* standard deviation of e1 and e2 */
    double star_flux_min, star_flux_max; /* ADU */
    double star_flux_slope;
    /* PSF */
    enum shear_mock_moffat moffat;
    double fwhm_px;        /* mean over the field */
    double psf_e1, psf_e2; /* mean ellipticity (1 - q) / (1 + q) */
    double psf_variation;  /* relative change of the size from the centre to a corner; ellipticity
                              changes by half of it */
    /* detector */
    double sky;           /* background, ADU per pixel */
    double gain;          /* electrons per ADU */
    double read_noise;    /* electrons */
    bool source_noise;    /* the objects' own photon noise, too */
    double correlation;   /* of the noise of neighbouring pixels */
    double saturation;    /* ADU */
    double exposure_time; /* seconds; keyword only */
    int bad_columns;      /* per chip */
    int cosmic_rays;      /* tracks per chip */
} shear_mock_exposure;

/* Set the defaults: one chip of 2048 x 2048 px at 0.263 arcsec, random places. */
void shear_mock_exposure_init(shear_mock_exposure *e);
/* Return SHEAR_OK, or SHEAR_E_SETTING with a message that names the option. */
int shear_mock_exposure_check(const shear_mock_exposure *e, shear_error *err);

/* The table of options, as that of mock.h: offsets are in shear_mock_exposure. */
const shear_mock_option *shear_mock_exposure_options(size_t *n);
int shear_mock_exposure_set(shear_mock_exposure *e, const char *name, const char *text,
                            shear_error *err);
char *shear_mock_exposure_format(const shear_mock_exposure *e, const shear_mock_option *option,
                                 char *buf, size_t size);

/* Numbers of an exposure that has been written. */
typedef struct shear_mock_exposure_counts {
    int64_t galaxies, stars;
    int64_t bad_pixels, saturated_pixels;
} shear_mock_exposure_counts;

/* Write PATH (the images, CHIP1 ...), and beside it, if PATH is OUT.fits: OUT.weight.fits (inverse
 * variance of the background, 0: bad), OUT.mask.fits (bits: 1 bad column, 2 cosmic ray, 4
 * saturated) and OUT.truth.fits (table TRUTH, a row per object). Existing files are replaced only
 * if `options` says so; they get their names when all are complete. `options` and `counts` may be
 * NULL. */
int shear_mock_exposure_write(const shear_mock_exposure *e, const char *path,
                              const shear_mock_write_options *options,
                              shear_mock_exposure_counts *counts, shear_error *err);

#endif
