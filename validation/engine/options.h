/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: what a command line asks of an experiment.
 *
 * Options are, in this order of precedence: the experiment's parameters, the common ones
 * (--galaxies, --groups, --threads, ...), the options of the mocks (as in `shearctl help mock`) and
 * the settings of the measurement (as in `shearctl help measure`). A setting that has the name of a
 * mock option is --measure-NAME.
 */
#ifndef VALIDATION_OPTIONS_H
#define VALIDATION_OPTIONS_H

#include "engine/experiment.h"
#include "shear/settings.h"
#include "shear_mocks/mock.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { MAX_PARAMETERS = 12, MAX_VALUES = 32, OPTIONS_PATH = 700 };

typedef struct parameter_values {
    int n;
    double v[MAX_VALUES];
} parameter_values;

typedef struct options {
    const experiment *experiment;
    shear_mock_spec mock;    /* seed, shear and all; n_stamps is not used */
    shear_settings settings; /* of the measurement */
    int64_t galaxies;        /* stamps for each point; rotated copies count */
    int groups;              /* of the jackknife, and pieces of work between two checkpoints */
    int threads;             /* 0 = all cores */
    char out[512];           /* folder of table, figure and cache */
    bool fresh;              /* forget finished pieces */
    bool quiet;              /* no progress */
    char command[1024];      /* as it was typed, without what the numbers do not depend on */
    parameter_values parameters[MAX_PARAMETERS];
} options;

/* argv[0] is the experiment's name. Ends the program where an option is wrong. */
void options_parse(options *o, const experiment *e, int argc, char **argv);
/* The help text of one experiment. */
void options_help(const experiment *e, FILE *out);

/* The values of a parameter; `name` is one of the experiment's. */
const parameter_values *options_list(const options *o, const char *name);
double options_number(const options *o, const char *name);

/* Everything that the numbers depend on, as text: one "name value" a line; for free(). Threads,
 * folder and verbosity are not in it. */
char *options_describe(const options *o);

/* OUT/NAME-suffix.ext, or OUT/NAME.ext where suffix is NULL. Returns path. */
char *options_path(const options *o, const char *suffix, const char *ext, char path[OPTIONS_PATH]);

#endif
