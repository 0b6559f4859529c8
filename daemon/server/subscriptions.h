/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a connection has subscribed to. */
#ifndef SERVER_WATCHED_H
#define SERVER_WATCHED_H

#include "sheard/rpc.h"

typedef struct watched {
    int64_t *jobs; /* [n_jobs] ascending */
    size_t n_jobs;
    char **fields; /* [n_fields] ascending */
    size_t n_fields;
    bool all, progress;
} watched;

void watched_deinit(watched *w); /* zeroed: fine */
/* All of it or, on an error, nothing. `limit`: jobs and fields together. */
int watched_add(watched *w, const sheard_msg_subscribe *what, size_t limit,
                sheard_rpc_error *error);
/* Nothing named: everything. */
void watched_remove(watched *w, const sheard_msg_subscribe *what);
/* Was it watched by its number? It is not any more. */
bool watched_end_job(watched *w, int64_t job);
bool watched_anything(const watched *w);
bool watched_matches(const watched *w, int notice, int64_t job, const char *field);

#endif
