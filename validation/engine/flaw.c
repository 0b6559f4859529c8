/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/flaw.h"

#include "engine/population.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { MAX_SIDE = 128, KERNEL = 1 };

static const double photon_sky = 100.0; /* photons per pixel */
static const double psf_border = 0.01, psf_star_snr = 100.0, flat_noise = 0.3;
static const double psf_cut_px = 11.0;

/* ---- the table ---- */

#define GROUND       .psf = {LIGHT_MOFFAT, 3.5, {0.05, 0.02}}, .side = 64, .oversample = 1
#define SPACE(sigma) .psf = {LIGHT_STRUTS, sigma, {0.05, 0.02}}, .side = 64, .oversample = 5
#define WORDS        .wish = WISH_TOLD, .fewer = 10

const flaw flaws[] = {
    {"reference", "white noise, nothing wrong", GROUND, .wish = WISH_QUIET, .aim_m = 3.0},
    /* Above S/N 30 the effect is smaller than the threshold of the warning. */
    {"noise-excess", "noise variance 4 % above the noise stamps'", GROUND, .excess = 0.04,
     .wish = WISH_TOLD, .wish_snr = 30.0, .aim_m = 10.0},
    {"photons", "source photons on a sky of 100", GROUND, .noise = FLAW_PHOTONS, .aim_m = 5.0},
    {"correlated-excess", "correlated noise, variance 4 % above", GROUND, .noise = FLAW_CORRELATED,
     .excess = 0.04, .wish = WISH_TOLD, .aim_m = 10.0},
    {"correlated-white", "correlated noise, white noise stamps", GROUND, .noise = FLAW_MISMATCHED,
     .wish = WISH_TOLD},
    {"sky-filter", "sky of 3 sigma in both, a filter", GROUND, .sky = 3.0, .core_px = 20.0,
     .aim_m = 3.0},
    {"sky-r-gal", "sky of 100 sigma in both, R_GAL", GROUND, .sky = 100.0, .r_gal = true,
     .aim_m = 3.0},
    {"cosmics", "cosmic rays of 40 sigma in 10 % of the stamps", GROUND, .artefact = FLAW_COSMICS,
     .wish = WISH_FLAGS, .aim_m = 3.0},
    {"hot-pixel", "a hot pixel of 200 sigma in 1 % of the stamps", GROUND,
     .artefact = FLAW_HOT_PIXEL, .wish = WISH_FLAGS, .aim_m = 3.0},
    {"sentinel", "a pixel of -9999 in 1 % of the stamps", GROUND, .artefact = FLAW_SENTINEL,
     .wish = WISH_FLAGS, .aim_m = 3.0},
    {"star", "one bright star among 64", GROUND, .artefact = FLAW_STAR, WORDS, .stamps = 64},
    {"off-chip", "one stamp off the chip among 64", GROUND, .artefact = FLAW_GAP, WORDS,
     .stamps = 64},
    {"flat-psf", "one flat and noisy PSF among 64", GROUND, .psf_flaw = FLAW_PSF_FLAT_ONE, WORDS,
     .stamps = 64},
    {"space-0.5", "R_PSF 0.5 px", SPACE(0.37), .fewer = 2, .aim_m = 2.0},
    {"space-0.65", "R_PSF 0.65 px", SPACE(0.57), .fewer = 2, .aim_m = 2.0},
    {"space-0.8", "R_PSF 0.8 px", SPACE(0.74), .fewer = 2, .aim_m = 2.0},
    {"psf-border", "PSF: a border of 1 % of the peak", GROUND, .psf_flaw = FLAW_PSF_BORDER,
     .psf_side = 32, WORDS},
    {"psf-corners", "PSF: corner-ordered", GROUND, .psf_flaw = FLAW_PSF_CORNERS, WORDS},
    {"psf-cut", "PSF: cut at 11 px", GROUND, .psf_flaw = FLAW_PSF_CUT, WORDS},
    {"psf-coarse", "PSF: one sample a px, R_PSF 0.56 px",
     .psf = {LIGHT_STRUTS, 0.455, {0.05, 0.02}}, .side = 64, .oversample = 1, WORDS},
    {"psf-star", "PSF: from a star of S/N 100", GROUND, .psf_flaw = FLAW_PSF_STAR, WORDS},
    {"swapped", "galaxy and noise swapped", GROUND, .mistake = FLAW_SWAPPED, WORDS},
    {"equal", "noise is galaxy", GROUND, .mistake = FLAW_EQUAL, WORDS},
    {"weightless", "all weights 0", GROUND, .mistake = FLAW_WEIGHTLESS, WORDS},
    {"oversamp", "OVERSAMP 3 forgotten", .psf = {LIGHT_MOFFAT, 3.5, {0.05, 0.02}}, .side = 64,
     .oversample = 3, .mistake = FLAW_OVERSAMP, WORDS},
    {"small-bulges", "32 px stamps of de Vaucouleurs galaxies",
     .psf = {LIGHT_MOFFAT, 3.5, {0.05, 0.02}}, .side = 32, .oversample = 1, .bulges = true,
     .wish = WISH_NO_EDGE, .fewer = 4},
};

