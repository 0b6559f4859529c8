/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/estimate_cache.h: a cache of solved results, by field and settings, that forgets
 * the least recently requested ones first. An entry takes less than 1 KiB. */
#pragma once

#include "shear/sums.h"
#include "store/store.h"

#include <sys/queue.h>

enum estimate_state { ESTIMATE_IDLE, ESTIMATE_QUEUED, ESTIMATE_SOLVING };

typedef struct solution {
    int64_t jobs;   /* jobs counted when it was loaded. Contributions are only added ... */
    int64_t losses; /* ... except by one of these losses, of which there were so many */
    int code;       /* not SHEAR_OK: why there is no result */
    shear_result result;
} solution;

/* The result of a field with its settings. */
typedef struct estimate {
    char *name, *digest;
    TAILQ_ENTRY(estimate) age;   /* list by_age, the least recently requested first */
    int64_t requested;           /* the number of the last request for it */
    TAILQ_ENTRY(estimate) queue; /* estimates' queue, if QUEUED */
    enum estimate_state state;
    enum shear_estimator estimator;
    size_t pending;   /* requests that wait for it */
    bool for_notices; /* the change notifier waits for it, too */
    int64_t number;   /* of the solving that made the solution, from 1; 0: there was none */
    solution solution;
} estimate;

typedef TAILQ_HEAD(estimate_list, estimate) estimate_list;

typedef struct estimate_cache {
    void *tree; /* tsearch tree of all entries, by name and digest */
    size_t n;
    estimate_list by_age;
    int64_t requests;
} estimate_cache;

void estimate_cache_init(estimate_cache *c);
void estimate_cache_deinit(estimate_cache *c);
estimate *estimate_cache_find(const estimate_cache *c, const store_field *f); /* NULL: not found */
/* Return the field's entry, made if it is missing, as the most recently requested one. NULL: out of
 * memory. */
estimate *estimate_cache_request(estimate_cache *c, const store_field *f);
/* Remove the oldest entries above the cache's capacity, up to the first that is not IDLE or was
 * requested after request number `needed`. */
void estimate_cache_shrink(estimate_cache *c, int64_t needed);
