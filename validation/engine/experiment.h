/* SPDX-License-Identifier: GPL-3.0-or-later */
/* experiment.h: what an experiment of shear-paper is, and how to add one.
 *
 * Each exp_NAME.c exports one const experiment; main.c holds the table. An experiment
 *
 *   1. states its defaults, the paper's where it has one (`defaults`), and its knobs;
 *   2. in `exec` opens the ledger (ledger.h), which remembers finished pieces of long runs;
 *   3. draws and measures galaxies through a sample (sample.h): groups of stamps, all threads, the
 *      same sums for any number of them; or through a task of its own (ledger_run);
 *   4. estimates what it wants, with errors and covariances, from the groups' sums (tally.h), and
 *      tests it (statistics.h);
 *   5. leaves a table (table.h) and a figure (shear_figures/figure.h, chart.h) in the folder --out
 *      under its own name (report_save).
 *
 * Lengths are in pixels unless a name says otherwise; R_PSF is the paper's nominal radius of eq.
 * (Ws), not the measured one, and beta-ratio is beta over that.
 */
#ifndef VALIDATION_EXPERIMENT_H
#define VALIDATION_EXPERIMENT_H

#include "engine/options.h"
#include "shear/error.h"

enum {
    EXIT_CODE_DONE = 0,
    EXIT_CODE_OTHER = 1,
    EXIT_CODE_USAGE = 2,
};

typedef struct experiment {
    const char *name;
    const char *summary;      /* one line, no full stop */
    const char *about;        /* a paragraph of help: what is drawn, measured and shown */
    const struct knob *knobs; /* ended by a NULL name; or NULL */
    /* Options of the mocks and settings of the measurement that the experiment chooses itself: to
     * give them is an error. Ended by NULL; or NULL. */
    const char *const *fixed;
    /* Put the defaults into r->mock, r->settings and r->galaxies, which hold the mocks' own and the
     * paper's (preset zhang2010). */
    void (*defaults)(struct request *r);
    int (*exec)(const struct request *r, shear_error *err);
} experiment;

extern const experiment exp_noise;
extern const experiment exp_images;
extern const experiment exp_single;
extern const experiment exp_pixels;
extern const experiment exp_overall;
extern const experiment exp_shot;
extern const experiment exp_bias;
extern const experiment exp_errors;
extern const experiment exp_efficiency;
extern const experiment exp_survey;
extern const experiment exp_precision;
extern const experiment exp_narrow;
extern const experiment exp_selection;

/* The table, ended by NULL, in the order of the paper. */
const experiment *const *experiment_table(void);

#endif
