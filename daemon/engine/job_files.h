/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/job_files.h: the open files of a job, and the check that they have not changed. */
#pragma once

#include "base/fingerprint.h"
#include "shear/error.h"
#include "shear/input.h"

#include <stdbool.h>

typedef struct job_files {
    shear_input input;      /* its strings are owned */
    int fds[SHEAR_N_PARTS]; /* as for shear_field_open_input; -1: none */
    file_fingerprint initial[SHEAR_N_PARTS];
} job_files;

/* Take over the descriptors (closed by job_files_close, also after an error), copy the names, and
 * record the files' state. Return false if out of memory. */
bool job_files_acquire(job_files *f, const shear_input *input, const int *fds);
void job_files_close(job_files *f);

/* Return the bytes of all files together; a file given twice counts once. */
int64_t job_files_bytes(const job_files *f);

/* Return ENGINE_E_CHANGED if a file has changed since job_files_acquire: its size, or the time of
 * its last change of content, mode or names. The open descriptors are examined, so it does not
 * matter which files the names refer to by now. */
int job_files_check(const job_files *f, shear_error *err);
