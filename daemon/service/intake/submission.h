/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/intake/submission.h: turn a client's request, or a file of the watch folder, into a job
 * in the store. */
#pragma once

#include "access/access.h"
#include "sheard/messages.h"
#include "sheard/rpc.h"
#include "store/store.h"

typedef struct service service;

typedef struct submission {
    const sheard_msg_submit *submit;
    access_peer peer; /* its groups are borrowed */
    enum store_origin origin;
    const char *key;
    const char *source;  /* path of a file of the watch folder; NULL: use the client's source */
    const char *dropped; /* name of the dropped file; NULL: none */
} submission;

/* Store the job in the current group. Return SHEARD_RPC_OK and *id, or the code of *error. *known
 * is true if the idempotency key had been used before. */
int submission_store(service *s, const submission *sub, int64_t *id, bool *known,
                     sheard_rpc_error *error);
