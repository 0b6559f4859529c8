/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_source.h: the files that a job reads: opened for the one who asked, and for no
 * other. */
#ifndef SHEARD_SERVICE_SOURCE_H
#define SHEARD_SERVICE_SOURCE_H

#include "service/inner.h"

typedef struct source_files {
    int fds[SHEAR_N_PARTS];     /* as of shear_field_open_input; -1: none */
    char *paths[SHEAR_N_PARTS]; /* without links; of a field file: the first */
    sheard_msg_source named;    /* the source by those paths; its other texts are borrowed */
} source_files;

enum source_code {
    SOURCE_E_TOO_LARGE = 140 /* a file is larger than [reader] max_file_bytes */
};

/* SHEAR_OK or SOURCE_E_TOO_LARGE, by the size alone: not a byte is read. fd < 0: none. */
int source_check_size(const service *s, int fd, const char *name, shear_error *err);

/* Open a client's files beneath the data roots, by the peer's rights, and look at their sizes.
 * Errors of access_open and SOURCE_E_TOO_LARGE; *part is then which one failed (-1: the field
 * file). Deinit it either way. */
int source_files_open(const service *s, const access_peer *peer, const sheard_msg_source *source,
                      source_files *files, int *part, shear_error *err);
/* Closes what is open. */
void source_files_deinit(source_files *files);

/* What a running job reads: opened, and what it is called. */
typedef struct source_opened {
    sheard_msg_source source; /* as the store has it */
    source_files files;
    shear_input input; /* its names, which live as long as this */
    char *active_name; /* of the watch folder's own file, or NULL */
    int job_class;     /* on an error: enum store_class, and the code's name */
    const char *name;
} source_opened;

/* For the job's owner, with the groups that it had when it asked; the watch folder's own files by
 * the service's right. Deinit it either way. */
int source_open_for_job(service *s, const store_job *job, source_opened *o, shear_error *err);
void source_opened_deinit(source_opened *o);

#endif
