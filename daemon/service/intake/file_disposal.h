/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/intake/file_disposal.h: move files of the watch folder to done/ or failed/, with a
 * report. */
#pragma once

#include "sheard/rpc.h"
#include "spool/spool.h"
#include "store/store.h"

typedef struct service service;

/* Move the file of a final job, if it has one, to done/ or failed/, and store its place in *job. */
void file_disposal_end(service *s, store_job *job);
/* Move a file that cannot become a job to failed/. */
void file_disposal_reject(service *s, const spool_file *file, const sheard_rpc_error *why);
/* Leave the file in active/, to be reported again. */
void file_disposal_put_off(service *s, const char *active_name, const char *code,
                           const char *message);
