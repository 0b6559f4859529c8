/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/memory.h: the memory of plans and workspaces, computed without making them.
 *
 * A unit test compares the numbers with what malloc hands out, so that they agree with the *_init
 * functions. */
#pragma once

#include "shear/plan.h"

#include <stdbool.h>

/* The numbers that decide the sizes. */
typedef struct memory_of {
    const shear_settings *settings;
    const shear_plan_info *info; /* resolved */
    bool has_psf;                /* one transfer for all stamps */
} memory_of;

int64_t memory_of_plan(const memory_of *m);
/* Bytes needed while the plan is made, in addition to the plan's own. */
int64_t memory_of_planning(const memory_of *m);
/* Return the last row of modes that any transfer may use. */
int memory_last_row(const shear_plan_info *info);
/* Bytes of one workspace that keeps rows of modes 0 .. last_jy. */
int64_t memory_of_workspace(const memory_of *m, int last_jy);
