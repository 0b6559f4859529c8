/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/catalogs.h: the jobs' result catalogs, and their temporary files, which are kept for
 * a job's next attempt.
 *
 * A catalog gets its name before its job's outcome is on disk. If the service dies in between, or
 * if the outcome is another one (cancelled meanwhile), the catalog belongs to no job and is removed
 * when the job ends or at the next start. Files older than the directory's mark are not removed
 * in this way, and no start examines what an earlier one has (jobs/catalog_directory.h). */
#pragma once

#include "store/store.h"

typedef struct service service;

/* Return the path of the job's catalog, malloc'd, or NULL if catalogs are off or out of memory. */
char *catalog_path(const service *s, int64_t job);
/* Remove the temporary file of a job that is over, and its catalog if the job did not end with
 * one. */
void catalog_forget(const service *s, const store_job *job);
/* Claim the catalogs' directory and remove files that belong to no job. Call at the start. */
int catalogs_open(service *s, shear_error *err);
/* Remove the catalogs of retracted jobs, once the retractions are on disk. What cannot be removed
 * is tried again at the next start. */
void catalogs_remove_retracted(service *s);
/* Remove the catalog of a contribution that is being removed with its field. If the job was
 * retired, its catalog is looked for in the present directory. Return true if there is no catalog
 * any more. */
bool catalog_remove_leaving(const service *s, const store_removal *leaving);
