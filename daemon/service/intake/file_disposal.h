/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/intake/file_disposal.h: what becomes of a file of the watch folder: done/ or failed/, and
 * a report beside it. */
#ifndef SHEARD_SERVICE_FILE_DISPOSAL_H
#define SHEARD_SERVICE_FILE_DISPOSAL_H

#include "sheard/rpc.h"
#include "spool/spool.h"
#include "store/store.h"

typedef struct service service;

/* Where the job is final: its file, if it has one, goes to done/ or failed/, and *job says where it
 * is. */
void file_disposal_end(service *s, store_job *job);
/* A file that never becomes a job. */
void file_disposal_reject(service *s, const spool_file *file, const sheard_rpc_error *why);
/* It stays in active/, and is told again. */
void file_disposal_put_off(service *s, const char *active_name, const char *code,
                           const char *message);

#endif
