/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/catalog_directory.h: the directory of the result catalogs.
 *
 * Catalogs are called after the jobs' numbers, which every database counts from 1. So a directory
 * belongs to one database: the mark, the file .sheard-database in it, says which. A directory
 * without it is claimed where nothing of the kind lies in it, or where this database knows what
 * does (0.1 left no mark). The mark's time of change says since when there may be catalogs that no
 * job ended with: see jobs/catalogs.h. */
#ifndef SHEARD_SERVICE_CATALOG_DIRECTORY_H
#define SHEARD_SERVICE_CATALOG_DIRECTORY_H

#include "store/store.h"

typedef struct service service;

/* "DIRECTORY/JOB.shear.fits", malloc'd; NULL: out of memory. */
char *catalog_directory_path(const char *directory, int64_t job);
/* Is this the name that a catalog of the job has, wherever its directory was? */
bool catalog_directory_is_name(const char *path, int64_t job);

/* `part`: it is a temporary file (.JOB.shear.fits.part). */
typedef void catalog_visitor(service *s, int64_t job, bool part, void *context);
/* All that lies in the directory. */
int catalog_directory_visit(service *s, const char *directory, catalog_visitor *visit,
                            void *context, shear_error *err);

/* The directory is made, where it is not there, and is this database's from now on. SHEAR_E_EXISTS
 * where it is another's. */
int catalog_directory_claim(service *s, const char *directory, shear_error *err);
/* Whose is the directory that the file is in? One without a mark is ours where `unmarked` says so.
 */
bool catalog_directory_is_ours(const service *s, const char *path, bool unmarked);
/* Was the file changed after the directory was marked? */
bool catalog_directory_is_since_mark(const char *directory, const char *path);
/* What lies in it has been looked at: the mark is of now. Marks that were begun go. */
void catalog_directory_renew_mark(const char *directory);

#endif
