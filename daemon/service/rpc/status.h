/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/status.h: the state of the service, as the method status reports it. */
#pragma once

#include "server/server.h"
#include "service/rpc/problem_list.h"
#include "spool/spool.h"

typedef struct service service;

enum { STATUS_LEFT_LYING = 16 }; /* at most so many ignored files are listed */

/* A status message, with the texts and lists that it points to. */
typedef struct status {
    sheard_msg_status message;
    problem_list problems;
    server_statistics net;
    spool_ignored ignored[STATUS_LEFT_LYING];
    sheard_msg_ignored left_lying[STATUS_LEFT_LYING];
} status;

/* Make *out, to be released by free(); it may be incomplete, or NULL, after an error. Errors of the
 * store, SHEAR_E_NOMEM. */
int status_new(status **out, service *s, shear_error *err);

sheard_msg_limits status_limits(const service *s);
