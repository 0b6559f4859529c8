/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/catalogs.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/parts.h"
#include "service/jobs/catalog_directory.h"
#include "shear/catalog.h"

#include <errno.h>
#include <inttypes.h>

char *catalog_path(const service *s, int64_t job) {
    return s->config.catalogs.enabled ? catalog_directory_path(s->config.catalogs.directory, job)
                                      : NULL;
}

/* ---- at a job's end ---- */

static void remove_part(const char *path, int64_t job) {
    shear_error err = {0};
    if (shear_catalog_discard(path, &err) != SHEAR_OK)
        log_warning("job %" PRId64 ": %s", job, err.message);
}

static void remove_final(const char *path, int64_t job) {
    if (unlink(path) == 0) {
        log_notice("job %" PRId64 ": %s is removed: the job did not end with it", job, path);
    } else if (errno != ENOENT) {
        log_warning("job %" PRId64 ": %s cannot be removed: %s", job, path, strerror(errno));
    }
}

void catalog_forget(const service *s, const store_job *job) {
    CLEANUP(release_free) char *path = catalog_path(s, job->id);
    if (path == NULL)
        return;
    remove_part(path, job->id);
    if (job->catalog == NULL && job->started_ms != 0 &&
        catalog_directory_is_since_mark(s->config.catalogs.directory, path)) {
        remove_final(path, job->id);
    }
}

/* ---- what was retracted ---- */

/* Remove the catalog of a retracted job. Return true if there is none any more. A directory that
 * now belongs to another database is left alone. `unmarked`: a directory without a mark is ours. */
static bool remove_retracted(const service *s, int64_t id, const char *path, bool unmarked) {
    if (!catalog_directory_is_name(path, id) || !catalog_directory_is_ours(s, path, unmarked) ||
        unlink(path) == 0 || errno == ENOENT) {
        return true;
    }
    log_warning("job %" PRId64 " is retracted: its catalog %s cannot be removed: %s", id, path,
                strerror(errno));
    return false;
}

bool catalog_remove_leaving(const service *s, const store_removal *l) {
    if (l->kept)
        return l->catalog == NULL || remove_retracted(s, l->job, l->catalog, true);
    CLEANUP(release_free)
    char *path = catalog_directory_path(s->config.catalogs.directory, l->job);
    return path == NULL || remove_retracted(s, l->job, path, false);
}

/* Remove the catalog of the next retracted job after *id, and set *id; 0: there is no other. */
static int remove_next_retracted(service *s, int64_t *id, shear_error *err) {
    CLEANUP(release_free) char *path = NULL;
    TRY(store_next_leftover(s->store, *id, id, &path, err));
    if (*id == 0 || !remove_retracted(s, *id, path, true))
        return SHEAR_OK;
    TRY(group_begin(&s->group, err));
    return store_catalog_gone(s->store, *id, err);
}

void catalogs_remove_retracted(service *s) {
    shear_error err = {0};
    int64_t id = 0;
    int code = SHEAR_OK;
    do {
        code = remove_next_retracted(s, &id, &err);
    } while (code == SHEAR_OK && id != 0);
    if (code != SHEAR_OK)
        log_warning("catalogs of retracted jobs: %s", err.message);
}

/* ---- the start ---- */

/* Remove the temporary file of a job that is over, and the catalog of any job whose record names
 * none: an attempt that the store does not know has written it. Catalogs of retired jobs stay. */
static void clean_up(service *s, int64_t id, bool part, void *context) {
    CLEANUP(store_job_deinit) store_job job = {0};
    CLEANUP(release_free) char *path = catalog_path(s, id);
    shear_error ignored;
    (void)context;
    if (path == NULL ||
        (!part && !catalog_directory_is_since_mark(s->config.catalogs.directory, path))) {
        return;
    }
    const int code = store_job_get(s->store, id, &job, &ignored);
    const bool over =
        code == STORE_NOT_FOUND || (code == SHEAR_OK && store_state_is_final(job.state));
    if (part && over) {
        remove_part(path, id);
    } else if (!part && code == SHEAR_OK && job.catalog == NULL) {
        remove_final(path, id);
    }
}

int catalogs_open(service *s, shear_error *err) {
    const char *directory = s->config.catalogs.directory;
    if (!s->config.catalogs.enabled)
        return SHEAR_OK;
    TRY(catalog_directory_claim(s, directory, err));
    TRY(catalog_directory_visit(s, directory, clean_up, NULL, err));
    catalog_directory_renew_mark(directory);
    return SHEAR_OK;
}
