/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_mocks/mock.h: mock fields as in section 4.1 of Zhang (2010).
 *
 * Galaxies and astronomical noise are collections of point sources. A point of amplitude A at x
 * adds A W(y - x) to the pixel whose centre is y, with W as in eq. (9) of the paper (W_A(0) = 1).
 * An image is the exact sum over its points, without grids or Fourier transforms. All lengths are
 * in galaxy pixels; axes and signs of the shear are those of shear/stamp.h and docs/method.md.
 *
 * Notes
 *
 * 1. Every random number is a function of (seed, purpose, index of the galaxy or stamp, number of
 *    the draw), by the counter-based generator Philox4x64-10. A galaxy's points depend only on the
 *    seed and its index; a stamp's noise depends only on the seed, the stamp's index, and whether
 *    it is the galaxy or the noise stamp. Neither depends on the shear, the threads, the chunks or
 *    other kinds of noise: the same seed with another shear gives the same galaxies and noise.
 *    (Photon counts depend on their pixel's mean; each pixel has its own sequence.)
 *
 * 2. Lensing conserves surface brightness. For collections of points under a constant shear this
 *    multiplies all amplitudes by det A = 1 - g1^2 - g2^2.
 *
 * 3. A point contributes to every pixel where its PSF exceeds 1e-20 of the peak, with an error
 *    below 1e-12 of the contribution plus 1e-20 of the peak. Fainter contributions may be omitted.
 */
#ifndef SHEAR_MOCKS_MOCK_H
#define SHEAR_MOCKS_MOCK_H

#include "shear/error.h"
#include "shear/field.h"
#include "shear/plan.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum shear_mock_galaxy {
    SHEAR_MOCK_REGULAR =
        0, /* thin disk and co-axial bulge, eq. (10) of Zhang (2010), cut at R_G, inclined */
    SHEAR_MOCK_IRREGULAR /* random walk that returns to the origin when it leaves R_G */
};
enum { SHEAR_MOCK_TEXT_SIZE = 72 };                             /* of a text option */
enum shear_mock_psf { SHEAR_MOCK_PSF_A = 0, SHEAR_MOCK_PSF_B }; /* W_A and W_B of eq. (9) */

typedef struct shear_mock_spec {
    /* field */
    int64_t n_stamps;
    int nx, ny; /* of a stamp */
    uint64_t seed;
    double g1, g2;
    int rotate; /* 1, 2 (each galaxy at 0 and 90 degrees), 4 (0, 45, 90, 135): stamp i shows */
                /* galaxy i / rotate, rotated before lensing */
    bool shift; /* centre each galaxy at a random point of one pixel */
    double offset_x, offset_y; /* added to every galaxy's centre, px */
    bool share_shift;          /* the rotated copies of a galaxy have the same random shift */
    bool share_noise;          /* ... and the same random numbers of the noise */
    bool turn_stamps; /* the copy at 90 (135) degrees has the position and noise of that at 0 (45),
                         rotated about the stamp's centre; only the PSF is not rotated */
    /* galaxies */
    enum shear_mock_galaxy galaxy;
    double r_gal_px;                                 /* R_G */
    int points;                                      /* of a regular galaxy */
    double bulge_fraction;                           /* f_b/d */
    double disk_scale;                               /* r_disk / R_G */
    double bulge_ratio;                              /* r_disk / r_bulge */
    double inclination_min_deg, inclination_max_deg; /* uniform between; 0 = face on */
    int steps; /* of a random walk; the joints beyond R_G leave fewer points */
    double step_px;
    /* PSF */
    enum shear_mock_psf psf;
    double r_psf_px;      /* R_PSF */
    double psf_angle_deg; /* rotation from x towards y; at 0 both PSFs are longer along y */
    int oversample;       /* samples of the PSF image per pixel */
    int psf_size; /* samples per side; 0: the odd number that contains the PSF down to 1e-20 */
    bool psf_per_stamp; /* each stamp has its own PSF, at a random angle */
    int psf_ids; /* number of PSFs at random angles, galaxy i has number i % psf_ids; 0: one PSF */
    /* noise */
    int noise_stamps;     /* noise stamps per galaxy */
    double noise_ratio;   /* I_N / I_G of the point-source noise; 0: none */
    double noise_density; /* its points per square pixel; NaN: one per R_PSF^2 */
    double white_sigma;   /* per pixel, in the unit of the pixel values; 0: none */
    double photons;       /* mean number of background photons per pixel; 0: no photon counting */
    double photon_snr; /* surface brightness of the galaxy over that of the background, if photons >
                          0 */
    bool subtract_background; /* subtract the mean background from the counted photons */
    /* file */
    char field[SHEAR_MOCK_TEXT_SIZE]; /* FIELD; "": the file's base name */
    enum shear_layout layout;
    int bitpix;       /* -32 or -64 */
    bool write_r_gal; /* CATALOG has R_GAL = R_G */
} shear_mock_spec;

