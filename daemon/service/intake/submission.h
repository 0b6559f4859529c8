/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/intake/submission.h: from what a client, or a file of the watch folder, asks for to a job
 * in the store. */
#ifndef SHEARD_SERVICE_SUBMISSION_H
#define SHEARD_SERVICE_SUBMISSION_H

#include "access/access.h"
#include "sheard/messages.h"
#include "sheard/rpc.h"
#include "store/store.h"

typedef struct service service;

typedef struct submission {
    const sheard_msg_submit *submit;
    access_peer peer; /* groups borrowed */
    enum store_origin origin;
    const char *key;
    const char *source;  /* path to store, for the watch folder's own files; NULL: a client's */
    const char *dropped; /* name of the file that was dropped; NULL: none was */
} submission;

/* Into the store, within the group. SHEARD_RPC_OK and *id, or an error; *known: the key had been
 * seen. */
int submission_store(service *s, const submission *sub, int64_t *id, bool *known,
                     sheard_rpc_error *error);

#endif
