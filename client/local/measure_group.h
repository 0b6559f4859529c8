/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure_group.h: measure the files of one field into one result. */
#pragma once

#include "cmdline/part_options.h"
#include "local/measure_input.h"
#include "local/warnings.h"
#include "shear/sums.h"
#include "sheard/report.h"

/* The options of `shearctl measure`. */
typedef struct measure_options {
    option_settings settings;
    int64_t threads;     /* 0: all cores */
    int64_t jackknife;   /* groups; 0: delta method */
    const char *catalog; /* NULL: none is written */
    const char *field;   /* NULL: the files' own */
    part_options parts;
    bool force, json, quiet;
} measure_options;

typedef struct measure_group {
    const char *field;
    measure_input *
        *inputs; /* [n], in the order of the arguments; not owned. Files that fail are marked */
    size_t n, capacity;
    shear_result result;
    sheard_report_estimators estimators; /* for the same stamps; errors without jackknife */
    sheard_report_file *files;           /* [n_measured], those in the result; owned */
    size_t n_measured;
    double seconds; /* wall clock, for all files */
    warning_list warnings;
} measure_group;

/* Group the wanted inputs by field, in the order of first appearance. Sets *groups (malloc'd,
 * [*n_groups]), to be freed by measure_groups_free. Returns false if out of memory. */
bool measure_groups_new(measure_input *inputs, size_t n, measure_group **groups, size_t *n_groups);
void measure_groups_free(measure_group *groups, size_t n_groups);

/* Measure the group. Errors are printed, and the inputs that they concern are marked. Returns true
 * if there is a result.
 *
 * The sums of several files are added exactly, so the result does not depend on their order. The
 * jackknife's groups do: for a jackknife the files are taken in the order of their checksums, not
 * of the arguments. */
bool measure_group_run(measure_group *group, const measure_options *options);

/* Return the first measured file, or NULL. */
const measure_input *measure_group_first(const measure_group *group);
/* Return the file with the most influential stamp, or NULL if it is unknown. */
const measure_input *measure_group_top(const measure_group *group);
/* Return whether all measured files have the same true shear, and store it in *g1, *g2. */
bool measure_group_truth(const measure_group *group, double *g1, double *g2);
