/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/estimates.h: results of fields whose estimator is a symmetric one. They are made
 * of the terms of all their stamps, so they are solved when somebody asks, one after the other, on
 * a thread of libuv's pool: the loop only reads the terms. Requests wait for theirs. Results are
 * kept until another job is counted: those that a pending request needs, and else of the fields
 * that were requested last. Solving takes 76 bytes per stamp for its time.
 *
 * Of a field that changes faster than it is solved nobody would ever see a result. So whoever began
 * to wait when n solvings had begun (estimates_begun) takes the result of any later one: `since` is
 * that number, or INT64_MAX: the newest only. */
#ifndef SHEARD_SERVICE_ESTIMATES_H
#define SHEARD_SERVICE_ESTIMATES_H

#include "server/server.h"
#include "service/fields/estimate_cache.h"

typedef struct service service;

/* A request that has asked for fields, until it is forgotten. */
typedef struct pending_request {
    TAILQ_ENTRY(pending_request) link;
    server_handle to;
    int64_t first;        /* the cache's requests before its own: what follows is kept for it */
    size_t left;          /* of those it waits for, not solved yet */
    estimate **waits_for; /* [n] NULL: solved */
    size_t n;
} pending_request;

/* The solving that is under way. */
typedef struct solving {
    uv_work_t work;
    service *s;
    estimate *what; /* NULL: none is */
    enum shear_estimator estimator;
    shear_field_sums *sums;
    shear_symmetry *terms;
    int code;
    shear_result result;
    int64_t jobs, losses;
} solving;

typedef struct estimates {
    estimate_cache cache;
    estimate_list queue;
    int64_t begun; /* solvings */
    solving solving;
    TAILQ_HEAD(, pending_request) pending; /* the oldest first */
    int64_t retractions;                   /* since the start */
} estimates;

void estimates_init(estimates *all);
void estimates_deinit(estimates *all);

int64_t estimates_begun(const service *s);

enum estimates_answer { ESTIMATES_READY, ESTIMATES_PENDING, ESTIMATES_NO_MEMORY };
/* Are the results of these fields at hand (of those with this digest; NULL: all)? PENDING: the
 * request's work is to pause; it is woken when they are solved, and asks again. They are kept, or
 * solved, for it until estimates_forget. */
enum estimates_answer estimates_request(service *s, server_handle to, const store_field_page *page,
                                        const char *digest, int64_t since);
/* The request asks for nothing any more. */
void estimates_forget(service *s, server_handle to);
/* Is the result of this field at hand? For the change notifier, which asks again later. */
bool estimates_at_hand(service *s, const store_field *f, int64_t since);
/* Then, where its estimator is symmetric: the result, and how many jobs are in it. `sums`: of what
 * was counted. */
int estimates_get(service *s, const store_field *f, const shear_field_sums *sums, int64_t since,
                  shear_result *out, int64_t *jobs, shear_error *err);
/* Contributions were taken back: results with as many jobs may be others. */
void estimates_note_retraction(service *s);

#endif
