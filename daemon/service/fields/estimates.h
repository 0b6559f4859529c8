/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/estimates.h: results of fields whose estimator is a symmetric one. They are made
 * of the terms of all stamps of the field, so they are solved only on request, one after the other,
 * in libuv's thread pool; the loop only reads the terms. Requests wait for their results. Results
 * are kept until another job is counted: those that a pending request needs, and those of the most
 * recently requested fields. Solving needs 85 bytes of memory per stamp.
 *
 * A field that changes faster than it is solved would never have a current result. So a request
 * that began when n solvings had begun accepts the result of any later one:
 * `since` is n, or INT64_MAX for a current result only. */
#pragma once

#include "server/server.h"
#include "service/fields/estimate_cache.h"

typedef struct service service;

/* A request that asks for fields, in the memory of its work; zeroed at first. */
typedef struct pending_request {
    TAILQ_ENTRY(pending_request) link;
    server_handle to; /* set by the caller */
    bool listed;      /* it has asked, and has not been forgotten */
    int64_t first;    /* the cache's request number before its own: later ones are kept for it */
    size_t left;      /* number of results that it still waits for */
    estimate **waits_for; /* [n], owned; NULL: solved */
    size_t n;
} pending_request;

/* The solving that is under way; the pool's thread owns it meanwhile. */
typedef struct solving {
    uv_work_t work;
    service *s;
    estimate *what; /* NULL: none is under way */
    enum shear_estimator estimator;
    shear_field_sums *sums;
    shear_symmetry *terms;
    solution found;
} solving;

typedef struct estimates {
    estimate_cache cache;
    estimate_list queue;
    int64_t begun; /* number of solvings begun */
    solving solving;
    TAILQ_HEAD(, pending_request) pending; /* oldest first */
    int64_t retractions;                   /* number since the start */
} estimates;

void estimates_init(estimates *all);
void estimates_deinit(estimates *all);

enum { ESTIMATES_PENDING = -1 };
/* Return SHEARD_RPC_OK if the results of these fields are available (`digest` NULL: of all of them;
 * else of those with this digest), or ESTIMATES_PENDING: pause the request's work, which is woken
 * when they are solved and then calls this again; or the code of *error (out of memory). The
 * results are kept for the request until estimates_forget. */
int estimates_request(service *s, pending_request *r, const store_field_page *page,
                      const char *digest, int64_t since, sheard_rpc_error *error);
/* Forget the request, and drop what is queued for it alone. */
void estimates_forget(service *s, pending_request *r);
/* Return true if the result of this field is available. Otherwise it is queued, and the change
 * notifier tries again later. */
bool estimates_at_hand(service *s, const store_field *f, int64_t since);
/* Get the result of a field whose estimator is symmetric, and the number of jobs in it, after it
 * has become available. Otherwise the result is not valid, and *jobs is unchanged. `sums` are those
 * of what was counted. */
int estimates_get(service *s, const store_field *f, const shear_field_sums *sums, int64_t since,
                  shear_result *out, int64_t *jobs, shear_error *err);
/* Contributions were taken back: cached results with the same number of jobs may be outdated. */
void estimates_note_retraction(service *s);
