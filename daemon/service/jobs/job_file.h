/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_file.h: the file of a job that came through the watch folder. What the store
 * says of the job tells whether it has one and what it is called, not whether the spool has told of
 * it since the start. */
#ifndef SHEARD_SERVICE_JOB_FILE_H
#define SHEARD_SERVICE_JOB_FILE_H

#include "spool/spool.h"
#include "store/store.h"

/* Does the file itself describe a job (NAME.json)? Else it is a field to be measured. */
bool job_file_is_description(const char *name);
/* Its name in active/; false where the job has none. */
bool job_file_name(const store_job *job, char name[SPOOL_NAME_SIZE]);
/* Is the file that the job measures the watch folder's own? (Else it is a client's, though a
 * description may have asked for it.) */
bool job_file_is_field(const store_job *job);
/* "DIRECTORY/failed/NAME", malloc'd: where it is now; NULL: nowhere, or there is none, or no watch
 * folder (NULL). */
char *job_file_where(const spool *sp, const char *directory, const store_job *job);
/* A final job is to run again: its file, if it has one, back into active/. Errors as
 * spool_restore; a description may be missing, for the job knows all that it said. */
int job_file_take_back(spool *sp, const store_job *job, shear_error *err);
/* SHEAR_E_IO: the watch folder is switched off. */
int job_file_no_spool(const store_job *job, shear_error *err);

#endif
