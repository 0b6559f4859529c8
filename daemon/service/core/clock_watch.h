/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/clock_watch.h: detect that the wall clock was set, and move waiting jobs with it.
 * Times that are shown or stored are the wall clock's; intervals are measured by the steady
 * clock. */
#pragma once

#include "service/core/group.h"
#include "sheard/config.h"

typedef struct clock_watch {
    group *group;
    const sheard_config *config;
    int64_t offset_ms;      /* wall clock minus steady clock, when last checked */
    int64_t aged_offset_ms; /* the same, for ages: follows a clock set forward only after a day */
    int64_t jumped_ms;      /* steady clock: when the wall clock was last set */
    int64_t owed_ms;        /* by which waiting jobs are still to be moved */
} clock_watch;

/* Initialize, and shorten the waits in the store to the longest that `config` allows: the clock may
 * have been set while the service did not run. Errors of store_set_clock. */
int clock_watch_start(clock_watch *w, group *g, const sheard_config *config, shear_error *err);
/* Check whether the wall clock was set; if so, move the waiting jobs by as much. Call before jobs
 * are looked for, and once a second. */
void clock_watch_look(clock_watch *w);
/* Return the wall clock for removing things because of their age: never ahead of the present wall
 * clock. A clock that was set forward is trusted after a day. */
int64_t clock_watch_for_ages(const clock_watch *w);
