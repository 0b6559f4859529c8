/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/spooled_file.h: the file of a job that came through the watch folder. What the store
 * says of the job tells whether it has one and what it is called, not whether the spool has told of
 * it since the start. */
#ifndef SHEARD_SERVICE_SPOOLED_FILE_H
#define SHEARD_SERVICE_SPOOLED_FILE_H

#include "spool/spool.h"
#include "store/store.h"

/* Is it a job file (NAME.json), which describes a job? Else it is a field to be measured. */
bool spooled_file_is_job_file(const char *name);
/* Its name in active/; false where the job has none. */
bool spooled_file_name(const store_job *job, char name[SPOOL_NAME_SIZE]);
/* Is the file that the job measures the watch folder's own? (Else it is a client's, though a
 * job file may have asked for it.) */
bool spooled_file_is_field(const store_job *job);
/* "DIRECTORY/failed/NAME", malloc'd: where it is now; NULL: nowhere, or there is none, or no watch
 * folder (NULL). */
char *spooled_file_where(const spool *sp, const char *directory, const store_job *job);
/* A final job is to run again: its file, if it has one, back into active/. Errors as
 * spool_restore; a job file may be missing, for the job knows all that it said. */
int spooled_file_restore(spool *sp, const store_job *job, shear_error *err);
/* SHEAR_E_IO: the watch folder is switched off. */
int spooled_file_no_spool(const store_job *job, shear_error *err);

#endif
