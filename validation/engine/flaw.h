/* SPDX-License-Identifier: GPL-3.0-or-later */
/* flaw.h: the table of flaws of real data, and what the default settings must achieve with each of
 * them.
 *
 * The unit is the noise of a pixel: a galaxy of signal-to-noise S is S times a noise-free image
 * with a sum of squares of 1, plus noise of standard deviation 1 (10 with photon counting). */
#pragma once

#include "engine/light.h"

#include <stdbool.h>
#include <stdint.h>

enum flaw_noise { FLAW_WHITE, FLAW_CORRELATED, FLAW_MISMATCHED, FLAW_PHOTONS };
enum flaw_artefact { FLAW_CLEAN, FLAW_COSMICS, FLAW_HOT_PIXEL, FLAW_SENTINEL, FLAW_STAR, FLAW_GAP };
enum flaw_psf {
    FLAW_PSF_GOOD,
    FLAW_PSF_FLAT_ONE, /* one of 64 PSFs with different PSF_ID is flat except for noise */
    FLAW_PSF_BORDER,
    FLAW_PSF_CORNERS,
    FLAW_PSF_CUT,
    FLAW_PSF_STAR
};
enum flaw_mistake { FLAW_NONE, FLAW_SWAPPED, FLAW_EQUAL, FLAW_WEIGHTLESS, FLAW_OVERSAMP };

/* The requirement in addition to |m|: any report (a refusal, no shear, a flag, a warning); a flag
 * for exactly the spoilt stamps; no advice to use a filter at the edge; no report at all. */
enum flaw_wish { WISH_NOTHING, WISH_TOLD, WISH_FLAGS, WISH_NO_EDGE, WISH_QUIET };

typedef struct flaw {
    const char *name; /* without spaces */
    const char *label;
    light_psf psf;
    int side;       /* of the stamps, px */
    int oversample; /* samples of the PSF image per pixel */
    int psf_side;   /* of the PSF image, samples; 0: 64, or 256 if oversampled */
    bool bulges;    /* galaxies similar to de Vaucouleurs profiles */
    enum flaw_noise noise;
    double excess;  /* the noise variance of galaxy stamps is 1 + excess times that of the noise
                       stamps */
    double sky;     /* added to both stamps, in units of the noise */
    double core_px; /* the core of a filter; 0: from the settings */
    bool r_gal;     /* the catalog has R_GAL = 3 half-light radii */
    enum flaw_artefact artefact;
    enum flaw_psf psf_flaw;
    enum flaw_mistake mistake;
    enum flaw_wish wish;
    double wish_snr; /* required at this signal-to-noise and below; 0: always */
    double aim_m;    /* required limit of |m| in 10^-3, in addition to two errors; 0: none */
    int fewer;  /* if 2 or more, use this many times fewer galaxies: for slow cases, or if only a
                   report is required */
    int stamps; /* per file; 0: all */
} flaw;

extern const flaw flaws[];
/* Return the number of flaws in the table. */
int flaw_count(void);

/* ---- one stamp pair ---- */

/* Draw the noise of stamp number `index` and of its noise stamp, [side][side] each, of unit
 * variance, before the excess. With photon counting this is the sky's, with its mean subtracted. */
void flaw_draw_noise(const flaw *f, uint64_t seed, int64_t index, double *galaxy, double *noise);
/* Make both stamps from the noises and the galaxy's image, in place: on entry `galaxy` is S times
 * an image with a sum of squares of 1. */
void flaw_apply(const flaw *f, uint64_t seed, int64_t index, const double *noise_galaxy,
                const double *noise_noise, double *galaxy, double *noise);
/* Return whether this stamp should be flagged. */
bool flaw_spoils(const flaw *f, uint64_t seed, int64_t index);

/* Apply the flaw to PSF number `index` of the file, [side][side], in place. `seed` is for the noise
 * of a star's image. */
void flaw_spoil_psf(const flaw *f, uint64_t seed, int64_t index, int side, double *psf);
