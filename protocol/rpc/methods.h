/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rpc/methods.h: the methods and notifications with the tables of their messages, from
 * SHEARD_METHODS and SHEARD_NOTICES of sheard/rpc.h. */
#pragma once

#include "message/table.h"

typedef struct rpc_method {
    const char *name;
    const msg_table *params, *reply;
    bool admin; /* for administrators only */
} rpc_method;

typedef struct rpc_notice {
    const char *name;
    const msg_table *params;
} rpc_notice;

extern const rpc_method rpc_methods[SHEARD_N_METHODS];
extern const rpc_notice rpc_notices[SHEARD_N_NOTICES];
