/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/clock_watch.h: was the wall clock set? What is told and stored is its time; what is
 * waited for is measured by a clock that nobody sets. */
#ifndef SHEARD_SERVICE_CLOCK_WATCH_H
#define SHEARD_SERVICE_CLOCK_WATCH_H

#include "service/core/group.h"
#include "sheard/config.h"

typedef struct clock_watch {
    group *group;
    const sheard_config *config;
    int64_t offset_ms;      /* from the steady clock to the wall clock at the last look */
    int64_t aged_offset_ms; /* the same, for ages: a clock set forward is not believed at once */
    int64_t jumped_ms;      /* steady: it was set last */
    int64_t owed_ms;        /* waiting jobs are still to be moved by this */
} clock_watch;

/* What waits on disk must not wait longer than this service would have let it: clocks may have been
 * set while it did not run. */
int clock_watch_start(clock_watch *w, group *g, const sheard_config *config, shear_error *err);
/* Was the clock set? Then waiting jobs move with it. Before jobs are looked for, and once a second.
 */
void clock_watch_look(clock_watch *w);
/* The wall clock for what is removed because of its age: never ahead of the present one; one that
 * was set forward is believed after a day. */
int64_t clock_watch_for_ages(const clock_watch *w);

#endif
