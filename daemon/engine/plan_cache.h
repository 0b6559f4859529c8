/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/plan_cache.h: measurement plans, shared by jobs and kept for later ones.
 *
 * Files of one survey mostly have stamps of one shape, one set of settings and often one PSF: such
 * jobs share a plan (immutable, for any number of threads: shear/plan.h), and later jobs need not
 * make it again. Two jobs share a plan if their requests are equal to the last bit; the PSF itself
 * is compared, not a hash of it. The least recently used plans are freed first. Those in use are
 * never freed, so the limits apply to what is kept beyond its jobs.
 *
 * Thread-safe. */
#pragma once

#include "shear/plan.h"
#include "shear/run.h"

#include <stdint.h>

typedef struct plan_cache plan_cache;

/* Create a cache of at most `max_count` plans of `max_bytes` together; if either is 0, no plan is
 * kept. Return NULL if out of memory. */
plan_cache *plan_cache_new(int64_t max_count, int64_t max_bytes);
/* Free the cache; no plan may be in use. NULL is accepted. */
void plan_cache_free(plan_cache *p);

/* Change the limits. */
void plan_cache_limit(plan_cache *p, int64_t max_count, int64_t max_bytes);

/* Free idle plans, the least recently used first, until all plans take at most `bytes` or none is
 * idle. Return the bytes that they take then. */
int64_t plan_cache_shrink_to(plan_cache *p, int64_t bytes);

/* Return a plan for the request in *plan, kept or new. On an error (those of shear_plan_new) *plan
 * is NULL. The caller releases it with plan_cache_release, which accepts NULL. A new plan takes
 * part in the limits and statistics once it is counted or released: until then, its bytes are part
 * of its maker's reservation (engine/budget.h). */
int plan_cache_acquire(plan_cache *p, const shear_plan_request *request, const shear_plan **plan,
                       shear_error *err);
/* Count a plan that was acquired, unless it is already counted. */
void plan_cache_count(plan_cache *p, const shear_plan *plan);
/* Give back a plan that was acquired. It stays in the cache within its limits. NULL is accepted. */
void plan_cache_release(plan_cache *p, const shear_plan *plan);

typedef struct plan_cache_statistics {
    int64_t count, bytes; /* now, with counted plans in use; shear_plan_bytes and keys */
    int64_t hits, misses; /* since the start */
} plan_cache_statistics;
plan_cache_statistics plan_cache_get_statistics(plan_cache *p);
