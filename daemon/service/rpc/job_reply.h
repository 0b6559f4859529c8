/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/job_reply.h: reply to a request that changes a job with that job, once the change is
 * on disk. */
#pragma once

#include "server/server.h"
#include "service/core/group.h"

typedef struct service service;

typedef struct job_reply {
    post_commit post; /* first */
    server_handle to;
    bool submit; /* the method is submit; else one whose reply is the job alone */
    bool known;  /* of submit: the idempotency key had been used before */
} job_reply;

/* Register `run` for after the commit. Return a zeroed record of `size` bytes that begins with a
 * job_reply, or NULL if out of memory: the error reply has then been sent. */
void *job_reply_later(service *s, post_commit_run *run, size_t size, server_handle to, int64_t job);
/* Reply with the job as it is now, and notify others. */
post_commit_run job_reply_run;
/* Return true if the peer owns the job or is an administrator. Otherwise the error reply has been
 * sent. */
bool job_reply_may_change(service *s, const server_request *r, int64_t id);
