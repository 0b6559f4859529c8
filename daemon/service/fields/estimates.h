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
#include "shear/sums.h"
#include "store/store.h"

typedef struct service service;
typedef struct estimates estimates;

int estimates_new(estimates **all, shear_error *err);
void estimates_free(estimates *all);

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
