/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/spooled_file.h: the file of a job that came through the watch folder. All this
 * follows from the job's record in the store, whether or not the spool has reported the file since
 * the start. */
#pragma once

#include "spool/spool.h"
#include "store/store.h"

/* Return true if the name is a job file's (NAME.json). Other files are fields to be measured. */
bool spooled_file_is_job_file(const char *name);
/* Write the file's name in active/. False: the job has no file. */
bool spooled_file_name(const store_job *job, char name[SPOOL_NAME_SIZE]);
/* Return true if the job measures a file of the watch folder. A job file is in the watch folder,
 * but the file that it names is a client's. */
bool spooled_file_is_field(const store_job *job);
/* Return "DIRECTORY/failed/NAME" or the like, malloc'd: where the file is now. NULL: it is not
 * found, the job has none, `sp` is NULL (no watch folder), or out of memory. */
char *spooled_file_where(const spool *sp, const char *directory, const store_job *job);
/* Move the file of a final job that is to run again, if it has one, back to active/. Errors of
 * spool_restore; those of a job file are ignored, since the job's record has all of its content. */
int spooled_file_restore(spool *sp, const store_job *job, shear_error *err);
/* Fail with SHEAR_E_IO because the watch folder is switched off. */
int spooled_file_fail_switched_off(const store_job *job, shear_error *err);
