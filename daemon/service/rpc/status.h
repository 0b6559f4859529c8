/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/status.h: what the service says of itself. */
#ifndef SHEARD_SERVICE_STATUS_H
#define SHEARD_SERVICE_STATUS_H

#include "service/rpc/problem_list.h"
#include "spool/spool.h"

typedef struct service service;

enum { STATUS_LEFT_LYING = 16 }; /* files that are told at most */

/* A status, and what its texts and lists are in. */
typedef struct status {
    sheard_msg_status message;
    problem_list *problems;
    char store_path[4200];
    spool_ignored ignored[STATUS_LEFT_LYING];
    sheard_msg_ignored left_lying[STATUS_LEFT_LYING];
} status;

/* Errors of the store. Deinit it either way. */
int status_init(status *st, service *s, shear_error *err);
void status_deinit(status *st);

sheard_msg_limits status_limits(const service *s);

#endif
