/* SPDX-License-Identifier: GPL-3.0-or-later */
/* experiment.h: what an experiment of shear-paper is, and how to add one.
 *
 * Each file of experiments/ exports one const experiment; experiments/list.h names them all. An
 * experiment
 *
 *   1. states its defaults, the paper's where it has one (`defaults`), and its parameters;
 *   2. in `run` draws and measures galaxies through a sample (sample.h): groups of stamps, all
 *      threads, the same sums for any number of them; or through a task of its own (cache_run). The
 *      result cache (cache.h) remembers finished pieces of long runs;
 *   3. estimates what it wants, with errors and covariances, from the groups' sums (jackknife.h),
 *      and tests it (statistics.h);
 *   4. fills the run's table (report/table.h) and draws its figures (report/run.h, report/chart.h).
 *
 * main.c opens the cache before and saves table and figures afterwards, in the folder --out under
 * the experiment's name.
 *
 * Lengths are in pixels unless a name says otherwise; R_PSF is the nominal radius of Zhang (2010),
 * eq. (9), not the measured one, and beta-ratio is beta over that.
 */
#ifndef VALIDATION_EXPERIMENT_H
#define VALIDATION_EXPERIMENT_H

#include <stdbool.h>
#include <stdint.h>

struct options;
struct run;

/* A number, or a list of them, that an experiment can be told. */
typedef struct parameter {
    const char *name;   /* as in --name */
    const char *preset; /* the default, as text */
    double min, max;    /* inclusive, of each value */
    bool many;          /* a list, separated by commas */
    const char *help;   /* one line */
} parameter;

typedef struct experiment {
    const char *name;
    const char *summary;         /* one line, no full stop */
    const char *about;           /* a paragraph of help: what is drawn, measured and shown */
    const parameter *parameters; /* ended by a NULL name; or NULL */
    /* Of its options, "name=value name=value", where they are not the mocks' own and the paper's
     * (preset zhang2010). */
    const char *defaults;
    /* Options of the mocks and settings of the measurement that the experiment chooses itself, with
     * blanks between: to give them is an error. */
    const char *fixed;
    /* How many stamps will be drawn, for the progress line. Ends the program where parameters do
     * not go together. */
    int64_t (*stamps)(const struct options *o);
    void (*run)(struct run *r);
} experiment;

#endif
