/* SPDX-License-Identifier: GPL-3.0-or-later */
/* flaw.h: what real data have that ideal ones have not, as a table; and what is asked of the
 * default settings under each.
 *
 * The noise of a pixel is the unit: the stamps of a galaxy of signal-to-noise S are S times the
 * noise-free image, whose sum of squares was brought to 1, plus noise of standard deviation 1 (10,
 * where photons are counted).
 */
#ifndef VALIDATION_FLAW_H
#define VALIDATION_FLAW_H

#include "engine/light.h"

#include <stdbool.h>
#include <stdint.h>

enum flaw_noise { FLAW_WHITE, FLAW_CORRELATED, FLAW_MISMATCHED, FLAW_PHOTONS };
enum flaw_artefact { FLAW_CLEAN, FLAW_COSMICS, FLAW_HOT_PIXEL, FLAW_SENTINEL, FLAW_STAR, FLAW_GAP };
enum flaw_psf {
    FLAW_PSF_GOOD,
    FLAW_PSF_FLAT_ONE, /* of 64 that are told apart by PSF_ID, one is flat but for noise */
    FLAW_PSF_BORDER,
    FLAW_PSF_CORNERS,
    FLAW_PSF_CUT,
    FLAW_PSF_STAR
};
enum flaw_mistake { FLAW_NONE, FLAW_SWAPPED, FLAW_EQUAL, FLAW_WEIGHTLESS, FLAW_OVERSAMP };

/* What is asked for, beside |m|: any telling (a refusal, no shear, a flag, a warning); a flag for
 * each spoilt stamp, and for no other; no advice for a filter at the edge; no word at all. */
enum flaw_wish { WISH_NOTHING, WISH_TOLD, WISH_FLAGS, WISH_NO_EDGE, WISH_QUIET };

typedef struct flaw {
    const char *name; /* no blanks */
    const char *label;
    light_psf psf;
    int side;       /* of the stamps, px */
    int oversample; /* samples of the PSF image per pixel */
    int psf_side;   /* of the PSF image, samples; 0 = 64, or 256 where several are in a pixel */
    bool bulges;    /* de Vaucouleurs-like galaxies */
    enum flaw_noise noise;
    double excess;  /* the noise variance under galaxies is 1 + excess times the noise stamps' */
    double sky;     /* left in both stamps, in units of the noise */
    double core_px; /* a filter of this core; 0 = the settings' */
    bool r_gal;     /* the catalog knows R_GAL = 3 half-light radii */
    enum flaw_artefact artefact;
    enum flaw_psf psf_flaw;
    enum flaw_mistake mistake;
    enum flaw_wish wish;
    double wish_snr; /* asked for at this signal-to-noise and below; 0 = always */
    double aim_m;    /* largest |m|, 10^-3, beside two errors; 0 = none is asked for */
    int fewer; /* so many times fewer galaxies, where 2 and more: slow ones, or only words are asked
                  for */
    int stamps; /* of a file; 0 = as many as there are */
} flaw;

extern const flaw flaws[];
int flaw_count(void);

/* ---- one pair of stamps ---- */

/* The noise of stamp number `index` and of its noise stamp, of unit variance, before the excess:
 * [side][side] each; where photons are counted, the sky's, with its mean off. */
void flaw_draw_noise(const flaw *f, uint64_t seed, int64_t index, double *galaxy, double *noise);
/* Both stamps from the galaxy's image and the noises; in place: `galaxy` holds the image, S times
 * one of unit square sum. */
void flaw_apply(const flaw *f, uint64_t seed, int64_t index, const double *noise_galaxy,
                const double *noise_noise, double *galaxy, double *noise);
/* Is this stamp one that is to be flagged? */
bool flaw_spoils(const flaw *f, uint64_t seed, int64_t index);

/* PSF number `index` of the file, from the true one; [side][side] in place. `seed` draws the noise
 * of a star's image. */
void flaw_spoil_psf(const flaw *f, uint64_t seed, int64_t index, int side, double *psf);

#endif