/* Set the defaults: 2000 regular galaxies of 600 points in rotated pairs, R_G = 6, R_PSF = 1.5, 64
 * x 64 pixels, no noise. */
void shear_mock_spec_init(shear_mock_spec *s);
/* Return SHEAR_OK, or SHEAR_E_SETTING with a message that names the option. */
int shear_mock_spec_check(const shear_mock_spec *s, shear_error *err);

/* ---- the table of options, for the command line and the HISTORY lines of a field file ---- */
enum shear_mock_type {
    SHEAR_MOCK_T_INT,    /* int */
    SHEAR_MOCK_T_COUNT,  /* int64_t */
    SHEAR_MOCK_T_SEED,   /* uint64_t */
    SHEAR_MOCK_T_DOUBLE, /* double */
    SHEAR_MOCK_T_PAIR,   /* double, double: "X,Y" */
    SHEAR_MOCK_T_SIZE,   /* int, int: "N" or "NXxNY" */
    SHEAR_MOCK_T_CHOICE, /* int: index into choices */
    SHEAR_MOCK_T_ON,     /* bool, no value: given = true */
    SHEAR_MOCK_T_OFF,    /* bool, no value: given = false ("no-...") */
    SHEAR_MOCK_T_TEXT    /* char[SHEAR_MOCK_TEXT_SIZE] */
};

typedef struct shear_mock_option {
    const char *name;           /* as in --name */
    size_t offset;              /* of the (first) member in the spec */
    const char *const *choices; /* NULL-terminated, in the enum's order */
    double min, max;            /* inclusive range of each number */
    const char *metavar;        /* "PX"; NULL if the option has no value */
    const char *help;           /* one line */
    enum shear_mock_type type;
    bool has_auto; /* "auto" is allowed (0 for ints, NaN for doubles) */
} shear_mock_option;

/* Return the table; *n becomes the number of its entries. */
const shear_mock_option *shear_mock_options(size_t *n);
/* Return the entry called `name`, or NULL. */
const shear_mock_option *shear_mock_option_find(const char *name);
/* Parse `text` as the value of option `name`; for ON and OFF it is NULL, "yes" or "no". Returns
 * SHEAR_OK, or SHEAR_E_SETTING with a message that names the option and the expected value; *s is
 * unchanged then. */
int shear_mock_set(shear_mock_spec *s, const char *name, const char *text, shear_error *err);
/* Write the value so that shear_mock_set reads back the same bits. Returns buf. */
char *shear_mock_format(const shear_mock_spec *s, const shear_mock_option *option, char *buf,
                        size_t size);

/* ---- a mock: a checked spec and derived values; immutable, shared by threads ---- */
typedef struct shear_mock shear_mock;

