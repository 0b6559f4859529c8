/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/estimate_cache.h: the results that were solved last, by field and settings. One
 * takes less than 1 KiB. The least recently requested are forgotten first. */
#ifndef SHEARD_SERVICE_ESTIMATE_CACHE_H
#define SHEARD_SERVICE_ESTIMATE_CACHE_H

#include "shear/sums.h"
#include "store/store.h"

#include <sys/queue.h>

enum estimate_state { ESTIMATE_IDLE, ESTIMATE_QUEUED, ESTIMATE_SOLVING };

/* What is known of a field with its settings. */
typedef struct estimate {
    char *name, *digest;
    TAILQ_ENTRY(estimate) age;   /* from the least recently requested */
    int64_t requested;           /* the number of the last request for it */
    TAILQ_ENTRY(estimate) queue; /* where it is QUEUED */
    enum estimate_state state;
    enum shear_estimator estimator;
    size_t pending;   /* requests that wait for it */
    bool for_notices; /* the change notifier waits for it, too */
    /* Of the solving that made what follows, from 1; 0: there was none. */
    int64_t number;
    int64_t jobs;   /* that were counted: contributions come, and never go ... */
    int64_t losses; /* ... but with one of these */
    int code;       /* not SHEAR_OK: why there is no result */
    shear_result result;
} estimate;

typedef TAILQ_HEAD(estimate_list, estimate) estimate_list;

typedef struct estimate_cache {
    void *tree; /* tsearch: of all, by name and digest */
    size_t n;
    estimate_list by_age;
    int64_t requests;
} estimate_cache;

void estimate_cache_init(estimate_cache *c);
void estimate_cache_deinit(estimate_cache *c);
estimate *estimate_cache_find(const estimate_cache *c, const store_field *f); /* or NULL */
/* The record of a field that is requested now, made where there is none. NULL: out of memory. */
estimate *estimate_cache_request(estimate_cache *c, const store_field *f);
/* Forget the oldest, but those that were requested after `needed`, and those that are not IDLE. */
void estimate_cache_shrink(estimate_cache *c, int64_t needed);

#endif
