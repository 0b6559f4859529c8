/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/rounds.h: timing of a case in rounds, each of which times everything once. A temporary
 * slowdown of the machine affects the whole round, so the medians of ratios are robust. */
#pragma once

#include "stages.h"

enum { ROUNDS_MAX = 1001 };

/* Medians. */
typedef struct timing {
    double pair_us, floor_us, ratio;
    double speedup; /* of `threads` threads over one, if each has a processor of its own */
    double stage_us[N_STAGES];
} timing;

/* Time a case. Returns 0, or a code whose message is in *err. */
int rounds_time_case(const bench_case *c, int rounds, int threads, timing *out, shear_error *err);
