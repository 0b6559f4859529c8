/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_source.h: the files that a job reads: opened for the one who asked, and for no
 * other. */
#ifndef SHEARD_SERVICE_JOB_SOURCE_H
#define SHEARD_SERVICE_JOB_SOURCE_H

#include "access/access.h"
#include "shear/field.h"
#include "sheard/messages.h"
#include "store/store.h"

typedef struct service service;

enum job_source_code {
    JOB_SOURCE_E_TOO_LARGE = 140 /* a file is larger than [reader] max_file_bytes */
};

typedef struct source_files {
    int fds[SHEAR_N_PARTS];     /* as of shear_field_open_input; -1: none */
    char *paths[SHEAR_N_PARTS]; /* without links; of a field file: the first */
    sheard_msg_source named;    /* the source by those paths; its other texts are borrowed */
} source_files;

#define SOURCE_FILES_NONE                                                                          \
    {                                                                                              \
        .fds = { -1, -1, -1, -1 }                                                                  \
    }

/* SHEAR_OK or JOB_SOURCE_E_TOO_LARGE, by the size alone: not a byte is read. fd < 0: none. */
int source_files_check_size(const service *s, int fd, const char *name, shear_error *err);
/* Open a client's files beneath the data roots, by the peer's rights, and look at their sizes.
 * Errors of access_open and JOB_SOURCE_E_TOO_LARGE; *part is then which one failed (-1: the field
 * file). Deinit it either way. */
int source_files_open(const service *s, const access_peer *peer, const sheard_msg_source *source,
                      source_files *files, int *part, shear_error *err);
/* Closes what is open. */
void source_files_deinit(source_files *files);

/* What a running job reads: opened, and what it is called. */
typedef struct job_source {
    sheard_msg_source source; /* as the store has it */
    source_files files;
    shear_input input;           /* its names, which live as long as this */
    enum store_class fail_class; /* on an error, with the protocol's name of it */
    const char *fail_name;
} job_source;

/* For the job's owner, with the groups that it had when it asked; the watch folder's own files by
 * the service's right. Deinit it either way. */
int job_source_open(const service *s, const store_job *job, job_source *o, shear_error *err);
void job_source_deinit(job_source *o);

#endif