int flaw_count(void) {
    return (int)(sizeof flaws / sizeof flaws[0]);
}

/* ---- noise ---- */

static int poisson(dice *d, double mean) {
    double u = dice_uniform(d);
    double p = exp(-mean);
    int n = 0;
    double sum = p;
    while (u > sum && n < 2000) {
        p *= mean / ++n;
        sum += p;
    }
    return n;
}

static void draw_sky(dice *d, int n, double *out) {
    for (int i = 0; i < n; i++)
        out[i] = poisson(d, photon_sky) - photon_sky;
}

/* Draw white noise smoothed by the kernel (1 2 1; 2 4 2; 1 2 1) / 6, which has unit variance. */
static void draw_correlated(dice *d, int side, double *out) {
    static const double weight[] = {1.0, 2.0, 1.0};
    double white[(MAX_SIDE + 2 * KERNEL) * (MAX_SIDE + 2 * KERNEL)];
    const int wide = side + 2 * KERNEL;
    assert(side <= MAX_SIDE);
    dice_normal(d, wide * wide, white);
    for (int y = 0; y < side; y++) {
        for (int x = 0; x < side; x++) {
            double sum = 0.0;
            for (int k = 0; k < 9; k++)
                sum += weight[k / 3] * weight[k % 3] * white[(y + k / 3) * wide + x + k % 3];
            out[y * side + x] = sum / 6.0;
        }
    }
}

static void draw(enum flaw_noise kind, dice d, int side, double *out) {
    if (kind == FLAW_PHOTONS) {
        draw_sky(&d, side * side, out);
    } else if (kind == FLAW_CORRELATED) {
        draw_correlated(&d, side, out);
    } else {
        dice_normal(&d, side * side, out);
    }
}

void flaw_draw_noise(const flaw *f, uint64_t seed, int64_t index, double *galaxy, double *noise) {
    const enum flaw_noise kind = f->noise == FLAW_MISMATCHED ? FLAW_CORRELATED : f->noise;
    draw(kind, dice_begin(seed, DICE_NOISE, index), f->side, galaxy);
    draw(f->noise == FLAW_MISMATCHED ? FLAW_WHITE : kind, dice_begin(seed, DICE_NOISE_STAMP, index),
         f->side, noise);
}

/* ---- artefacts ---- */

bool flaw_spoils(const flaw *f, uint64_t seed, int64_t index) {
    dice d = dice_begin(seed, DICE_ARTEFACT, index);
    switch (f->artefact) {
    case FLAW_COSMICS:
        return dice_uniform(&d) < 0.1;
    case FLAW_HOT_PIXEL:
    case FLAW_SENTINEL:
        return dice_uniform(&d) < 0.01;
    case FLAW_STAR:
    case FLAW_GAP:
        return index % f->stamps == f->stamps / 2;
    default:
        return f->psf_flaw == FLAW_PSF_FLAT_ONE && index % f->stamps == f->stamps / 2;
    }
}

/* Add a streak of one to three pixels along a row, at a random position. */
static void add_cosmic(const flaw *f, dice *d, double *image) {
    const int length = 1 + (int)(3.0 * dice_uniform(d));
    const int x = (int)((f->side - length) * dice_uniform(d));
    const int y = (int)(f->side * dice_uniform(d));
    for (int i = 0; i < length; i++)
        image[y * f->side + x + i] += 40.0;
}

/* Add a star of the PSF's size and ten thousand sigma at a random position. */
static void add_star(const flaw *f, dice *d, double *image) {
    const double width = 0.5 * f->psf.size;
    const double x0 = f->side * (0.35 + 0.3 * dice_uniform(d));
    const double y0 = f->side * (0.35 + 0.3 * dice_uniform(d));
    for (int i = 0; i < f->side * f->side; i++) {
        const double r = hypot(i % f->side - x0, (double)(i / f->side) - y0);
        image[i] += 1e4 * pow(1.0 + 0.35 * r * r / (width * width), -3.5);
    }
}

/* Set the pixels beyond a straight edge to zero counts: minus the sky that was subtracted. */
static void cut_chip(const flaw *f, double *image) {
    for (int i = 0; i < f->side * f->side; i++)
        image[i] = i % f->side > f->side / 2 + 8 ? -100.0 : image[i];
}

