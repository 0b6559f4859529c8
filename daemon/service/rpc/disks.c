/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/disks.h"

#include "service/core/parts.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* A disk is full with less free than this, or than a twentieth of it if that is less. */
static const int64_t little_bytes = INT64_C(64) << 20;

bool disk_is_full(const sheard_msg_disk *d) {
    const int64_t part = d->bytes / 20;
    return d->free_bytes < (part < little_bytes ? part : little_bytes);
}

static const char *complaint(const char *path) {
    return faccessat(AT_FDCWD, path, W_OK | X_OK, AT_EACCESS) == 0 ? NULL : strerror(errno);
}

/* Check the four folders of the watch folder, which are what is written to. */
static const char *spool_complaint(const char *path) {
    static const char *const folders[] = {"incoming", "active", "done", "failed"};
    const char *found = NULL;
    for (size_t i = 0; found == NULL && i < sizeof folders / sizeof *folders; i++) {
        char folder[4400];
        snprintf(folder, sizeof folder, "%s/%s", path, folders[i]);
        found = complaint(folder);
    }
    return found;
}

/* The devices seen so far, each with its first use. */
typedef struct disk_seen {
    const char *uses[DISKS];
    dev_t devices[DISKS];
    size_t n;
} disk_seen;

static void look(disk_seen *seen, const char *use, const char *path, sheard_msg_disk *d) {
    struct statvfs fs;
    struct stat st;
    *d = (sheard_msg_disk){.use = use, .path = path};
    if (stat(path, &st) != 0 || statvfs(path, &fs) != 0) {
        d->problem = strerror(errno);
        return;
    }
    d->free_bytes = (int64_t)fs.f_bavail * (int64_t)fs.f_frsize;
    d->bytes = (int64_t)fs.f_blocks * (int64_t)fs.f_frsize;
    d->problem = strcmp(use, "spool") == 0 ? spool_complaint(path) : complaint(path);
    for (size_t i = 0; d->same_as == NULL && i < seen->n; i++)
        d->same_as = seen->devices[i] == st.st_dev ? seen->uses[i] : NULL;
    if (d->same_as == NULL) {
        seen->uses[seen->n] = use;
        seen->devices[seen->n++] = st.st_dev;
    }
}

size_t disks_get(const service *s, sheard_msg_disk disks[DISKS]) {
    const sheard_config *c = &s->config;
    disk_seen seen = {.n = 0};
    size_t n = 0;
    look(&seen, "state", c->daemon.state_dir, &disks[n++]);
    if (c->spool.enabled)
        look(&seen, "spool", c->spool.directory, &disks[n++]);
    if (c->catalogs.enabled)
        look(&seen, "catalogues", c->catalogs.directory, &disks[n++]);
    look(&seen, "scratch", engine_get_scratch(s->engine), &disks[n++]);
    return n;
}
