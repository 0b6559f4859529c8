/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/team.h: measure a whole field from any source with a team of OpenMP threads. */
#pragma once

#include "shear/work.h"

typedef struct team_job {
    shear_work_spec work; /* the source has a slot for every thread; without a jackknife */
    int threads;
    bool jackknife; /* keep the sums of all blocks */
    /* As in shear_run_options; may be NULL. */
    int (*progress)(void *context, int64_t done, int64_t total);
    void *context;
} team_job;

/* The sums of a field. Owned: see team_sums_deinit. */
typedef struct team_sums {
    shear_field_sums *sums;
    shear_symmetry *terms;      /* NULL if no terms are kept */
    shear_jackknife *jackknife; /* NULL if team_job.jackknife is false */
} team_sums;

/* Return `asked`, or the number of cores if it is 0. */
int team_threads(int asked);

/* Measure all stamps; *result is computed by the plan's estimator. Call team_sums_deinit after an
 * error, too. */
int team_measure(const team_job *job, team_sums *out, shear_result *result, shear_error *err);
void team_sums_deinit(team_sums *sums);
