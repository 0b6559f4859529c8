/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/problem_list.h"

#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* ---- the disks ---- */

/* A disk is full with less free than this, or than a twentieth of it if that is less. */
static const int64_t little_bytes = INT64_C(64) << 20;

/* Return whether the disk is full, or nearly so. */
static bool disk_is_full(const sheard_msg_disk *d) {
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

/* Fill disks[i]; devices[i] becomes its device. */
static void look(const char *use, const char *path, sheard_msg_disk *disks, dev_t *devices,
                 size_t i) {
    sheard_msg_disk *d = &disks[i];
    struct statvfs fs;
    struct stat st;
    *d = (sheard_msg_disk){.use = use, .path = path};
    devices[i] = (dev_t)-1;
    if (stat(path, &st) != 0 || statvfs(path, &fs) != 0) {
        d->problem = strerror(errno);
        return;
    }
    devices[i] = st.st_dev;
    d->free_bytes = (int64_t)fs.f_bavail * (int64_t)fs.f_frsize;
    d->bytes = (int64_t)fs.f_blocks * (int64_t)fs.f_frsize;
    d->problem = strcmp(use, "spool") == 0 ? spool_complaint(path) : complaint(path);
    for (size_t k = 0; d->same_as == NULL && k < i; k++)
        d->same_as = devices[k] == st.st_dev ? disks[k].use : NULL;
}

/* Fill `disks` and return their number. */
static size_t disks_get(const service *s, sheard_msg_disk disks[DISKS]) {
    const sheard_config *c = &s->config;
    dev_t devices[DISKS];
    size_t n = 0;
    look("state", c->daemon.state_dir, disks, devices, n++);
    if (c->spool.enabled)
        look("spool", c->spool.directory, disks, devices, n++);
    if (c->catalogs.enabled)
        look("catalogues", c->catalogs.directory, disks, devices, n++);
    look("scratch", engine_get_scratch(s->engine), disks, devices, n++);
    return n;
}

/* ---- the problems ---- */

/* Add a problem, with a message as of printf, and return it. If the list is full, the problem is
 * left out, and what the caller writes is lost. */
static __attribute__((format(printf, 4, 5))) sheard_msg_problem *
add(problem_list *list, const char *about, const char *code, const char *format, ...) {
    const size_t i = list->n;
    va_list args;
    va_start(args, format);
    vsnprintf(list->texts[i], PROBLEM_TEXT, format, args);
    va_end(args);
    list->lines[i] = list->texts[i];
    list->items[i] =
        (sheard_msg_problem){.about = about, .code = code, .message = list->texts[i], .count = 1};
    list->n += i < PROBLEMS_TOLD;
    return &list->items[i];
}

static void add_store(const service *s, problem_list *list) {
    const problem_note *note = problem_note_find(&s->notes, "store", NULL);
    if (note == NULL)
        return;
    sheard_msg_problem *p = add(list, "store", note->code, "the store: %s", note->message);
    p->since_ms = note->since_ms;
    p->count = note->count;
    p->next_attempt_ms = clock_wall_ms() + 1000; /* tried at every tick */
}

static void add_waiting(const service *s, problem_list *list) {
    shear_error ignored;
    if (store_waiting_reasons(s->store, list->waiting, PROBLEM_REASONS, &list->n_waiting,
                              &ignored) != SHEAR_OK) {
        return;
    }
    for (size_t i = 0; i < list->n_waiting; i++) {
        const store_waiting *w = &list->waiting[i];
        const problem_note *note = problem_note_find(&s->notes, "jobs", w->code);
        sheard_msg_problem *p = add(list, "jobs", w->code, "%" PRId64 " %s (%s): %.300s", w->jobs,
                                    w->jobs == 1 ? "job waits" : "jobs wait", w->code, w->message);
        p->since_ms = note != NULL ? note->since_ms : s->started_wall_ms;
        p->count = w->jobs;
        p->attempts = w->attempts;
        p->next_attempt_ms = w->next_ms;
    }
}

static void add_spool(const service *s, problem_list *list) {
    const spool_stats st = spool_get_stats(s->spool);
    spool_ignored first;
    const problem_note *note = problem_note_find(&s->notes, "spool", NULL);
    sheard_msg_problem *p;
    if (st.trouble[0] != '\0') {
        p = add(list, "spool", "io", "the watch folder: %.300s", st.trouble);
        p->since_ms = st.trouble_since_ms;
    } else if (!st.watching) {
        add(list, "spool", "not_watched",
            "the watch folder: the kernel does not announce files there; they are found by "
            "searching it only ([spool] scan_interval)");
    }
    if (note != NULL && st.active > 0) {
        p = add(list, "spool", note->code, "files wait in active/ (%s): %.300s", note->code,
                note->message);
        p->since_ms = note->since_ms;
        p->count = note->count;
    }
    if (spool_get_ignored(s->spool, &first, 1) > 0) {
        p = add(list, "incoming", "ignored_files", "%" PRId64 " %s in incoming/: %.200s: %s",
                st.ignored, st.ignored == 1 ? "file is left lying" : "files are left lying",
                first.name, first.reason);
        p->count = st.ignored;
    }
}

static void add_disks(problem_list *list) {
    for (size_t i = 0; i < list->n_disks; i++) {
        const sheard_msg_disk *d = &list->disks[i];
        if (d->problem != NULL) {
            add(list, "disk", "unusable", "%s, %.200s: %s", d->use, d->path, d->problem);
        } else if (d->same_as == NULL && disk_is_full(d)) {
            add(list, "disk", "disk_full", "%s, %.200s: only %" PRId64 " KiB are free", d->use,
                d->path, d->free_bytes / 1024);
        }
    }
}

static void add_log(problem_list *list) {
    const log_losses log = log_get_losses();
    if (log.untold == 0)
        return;
    sheard_msg_problem *p =
        add(list, "log", "log_stalled", "nobody reads the log: %" PRId64 " lines of it are lost",
            log.untold);
    p->since_ms = log.since_ms;
    p->count = log.untold;
}

static void add_roots(const service *s, problem_list *list) {
    const root_list *known = &s->roots.known;
    for (size_t i = 0; i < known->n; i++) {
        if (known->roots[i].missing)
            add(list, "root", "root_missing", "%s", known->roots[i].reason);
    }
}

void problem_list_fill(problem_list *list, const service *s) {
    list->n_disks = disks_get(s, list->disks);
    add_store(s, list);
    add_waiting(s, list);
    add_disks(list);
    if (s->spool != NULL)
        add_spool(s, list);
    add_log(list);
    add_roots(s, list);
}
