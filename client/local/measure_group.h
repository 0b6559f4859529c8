/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure_group.h: the files of one field, measured into one result. */
#ifndef CLIENT_LOCAL_MEASURE_GROUP_H
#define CLIENT_LOCAL_MEASURE_GROUP_H

#include "cmdline/part_options.h"
#include "local/measure_input.h"
#include "local/warnings.h"
#include "shear/sums.h"
#include "sheard/report.h"

/* What the command line asks for. */
typedef struct measure_options {
    option_settings settings;
    int64_t threads;     /* 0: all cores */
    int64_t jackknife;   /* groups; 0: delta method */
    const char *catalog; /* or NULL */
    const char *field;   /* or NULL */
    part_options parts;
    bool force, json, quiet;
} measure_options;

typedef struct measure_group {
    const char *field;
    measure_input **inputs; /* [n], in the order given; not owned. Those that fail are marked */
    size_t n, capacity;
    shear_result result;
    sheard_report_estimators estimators; /* of the same stamps; errors without jackknife */
    double seconds;                      /* wall clock, all files */
    warning_list warnings;
} measure_group;

/* Group the wanted inputs by field, in the order of first appearance. *groups is malloc'd,
 * [*n_groups], for measure_groups_free. False when memory is out. */
bool measure_groups_new(measure_input *inputs, size_t n, measure_group **groups, size_t *n_groups);
void measure_groups_free(measure_group *groups, size_t n_groups);

/* Measure. Errors are printed, and the inputs that they concern are marked. Returns true where
 * there is a result.
 *
 * The sums of several files are joined exactly, so that the result does not depend on their order.
 * The jackknife's groups do depend on it: there the files are taken in the order of their
 * checksums, whatever the order of the arguments. */
bool measure_group_run(measure_group *group, const measure_options *options);

/* The first file that was measured, or NULL. */
const measure_input *measure_group_first(const measure_group *group);
/* The file of the stamp that counts most, or NULL if that is not known. */
const measure_input *measure_group_top(const measure_group *group);
/* The files that were measured, as a report has them: into files[group->n]; how many they are. */
size_t measure_group_files(const measure_group *group, sheard_report_file *files);
/* Do all measured files name the same truth? */
bool measure_group_truth(const measure_group *group, double *g1, double *g2);

#endif
