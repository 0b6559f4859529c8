/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/job_reply.h: changes of a job are answered with the job, when the change is on disk.
 */
#ifndef SHEARD_SERVICE_JOB_REPLY_H
#define SHEARD_SERVICE_JOB_REPLY_H

#include "server/server.h"
#include "service/core/group.h"

typedef struct service service;

typedef struct job_reply {
    post_commit post; /* first */
    server_handle to;
    bool submit; /* the method; else one whose reply is the job alone */
    bool known;  /* of submit: the key had been seen */
} job_reply;

/* Register `run` for the commit, with a record of `size` bytes that begins with a job_reply. NULL:
 * out of memory, and the request has been answered so. */
void *job_reply_later(service *s, post_commit_run *run, size_t size, server_handle to, int64_t job);
/* Reply with the job as it is now, and tell others of it. */
post_commit_run job_reply_run;
/* Owners and administrators only. Where not, the reply has been given. */
bool job_reply_may_change(service *s, const server_request *r, int64_t id);

#endif
