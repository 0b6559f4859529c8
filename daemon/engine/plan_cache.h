/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/plan_cache.h: plans that outlive their jobs. Files of one survey mostly have stamps of one
 * shape, one set of settings and often one PSF: such jobs share a plan (shear/plan.h: immutable,
 * any number of threads), and the next one need not make it again.
 *
 * Two jobs share a plan where their requests (shear/plan.h) are equal to
 * the last bit; the PSF is compared pixel by pixel, no hash stands for it. The plans that were used
 * longest ago are given up first; those in use are never, so that the bounds hold for what is kept
 * beyond its jobs. Thread-safe. */
#ifndef SHEARD_ENGINE_PLANS_H
#define SHEARD_ENGINE_PLANS_H

#include "shear/plan.h"
#include "shear/run.h"

#include <stdint.h>

typedef struct plan_cache plan_cache;

/* At most `max_count` plans of `max_bytes` together; 0 in either: none is kept. NULL: out of
 * memory. */
plan_cache *plan_cache_new(int64_t max_count, int64_t max_bytes);
/* No plan may be in use. NULL is accepted. */
void plan_cache_free(plan_cache *p);

/* Other bounds, from now on. */
void plan_cache_limit(plan_cache *p, int64_t max_count, int64_t max_bytes);

/* Give up idle plans, the longest unused first, until all take at most `bytes`, or no idle one
 * is left. Returns what they take then. */
int64_t plan_cache_shrink_to(plan_cache *p, int64_t bytes);

/* The plan for these, kept or new. *plan is NULL on an error: those of shear_plan_new. To be given
 * back by plan_cache_release, which NULL is accepted by. */
int plan_cache_acquire(plan_cache *p, const shear_plan_request *request, const shear_plan **plan,
                       shear_error *err);
void plan_cache_release(plan_cache *p, const shear_plan *plan);

typedef struct plan_cache_statistics {
    int64_t count, bytes; /* now, with those in use; bytes as of shear_plan_bytes */
    int64_t hits, misses; /* since the start */
} plan_cache_statistics;
plan_cache_statistics plan_cache_get_statistics(plan_cache *p);

#endif
