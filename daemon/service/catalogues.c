/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The jobs' result catalogues, and their temporary files, which wait for a job's next attempt. */
#include "service/inner.h"

#include "shear/catalog.h"

#include <dirent.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

char *catalogue_path(const service *s, int64_t job) {
    char *path = NULL;
    if (!s->config.catalogues.enabled ||
        asprintf(&path, "%s/%" PRId64 ".shear.fits", s->config.catalogues.directory, job) < 0) {
        path = NULL;
    }
    return path;
}

void catalogue_forget(const service *s, int64_t job) {
    shear_error err = {0};
    char *path = catalogue_path(s, job);
    if (path != NULL && shear_catalog_forget(path, &err) != SHEAR_OK) {
        log_warning("job %" PRId64 ": %s", job, err.message);
    }
    free(path);
}

/* The job of ".JOB.shear.fits.part"; 0 for other names. */
static int64_t job_of(const char *name) {
    char *end = NULL;
    const int64_t job =
        name[0] == '.' && strspn(name + 1, "0123456789") > 0 ? strtoll(name + 1, &end, 10) : 0;
    return end != NULL && strcmp(end, ".shear.fits.part") == 0 ? job : 0;
}

static bool is_over(service *s, int64_t id) {
    store_job job = {0};
    shear_error ignored;
    const int code = store_job_get(s->store, id, &job, &ignored);
    const bool over =
        code == STORE_NOT_FOUND || (code == SHEAR_OK && shear_job_state_is_final(job.state));
    store_job_deinit(&job);
    return over;
}

void catalogues_sweep(service *s) {
    DIR *directory = s->config.catalogues.enabled ? opendir(s->config.catalogues.directory) : NULL;
    for (struct dirent *e; directory != NULL && (e = readdir(directory)) != NULL;) {
        const int64_t job = job_of(e->d_name);
        if (job > 0 && is_over(s, job)) {
            catalogue_forget(s, job);
        }
    }
    if (directory != NULL) {
        closedir(directory);
    }
}