typedef struct shear_mock_info {
    shear_geometry geometry;
    int64_t n_stamps, n_galaxies, n_psf;
    enum shear_psf_layout psf_layout;
    int max_points;         /* upper limit of a galaxy's points */
    double psf_peak;        /* W(0): 1 for W_A, 1.029 for W_B */
    double psf_flux;        /* integral of W over the plane, px^2 */
    double point_amplitude; /* of a galaxy's points, before the factor det A: 1, or in photons */
    double noise_density;   /* point-source noise: points per px^2 ... */
    double noise_amplitude; /* ... and the amplitude of each */
} shear_mock_info;

/* Create a mock. Returns SHEAR_OK, SHEAR_E_SETTING or SHEAR_E_NOMEM; *m is NULL on error. */
int shear_mock_new(shear_mock **m, const shear_mock_spec *spec, shear_error *err);
void shear_mock_free(shear_mock *m);
const shear_mock_info *shear_mock_get_info(const shear_mock *m);
const shear_mock_spec *shear_mock_get_spec(const shear_mock *m);

/* Compute the points of galaxy number `galaxy` before rotation and lensing, relative to its centre,
 * px: x, y [max_points]. Returns the number of points: spec.points for a regular galaxy, at most
 * spec.steps for an irregular one. */
int shear_mock_points(const shear_mock *m, int64_t galaxy, double *x, double *y);
/* Compute the same points as they appear in `stamp`: rotated and lensed, relative to the galaxy's
 * centre. */
int shear_mock_image_points(const shear_mock *m, int64_t stamp, double *x, double *y);
/* Compute the position of the galaxy relative to the stamp's centre ((nx-1)/2, (ny-1)/2), px: X and
 * Y of CATALOG. */
void shear_mock_centre(const shear_mock *m, int64_t stamp, double *x, double *y);

/* Return the index of a stamp's PSF, 0 .. n_psf-1; below, the angle of a PSF in degrees. */
int64_t shear_mock_psf_of(const shear_mock *m, int64_t stamp);
double shear_mock_psf_angle(const shear_mock *m, int64_t psf);
/* Compute the image of a PSF, point-sampled, with its centre at (psf_nx-1)/2: out [psf_ny][psf_nx].
 */
void shear_mock_psf_image(const shear_mock *m, int64_t psf, double *out);

/* Add n points of one amplitude to image [ny][nx], of the stamps' size. x, y [n] are pixel
 * coordinates with (0, 0) at the centre of the first pixel; they must be finite, and may be far
 * outside the image. Returns SHEAR_OK or SHEAR_E_NOMEM. */
int shear_mock_paint(const shear_mock *m, int64_t psf, int n, const double *x, const double *y,
                     double amplitude, double *image, shear_error *err);

/* Draw stamp pairs [first, first+count) on `threads` OpenMP threads (0: all cores), into galaxy
 * [count][ny][nx] and noise [count][noise_stamps][ny][nx]. The pixels do not depend on the number
 * of threads or on the chunks, to the last bit. Returns SHEAR_OK, SHEAR_E_NOMEM, or SHEAR_E_SETTING
 * if the range is outside the field. */
int shear_mock_stamps(const shear_mock *m, int64_t first, int count, int threads, double *galaxy,
                      double *noise, shear_error *err);

/* ---- whole files ---- */
typedef struct shear_mock_write_options {
    int threads;    /* 0: all cores */
    bool overwrite; /* replace an existing file */
    /* Called by the calling thread after each chunk; a non-zero result stops (SHEAR_E_CANCELLED).
     * May be NULL. */
    int (*progress)(void *context, int64_t done, int64_t total);
    void *context;
} shear_mock_write_options;

/* Write the field file `path` (docs/field-files.md) in chunks, with memory for one chunk; on error
 * no file is left behind. CATALOG has ID = stamp number, X, Y (shear_mock_centre), R_GAL if
 * requested, and PSF_ID if psf_ids is set. HISTORY has every option of the table, and there is no
 * date. `options` may be NULL. */
int shear_mock_write(const shear_mock *m, const char *path, const shear_mock_write_options *options,
                     shear_error *err);

#endif
