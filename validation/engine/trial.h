/* SPDX-License-Identifier: GPL-3.0-or-later */
/* trial.h: galaxies with a flaw, at +g and -g with the same noise, measured as a user would: from
 * field files by shear_run_file, one file per group of galaxies. The results are m and c, the error
 * of one galaxy, and whether a problem was reported.
 *
 * All levels of signal-to-noise and all ways of measuring use the same galaxies and noise. Errors
 * are from the jackknife over the groups, or from independent fields (trial_sums.h). m is along the
 * shear: (g(+) - g(-)) . g / (2 |g|^2) - 1. */
#pragma once

#include "engine/cache.h"
#include "engine/flaw.h"
#include "shear/settings.h"

enum { TRIAL_MAX_LEVELS = 8, TRIAL_MAX_WAYS = 16 };

/* Signal-to-noise: sqrt(sum of squares of the noise-free, unsheared image) over the noise of a
 * pixel (with photon counting: of the sky alone), as in GREAT3. It is that of all galaxies, or of
 * the faintest if fluxes have a power law dn/dF ~ F^-slope, up to `range` times the smallest. */
typedef struct trial_level {
    double snr, range;
    double slope; /* 0: 2.5 */
} trial_level;

typedef struct trial {
    const flaw *flaw;
    uint64_t seed;
    int64_t stamps; /* per sign of the shear */
    int groups, threads;
    int copies; /* per galaxy: 4, or 1 for galaxies at random angles */
    double g[2];
    int n_levels;
    trial_level levels[TRIAL_MAX_LEVELS];
    int n_ways;
    shear_settings ways[TRIAL_MAX_WAYS];
} trial;

/* What was reported, in order of severity; a refusal comes before any measurement. */
enum trial_told { TOLD_NOTHING, TOLD_WARNED, TOLD_FLAGGED, TOLD_NO_SHEAR, TOLD_REFUSED };

/* The results, only doubles, for the result cache. */
typedef struct trial_outcome {
    double m, m_err;
    double m_of[2], m_of_err[2], c[2], c_err[2]; /* by component */
    double error,
        error_err; /* of one galaxy and component: from the jackknife, times sqrt(stamps) */
    double quoted; /* the same, as libshear reports it */
    double level, level_err; /* of the noise in galaxy stamps, at +g; NaN: unknown */
    double used, flagged;    /* stamps of both signs */
    double spoilt;           /* of them, with an artefact */
    double told;             /* enum trial_told */
    double code;             /* of the refusal: enum shear_code */
    double edge;             /* 1: `filter edge` was advised */
} trial_outcome;
enum { TRIAL_VALUES = sizeof(trial_outcome) / sizeof(double) };

/* Write "refused (psf)" or the like into buf. Returns buf. */
char *trial_told_text(const trial_outcome *o, char *buf, size_t size);

/* Return a trial from the options (seed, galaxies, groups, threads, shear), with `copies` per
 * galaxy and no flaw. The caller sets levels and ways. */
trial trial_of_options(const options *o, int copies);

/* Return the first stamp of a group; rotated copies stay together. */
int64_t trial_begin(const trial *t, int group);

/* Run the trial through the cache, as a task of this name. Returns the outcomes [n_levels][n_ways],
 * to be freed by the caller. A file that the library refuses is not an error: `told` is
 * TOLD_REFUSED. */
trial_outcome *trial_run(const trial *t, cache *c, const char *name);

/* Options of the mocks and settings that trials do not use: all except seed and shear. */
extern const char trial_fixed[];
