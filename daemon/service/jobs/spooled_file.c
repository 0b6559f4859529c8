/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/spooled_file.h"

#include "base/text.h"

#include <stdio.h>

/* How many names are tried for a file whose place is not known: GLANCE when many jobs are listed,
 * SEARCH for one job. */
enum { GLANCE = 8, SEARCH = 256 };

bool spooled_file_is_job_file(const char *name) {
    return text_ends_with(name, ".json");
}

bool spooled_file_name(const store_job *job, char name[SPOOL_NAME_SIZE]) {
    if (job->origin != STORE_SPOOL || job->key == NULL || job->dropped == NULL)
        return false;
    const int n = snprintf(name, SPOOL_NAME_SIZE, "%s-%s", job->key, job->dropped);
    return n > 0 && n < SPOOL_NAME_SIZE;
}

bool spooled_file_is_field(const store_job *job) {
    return job->origin == STORE_SPOOL && job->dropped != NULL &&
           !spooled_file_is_job_file(job->dropped);
}

/* Return the place that the store has; if it has none (the job of an older version, or the service
 * died before the place was stored), the one that is found among the first `names`. */
static spool_place place_of(const spool *sp, const store_job *job, const char *name, int names) {
    spool_place place = {.name = ""};
    if (job->place != NULL) {
        text_set(place.name, sizeof place.name, job->place);
        text_set(place.fingerprint, sizeof place.fingerprint, job->place_fingerprint);
    }
    if (place.name[0] == '\0' && store_state_is_final(job->state))
        spool_find_place(sp, name, names, &place);
    return place;
}

char *spooled_file_where(const spool *sp, const char *directory, const store_job *job) {
    char name[SPOOL_NAME_SIZE];
    char buffer[SPOOL_PLACE_SIZE];
    char *path = NULL;
    if (sp == NULL || !spooled_file_name(job, name))
        return NULL;
    const spool_place place = place_of(sp, job, name, GLANCE);
    const char *where = spool_locate(sp, name, &place, buffer);
    return where != NULL && asprintf(&path, "%s/%s", directory, where) > 0 ? path : NULL;
}

int spooled_file_fail_switched_off(const store_job *job, shear_error *err) {
    return shear_fail(err, SHEAR_E_IO, "switch the watch folder on again ([spool] enabled)",
                      "'%s' was dropped into the watch folder, which is switched off",
                      job->dropped);
}

int spooled_file_restore(spool *sp, const store_job *job, shear_error *err) {
    char name[SPOOL_NAME_SIZE];
    if (!spooled_file_name(job, name))
        return SHEAR_OK;
    if (sp == NULL)
        return spooled_file_fail_switched_off(job, err);
    const spool_place place = place_of(sp, job, name, SEARCH);
    const int code = spool_restore(sp, name, &place, err);
    return spooled_file_is_job_file(job->dropped) ? SHEAR_OK : code;
}
