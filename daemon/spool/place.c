/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/place.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "spool/internal.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void place_fingerprint(const struct stat *st, char out[SPOOL_FINGERPRINT_SIZE]) {
    snprintf(out, SPOOL_FINGERPRINT_SIZE, "%" PRId64 " %" PRId64 ".%09ld", (int64_t)st->st_size,
             (int64_t)st->st_mtim.tv_sec, st->st_mtim.tv_nsec);
}

void place_set(const folders *f, spool_place *place, enum folder folder, const char *name) {
    struct stat st;
    *place = (spool_place){.name = ""};
    if (folder_stat(f, folder, name, &st) == 0) {
        snprintf(place->name, sizeof place->name, "%s/%.255s", folder_name(folder), name);
        place_fingerprint(&st, place->fingerprint);
    }
}

const char *place_parse(const spool_place *place, enum folder *folder) {
    const char *name = folder_of_place(place->name, folder);
    return name != NULL && name_validate(name) == NAME_GOOD ? name : NULL;
}

const char *spool_locate(const spool *s, const char *active_name, const spool_place *place,
                         char buffer[SPOOL_PLACE_SIZE]) {
    struct stat st;
    enum folder folder = DONE;
    if (name_of_active(active_name) != NULL &&
        folder_stat(&s->folders, ACTIVE, active_name, &st) == 0) {
        snprintf(buffer, SPOOL_PLACE_SIZE, "%s/%.255s", folder_name(ACTIVE), active_name);
        return buffer;
    }
    const char *name = place_parse(place, &folder);
    return name != NULL && folder_stat(&s->folders, folder, name, &st) == 0 ? place->name : NULL;
}

static bool has_key(const folders *f, enum folder folder, const char *report, const char *key) {
    enum { REPORT_MAX = 1 << 20 };
    CLEANUP(release_fd)
    int fd =
        openat(f->fd[folder], report, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    CLEANUP(release_free) char *text = fd >= 0 ? malloc(REPORT_MAX) : NULL;
    const ssize_t n = text != NULL ? io_read(fd, text, REPORT_MAX) : -1;
    return n > 0 && memmem(text, (size_t)n, key, strlen(key)) != NULL;
}

void spool_find_place(const spool *s, const char *active_name, int names, spool_place *place) {
    const char *name = name_of_active(active_name);
    char key[SPOOL_KEY_SIZE];
    *place = (spool_place){.name = ""};
    if (name == NULL)
        return;
    name_key(key, active_name);
    for (int64_t n = 0; n < names; n++) {
        char one[NAME_SIZE];
        char report[NAME_REPORT_SIZE];
        name_number(one, name, n);
        name_report(report, one);
        for (enum folder folder = DONE; folder <= FAILED; folder++) {
            if (has_key(&s->folders, folder, report, key)) {
                place_set(&s->folders, place, folder, one);
                return;
            }
        }
    }
}
