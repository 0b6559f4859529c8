/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/memory.h: what plans and workspaces take, from their numbers alone: nothing need be made
 * to know it. A test counts what malloc gives them, so that this and the *_init functions agree. */
#ifndef SHEAR_MEASURE_MEMORY_H
#define SHEAR_MEASURE_MEMORY_H

#include "shear/plan.h"

#include <stdbool.h>

/* The numbers. */
typedef struct memory_of {
    const shear_settings *settings;
    const shear_plan_info *info; /* resolved */
    bool has_psf;                /* one for all stamps */
} memory_of;

int64_t memory_of_plan(const memory_of *m);
/* While the plan is made: beside it. */
int64_t memory_of_planning(const memory_of *m);
/* The last row of modes that any transfer may let through. */
int memory_last_row(const shear_plan_info *info);
/* One workspace; rows of modes 0 .. last_jy are kept. */
int64_t memory_of_workspace(const memory_of *m, int last_jy);

#endif
