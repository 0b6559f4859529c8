/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run/team.h: measure a whole field from any source with a team of OpenMP threads. */
#ifndef SHEAR_RUN_TEAM_H
#define SHEAR_RUN_TEAM_H

#include "shear/work.h"

typedef struct team_job {
    const shear_field_info *info;
    const shear_plan *plan;
    shear_source source; /* has a slot for every thread */
    shear_sink sink;
    shear_unit_size size;
    int threads;
    bool jackknife; /* keep the sums of all blocks */
    bool terms;     /* keep the stamps' terms, even where the estimator needs none */
    /* As in shear_run_options; may be NULL. */
    int (*progress)(void *context, int64_t done, int64_t total);
    void *context;
} team_job;

/* What comes of a field. */
typedef struct team_sums {
    shear_field_sums *sums;
    shear_symmetry *terms;      /* NULL where nobody wants terms */
    shear_jackknife *jackknife; /* NULL where nobody wants one */
} team_sums;

/* The number of threads that is asked for; all cores for 0. */
int team_threads(int asked);

/* Measure all stamps; *result is by the plan's estimator. Deinit the sums, also after an
 * error. */
int team_measure(const team_job *job, team_sums *out, shear_result *result, shear_error *err);
void team_sums_deinit(team_sums *sums);

#endif
