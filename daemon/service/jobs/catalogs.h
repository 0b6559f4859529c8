/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/catalogs.h: the jobs' result catalogs, and their temporary files, which wait for a
 * job's next attempt.
 *
 * A catalog is in place before its job's end is on disk. Where the service dies between, or that
 * end is another one (cancelled meanwhile), it is nobody's: it goes at the job's end, or at the
 * next start. What was there before the directory was marked is never taken for one, and no start
 * looks at what the last one has seen (jobs/catalog_directory.h). */
#ifndef SHEARD_SERVICE_CATALOGS_H
#define SHEARD_SERVICE_CATALOGS_H

#include "store/store.h"

typedef struct service service;

char *catalog_path(const service *s, int64_t job); /* malloc'd; NULL where there are none */
/* A job is over: its temporary file, and a catalog that it did not end with, go. */
void catalog_forget(const service *s, const store_job *job);
/* At the start: their directory is claimed, and what nobody needs goes. */
int catalogs_open(service *s, shear_error *err);
/* Jobs were retracted, and that is on disk: their catalogs go. Where one cannot, the next start
 * tries it again. */
void catalogs_remove_retracted(service *s);
/* That of a contribution of a forgotten field; of a retired job, as it is called in the directory.
 * True: there is none any more. */
bool catalog_remove_leaving(const service *s, const store_removal *leaving);

#endif
