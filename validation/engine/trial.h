/* SPDX-License-Identifier: GPL-3.0-or-later */
/* trial.h: galaxies under a flaw, at +g and -g in the same noise, measured as a user would: from
 * field files, by shear_run_file, each file a group of galaxies. What comes out is m and c, the
 * error of one galaxy, and whether anything was said.
 *
 * All levels of signal-to-noise and all ways of measuring share their galaxies and noise. Errors
 * are the jackknife's over the groups, or those of independent fields (trial_sums.h). m is that
 * along the shear: (g(+) - g(-)) . g / (2 |g|^2) - 1.
 */
#ifndef VALIDATION_TRIAL_H
#define VALIDATION_TRIAL_H

#include "engine/cache.h"
#include "engine/flaw.h"
#include "shear/settings.h"

enum { TRIAL_MAX_LEVELS = 8, TRIAL_MAX_WAYS = 16 };

/* sqrt(sum of squares of the noise-free, unsheared image) over the noise of a pixel (of the sky
 * alone, where photons are counted), as in GREAT3: of all galaxies, or of the faintest, where
 * fluxes have a power law, dn/dF ~ F^-slope, up to `range` times the least. */
typedef struct trial_level {
    double snr, range;
    double slope; /* 0 = 2.5 */
} trial_level;

typedef struct trial {
    const flaw *flaw;
    uint64_t seed;
    int64_t stamps; /* at each sign of the shear */
    int groups, threads;
    int copies; /* of a galaxy: 4, or 1 for galaxies at random angles */
    double g[2];
    int n_levels;
    trial_level levels[TRIAL_MAX_LEVELS];
    int n_ways;
    shear_settings ways[TRIAL_MAX_WAYS];
} trial;

/* From the quietest on; a refusal is told before anything is measured. */
enum trial_told { TOLD_NOTHING, TOLD_WARNED, TOLD_FLAGGED, TOLD_NO_SHEAR, TOLD_REFUSED };

/* Doubles only, for the cache. */
typedef struct trial_outcome {
    double m, m_err;
    double m_of[2], m_of_err[2], c[2], c_err[2]; /* by component */
    double error, error_err; /* of one galaxy and component: jackknife's, times sqrt(stamps) */
    double quoted;           /* the same as the library has it */
    double level, level_err; /* of the noise under the galaxies, at +g; NaN: not known */
    double used, flagged;    /* stamps, of both signs */
    double spoilt;           /* of them with an artefact */
    double told;             /* enum trial_told */
    double code;             /* of the refusal: enum shear_code */
    double edge;             /* 1: `filter edge` was advised */
} trial_outcome;
enum { TRIAL_VALUES = sizeof(trial_outcome) / sizeof(double) };

/* In words: "refused (psf)", ... Returns buf. */
char *trial_told_text(const trial_outcome *o, char *buf, size_t size);

/* A trial with what the options say of it: seed, galaxies, groups, threads and shear; of galaxies
 * in `copies` without a flaw, levels and ways to be filled in. */
trial trial_of_options(const options *o, int copies);

/* Run it, through the cache, as a task of this name: [n_levels][n_ways], for free(). A file that
 * the library refuses is no error: told is TOLD_REFUSED. */
trial_outcome *trial_run(const trial *t, cache *c, const char *name);

/* Options of the mocks and settings that trials do not use: all but seed and shear. */
extern const char trial_fixed[];

#endif
