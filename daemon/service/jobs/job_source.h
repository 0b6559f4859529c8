/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_source.h: open the files that a job reads, with the rights of the user who
 * submitted it. */
#pragma once

#include "access/access.h"
#include "service/jobs/job_outcome.h"
#include "shear/field.h"
#include "sheard/messages.h"
#include "store/store.h"

typedef struct service service;

enum job_source_code {
    JOB_SOURCE_E_TOO_LARGE = 140 /* a file is larger than [reader] max_file_bytes */
};

typedef struct source_files {
    int fds[SHEAR_N_PARTS];     /* indexed as in shear_field_open_input; -1: not open */
    char *paths[SHEAR_N_PARTS]; /* real paths, without links; [0] if it is one field file */
    sheard_msg_source named;    /* the source with those paths; its other texts are borrowed */
    int part;                   /* after an error: the one that failed; -1: the field file */
} source_files;

_Static_assert(SHEAR_N_PARTS == 9, "as many as in SOURCE_FILES_NONE");
#define SOURCE_FILES_NONE                                                                          \
    {                                                                                              \
        .fds = { -1, -1, -1, -1, -1, -1, -1, -1, -1 }                                              \
    }

/* Check a file's size, without reading it. SHEAR_OK or JOB_SOURCE_E_TOO_LARGE. fd < 0: not open,
 * which is SHEAR_OK. */
int source_files_check_size(const service *s, int fd, const char *name, shear_error *err);
/* Open a client's files beneath the data roots, with the peer's rights, and check their sizes.
 * Errors of access_open and JOB_SOURCE_E_TOO_LARGE. Deinit *files in either case. */
int source_files_open(const service *s, const access_peer *peer, const sheard_msg_source *source,
                      source_files *files, shear_error *err);
/* Close the descriptors and free the paths. */
void source_files_deinit(source_files *files);

/* The open files of a job that is to run, and their names. */
typedef struct job_source {
    sheard_msg_source source; /* as stored */
    source_files files;
    shear_input input;     /* borrows its names from this record */
    int rpc;               /* after an error: the protocol's code, for who submits the job ... */
    failure_reason reason; /* ... and why the job fails */
} job_source;

/* Open the files for the job's owner, with the groups that the owner had when submitting; files of
 * the watch folder with the service's own rights. Deinit *o in either case. */
int job_source_open(const service *s, const store_job *job, job_source *o, shear_error *err);
void job_source_deinit(job_source *o);
