/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options.h: the command line options of an experiment.
 *
 * Options are, in this order of precedence: the experiment's parameters, the common ones
 * (--galaxies, --groups, --threads, ...), the options of the mocks (as in `shearctl help mock`) and
 * the settings of the measurement (as in `shearctl help measure`). A setting with the name of a
 * mock option is --measure-NAME. */
#pragma once

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
    shear_mock_spec mock;    /* includes seed and shear; n_stamps is not used */
    shear_settings settings; /* of the measurement */
    int64_t galaxies;        /* stamps per point, including rotated copies */
    int groups;              /* of the jackknife, which are also the chunks of the result cache */
    int threads;             /* 0: all cores */
    char out[512];           /* directory of table, figure and cache */
    bool fresh;              /* discard finished chunks */
    bool quiet;              /* no progress line */
    char command[1024];      /* as typed, without options that the numbers do not depend on */
    parameter_values parameters[MAX_PARAMETERS];
} options;

/* Parse the command line; argv[0] is the experiment's name. Ends the program if an option is wrong.
 */
void options_parse(options *o, const experiment *e, int argc, char **argv);
/* Print the help of one experiment. */
void options_help(const experiment *e, FILE *out);

/* Return the values of the experiment's parameter `name`. */
const parameter_values *options_list(const options *o, const char *name);
double options_number(const options *o, const char *name);

/* Return everything that the numbers depend on as text, one "name value" per line, to be freed by
 * the caller. It does not contain threads, directory and verbosity. */
char *options_describe(const options *o);

/* Write OUT/NAME-suffix.ext, or OUT/NAME.ext if suffix is NULL, into path. Returns path. */
char *options_path(const options *o, const char *suffix, const char *ext, char path[OPTIONS_PATH]);
