/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/catalog_directory.h: the directory of the result catalogs, and the mark that says
 * which database it belongs to.
 *
 * Catalogs are named by the jobs' numbers, which every database counts from 1. So a directory
 * belongs to one database: the mark, the file .sheard-database in it, contains that database's
 * identity. A directory without a mark is claimed if there are no catalogs in it, or if this
 * database knows some of them (version 0.1 wrote no mark). The mark's modification time is when the
 * directory was last cleaned up: files older than that are not examined again (jobs/catalogs.h). */
#pragma once

#include "store/store.h"

typedef struct service service;

/* Return "DIRECTORY/JOB.shear.fits", malloc'd, or NULL if out of memory. */
char *catalog_directory_path(const char *directory, int64_t job);
/* Return true if the path ends in the name of this job's catalog, in whatever directory. */
bool catalog_directory_is_name(const char *path, int64_t job);

/* Called for each catalog; `part` is true for a temporary file (.JOB.shear.fits.part). */
typedef void catalog_visitor(service *s, int64_t job, bool part, void *context);
/* Visit all catalogs and temporary files in the directory. SHEAR_E_IO. */
int catalog_directory_visit(service *s, const char *directory, catalog_visitor *visit,
                            void *context, shear_error *err);

/* Make the directory if it is missing, and claim it for this database. SHEAR_E_EXISTS if it belongs
 * to another one, SHEAR_E_IO, SHEAR_E_NOMEM, errors of the store. */
int catalog_directory_claim(service *s, const char *directory, shear_error *err);
/* Return true if the file's directory has the mark of this database, or `unmarked` if it has no
 * mark. */
bool catalog_directory_is_ours(const service *s, const char *path, bool unmarked);
/* Return true if the file changed after the mark's modification time. */
bool catalog_directory_is_since_mark(const char *directory, const char *path);
/* Set the mark's modification time to now, after a clean-up; remove incomplete marks. */
void catalog_directory_renew_mark(const char *directory);
