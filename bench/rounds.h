/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/rounds.h: a case timed in rounds, each of which times everything once: what slows the
 * machine for a while slows all of it, and the medians of ratios do not see it. */
#ifndef BENCH_ROUNDS_H
#define BENCH_ROUNDS_H

#include "stages.h"

enum { ROUNDS_MAX = 1001 };

/* Medians. */
typedef struct timing {
    double pair_us, floor_us, ratio;
    double speedup; /* of `threads` threads over one, each with a processor of its own */
    double stage_us[N_STAGES];
} timing;

/* 0, or a code whose message is in *err. */
int rounds_time_case(const bench_case *c, int rounds, int threads, timing *out, shear_error *err);

#endif