static void add_artefact(const flaw *f, uint64_t seed, int64_t index, double *image) {
    dice d = dice_begin(seed, DICE_ARTEFACT, index);
    dice_uniform(&d); /* skip the number that selected the stamp */
    const int pixel = (int)(f->side * f->side * dice_uniform(&d));
    switch (f->artefact) {
    case FLAW_COSMICS:
        add_cosmic(f, &d, image);
        break;
    case FLAW_HOT_PIXEL:
        image[pixel] += 200.0;
        break;
    case FLAW_SENTINEL:
        image[pixel] = -9999.0;
        break;
    case FLAW_STAR:
        add_star(f, &d, image);
        break;
    case FLAW_GAP:
        cut_chip(f, image);
        break;
    default:
        break;
    }
}

/* ---- both stamps ---- */

/* Add photon noise. The sky's photons are the same at any shear. The galaxy's are too, as far as
 * possible: a pixel's random number selects the same quantile of its distribution. */
static void count_photons(const flaw *f, uint64_t seed, int64_t index, const double *sky,
                          double *galaxy) {
    dice d = dice_begin(seed, DICE_PHOTONS, index);
    const double unit = sqrt(photon_sky);
    for (int i = 0; i < f->side * f->side; i++)
        galaxy[i] = sky[i] + poisson(&d, fmax(0.0, unit * galaxy[i]));
}

static void make_mistake(const flaw *f, double *galaxy, double *noise) {
    const int n = f->side * f->side;
    for (int i = 0; f->mistake == FLAW_SWAPPED && i < n; i++) {
        const double pixel = galaxy[i];
        galaxy[i] = noise[i];
        noise[i] = pixel;
    }
    if (f->mistake == FLAW_EQUAL)
        memcpy(noise, galaxy, (size_t)n * sizeof *noise);
}

void flaw_apply(const flaw *f, uint64_t seed, int64_t index, const double *noise_galaxy,
                const double *noise_noise, double *galaxy, double *noise) {
    const double factor = sqrt(1.0 + f->excess);
    const int n = f->side * f->side;
    if (f->noise == FLAW_PHOTONS) {
        count_photons(f, seed, index, noise_galaxy, galaxy);
        memcpy(noise, noise_noise, (size_t)n * sizeof *noise);
    } else {
        for (int i = 0; i < n; i++) {
            galaxy[i] += f->sky + factor * noise_galaxy[i];
            noise[i] = f->sky + noise_noise[i];
        }
    }
    if (flaw_spoils(f, seed, index))
        add_artefact(f, seed, index, galaxy);
    make_mistake(f, galaxy, noise);
}

/* ---- PSFs ---- */

static double peak_of(const double *image, int n) {
    double peak = image[0];
    for (int i = 1; i < n; i++)
        peak = fmax(peak, image[i]);
    return peak;
}

static void order_corners(int side, double *psf) {
    double copy[MAX_SIDE * MAX_SIDE];
    memcpy(copy, psf, (size_t)(side * side) * sizeof *copy);
    for (int i = 0; i < side * side; i++) {
        int x = (i % side + side / 2) % side;
        int y = (i / side + side / 2) % side;
        psf[i] = copy[y * side + x];
    }
}

static void add_star_noise(uint64_t seed, int n, double *psf) {
    dice d = dice_begin(seed, DICE_NOISE, -1);
    double noise[MAX_SIDE * MAX_SIDE];
    double square = 0.0;
    for (int i = 0; i < n; i++)
        square += psf[i] * psf[i];
    dice_normal(&d, n, noise);
    for (int i = 0; i < n; i++)
        psf[i] += sqrt(square) / psf_star_snr * noise[i];
}

void flaw_spoil_psf(const flaw *f, uint64_t seed, int64_t index, int side, double *psf) {
    const int n = side * side;
    const double peak = peak_of(psf, n);
    double noise[MAX_SIDE * MAX_SIDE] = {0.0};
    if (f->psf_flaw == FLAW_PSF_FLAT_ONE) {
        dice d = dice_begin(seed, DICE_NOISE, -2);
        dice_normal(&d, n, noise);
    }
    if (f->psf_flaw == FLAW_PSF_CORNERS) {
        order_corners(side, psf);
    } else if (f->psf_flaw == FLAW_PSF_STAR) {
        add_star_noise(seed, n, psf);
    }
    for (int i = 0; i < n; i++) {
        const double x = i % side - side / 2;
        const double y = (double)(i / side) - side / 2;
        const bool far = fmax(fabs(x), fabs(y)) > 0.5 * psf_cut_px;
        if (f->psf_flaw == FLAW_PSF_BORDER) {
            psf[i] += psf_border * peak;
        } else if (f->psf_flaw == FLAW_PSF_CUT && far) {
            psf[i] = 0.0;
        } else if (f->psf_flaw == FLAW_PSF_FLAT_ONE && index == f->stamps / 2) {
            psf[i] = peak * (1.0 + flat_noise * noise[i]);
        }
    }
}
