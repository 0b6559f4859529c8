/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/job_files.h: the open files of a job, and whether they are still what they were. */
#ifndef SHEARD_ENGINE_FILES_H
#define SHEARD_ENGINE_FILES_H

#include "shear/error.h"
#include "shear/input.h"

#include <stdbool.h>
#include <sys/stat.h>

typedef struct job_files {
    shear_input input;      /* its texts are owned */
    int fds[SHEAR_N_PARTS]; /* as of shear_field_open_input; -1: none */
    struct stat initial[SHEAR_N_PARTS];
} job_files;

/* Take the descriptors (closed by job_files_close, also after an error), copy the names, and note
 * what the files are now. False where memory is out. */
bool job_files_acquire(job_files *f, const shear_input *input, const int *fds);
void job_files_close(job_files *f);

/* Bytes of all of them, each file once. */
int64_t job_files_bytes(const job_files *f);

/* ENGINE_E_CHANGED where one of the files is not what it was when it was acquired: its size or the
 * time of its last change (of content, mode, names). Seen on the descriptors that are read from, so
 * that it does not matter where their names lead meanwhile. */
int job_files_check(const job_files *f, shear_error *err);

#endif
