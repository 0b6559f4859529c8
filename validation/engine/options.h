/* SPDX-License-Identifier: GPL-3.0-or-later */
/* request.h: what a command line asks of an experiment.
 *
 * Options are, in this order of precedence: the common ones (--galaxies, --seed, --threads, ...),
 * the experiment's knobs, the options of the mocks (as in `shearctl help mock`) and the settings of
 * the measurement (as in `shearctl help measure`). A setting that has the name of a mock option is
 * --measure-NAME.
 */
#ifndef VALIDATION_REQUEST_H
#define VALIDATION_REQUEST_H

#include "shear/settings.h"
#include "shear_mocks/mock.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { MAX_KNOBS = 12, MAX_KNOB_VALUES = 32 };

/* A number, or a list of them, that an experiment can be told. */
struct knob {
    const char *name;   /* as in --name */
    const char *preset; /* the default, as text */
    double min, max;    /* inclusive, of each value */
    bool many;          /* a list, separated by commas */
    const char *help;   /* one line */
};

typedef struct knob_values {
    int n;
    double v[MAX_KNOB_VALUES];
} knob_values;

typedef struct experiment experiment;

struct request {
    const experiment *experiment;
    shear_mock_spec mock;    /* seed, shear and all; n_stamps is not used */
    shear_settings settings; /* of the measurement */
    int64_t galaxies;        /* stamps for each point; rotated copies count */
    int groups;              /* of the jackknife, and pieces of work between two checkpoints */
    int threads;             /* 0 = all cores */
    char out[512];           /* folder of table, figure and state */
    bool fresh;              /* forget finished pieces */
    bool quiet;              /* no progress */
    char command[1024];      /* as it was typed */
    knob_values knobs[MAX_KNOBS];
};

/* Parse the options; argv[0] is the experiment's name. SHEAR_E_SETTING with a message. */
int request_parse(struct request *r, const experiment *e, int argc, char **argv, shear_error *err);
/* The help text of one experiment. */
void request_help(const experiment *e, FILE *out);

/* The values of a knob; `name` is one of the experiment's. */
const knob_values *request_list(const struct request *r, const char *name);
double request_number(const struct request *r, const char *name);

/* Everything that the numbers depend on, as text: one "name value" a line. malloc'd; NULL without
 * memory. Threads, folder and verbosity are not in it. */
char *request_describe(const struct request *r);

/* OUT/NAME-suffix.ext, or OUT/NAME.ext where suffix is NULL. Returns buf. */
char *request_path(const struct request *r, const char *suffix, const char *ext, char *buf,
                   size_t size);

#endif
