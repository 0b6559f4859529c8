/* SPDX-License-Identifier: GPL-3.0-or-later */
/* experiment.h: the definition of an experiment of shear-paper, and how to add one.
 *
 * Each file of experiments/ exports one const experiment; experiments/list.h declares them all. An
 * experiment
 *
 *   1. defines its parameters and defaults, those of the paper if there are any;
 *   2. in `run`, draws and measures galaxies through a sample (sample.h: groups of stamps, all
 *      threads, sums that do not depend on their number), or through a task of its own (cache_run).
 *      The result cache (cache.h) stores finished chunks of long runs;
 *   3. computes its estimates, with errors and covariances, from the groups' sums (jackknife.h),
 *      and tests them (statistics.h);
 *   4. fills the run's table (report/table.h) and draws its figures (report/run.h, report/chart.h).
 *
 * main.c opens the cache before `run`, and saves table and figures after it, in the directory --out
 * under the experiment's name.
 *
 * Lengths are in pixels unless a name says otherwise. R_PSF is the nominal radius in eq. (9) of
 * Zhang (2010), not the measured one, and beta-ratio is beta over it.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct options;
struct run;

/* An option of an experiment with a number, or a list of numbers. */
typedef struct parameter {
    const char *name;   /* as in --name */
    const char *preset; /* the default, as text */
    double min, max;    /* inclusive, for each value */
    int most;           /* values, separated by commas; 1: a number */
    const char *help;   /* one line */
} parameter;

typedef struct experiment {
    const char *name;
    const char *summary;         /* one line, no full stop */
    const char *about;           /* a paragraph of help: what is drawn, measured and plotted */
    const parameter *parameters; /* ended by a NULL name; or NULL: none */
    /* Defaults of options, "name=value name=value", if they differ from the mocks' and the paper's
     * (preset zhang2010). */
    const char *defaults;
    /* Options of the mocks and settings of the measurement that the experiment sets itself,
     * separated by spaces; the user may not give them. */
    const char *fixed;
    /* Return how many stamps will be drawn, for the progress line. Ends the program if parameters
     * contradict each other. NULL: as many as --galaxies says. */
    int64_t (*stamps)(const struct options *o);
    void (*run)(struct run *r);
} experiment;
