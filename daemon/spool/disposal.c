/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From active/ to done/ or failed/: move a file so that a power failure in between does no harm.
 *
 *     write the undo log (undo_log.h)
 *     write the report to active/.ACTIVE_NAME.tmp and fsync it
 *     rename the report to done/NAME.json and fsync done/
 *     move the file and fsync both folders
 *     remove the undo log */
#include "base/cleanup.h"
#include "base/io.h"
#include "spool/internal.h"
#include "spool/place.h"
#include "spool/undo_log.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

typedef struct disposal {
    const char *active_name;
    const char *name;
    enum folder folder; /* DONE or FAILED */
    char target[NAME_SIZE];
    char report[NAME_REPORT_SIZE];
    char temporary[NAME_SIZE];
} disposal;

/* ---- the target's name ---- */

/* Check whether NAME.n or its report exists. Return 0 or errno. */
static int is_taken(const folders *f, const disposal *e, int64_t n, bool *taken) {
    char name[NAME_SIZE];
    char report[NAME_REPORT_SIZE];
    struct stat st;
    name_number(name, e->name, n);
    name_report(report, name);
    int error = folder_stat(f, e->folder, name, &st);
    error = error == ENOENT ? folder_stat(f, e->folder, report, &st) : error;
    *taken = error == 0;
    return error == ENOENT ? 0 : error;
}

/* Choose a free number just above a used one, or 0. Search in doubling steps, then by bisection,
 * since some observatories give all files the same name. Return 0 or errno. */
static int choose_target(const folders *f, disposal *e) {
    int64_t below = -1;
    int64_t free_one = 0;
    bool taken = true;
    while (taken) {
        TRY(is_taken(f, e, free_one, &taken));
        below = taken ? free_one : below;
        free_one = taken ? 2 * free_one + 1 : free_one;
    }
    while (free_one - below > 1) {
        const int64_t middle = below + (free_one - below) / 2;
        TRY(is_taken(f, e, middle, &taken));
        *(taken ? &below : &free_one) = middle;
    }
    name_number(e->target, e->name, free_one);
    name_report(e->report, e->target);
    return 0;
}

/* ---- the steps ---- */

static int write_report(const folders *f, const disposal *e, const char *text) {
    const int fd = openat(f->fd[ACTIVE], e->temporary,
                          O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640);
    if (fd < 0)
        return errno;
    return io_finish(fd, io_write(fd, text, strlen(text)));
}

/* Move the file, after the report is in its folder. On error remove the report. */
static int move_after_report(const folders *f, const disposal *e) {
    int error = folder_sync(f, e->folder);
    if (error == 0)
        error = folder_move(f, ACTIVE, e->active_name, e->folder, e->target);
    if (error != 0)
        unlinkat(f->fd[e->folder], e->report, 0);
    return error;
}

static int write_and_move(const folders *f, const disposal *e, const char *text) {
    TRY(undo_log_write(f, e->active_name, e->folder, e->target));
    TRY(write_report(f, e, text));
    TRY(folder_move(f, ACTIVE, e->temporary, e->folder, e->report));
    return move_after_report(f, e);
}

/* Do everything up to the move of the file, or nothing. Return 0 or errno. */
static int move_with_report(const folders *f, const disposal *e, const char *text) {
    const int error = write_and_move(f, e, text);
    if (error != 0) {
        unlinkat(f->fd[ACTIVE], e->temporary, 0);
        undo_log_remove(f, e->active_name);
    }
    return error;
}

static int dispose(spool *s, disposal *e, const char *text, spool_place *place) {
    struct stat st;
    const folders *f = &s->folders;
    assert(e->folder == DONE || e->folder == FAILED);
    const int error = folder_stat(f, ACTIVE, e->active_name, &st);
    if (error == ENOENT) {
        undo_log_remove(f, e->active_name);
        return folder_sync_move(f, e->folder);
    }
    TRY(error);
    TRY(choose_target(f, e));
    TRY(move_with_report(f, e, text));
    unacknowledged_remove(&s->unacknowledged, e->active_name);
    s->stats.active--;
    s->stats.done += e->folder == DONE;
    s->stats.failed += e->folder == FAILED;
    place_set(f, place, e->folder, e->target);
    TRY(folder_sync_move(f, e->folder)); /* if it fails, nothing is undone */
    undo_log_remove(f, e->active_name);
    return 0;
}

int spool_dispose(spool *s, const char *active_name, bool good, const char *report,
                  spool_place *place, shear_error *err) {
    spool_place ignored;
    disposal e = {.active_name = active_name,
                  .name = name_of_active(active_name),
                  .folder = good ? DONE : FAILED};
    if (e.name == NULL)
        return name_fail_active(active_name, err);
    undo_log_temporary(e.temporary, active_name);
    place = place != NULL ? place : &ignored;
    *place = (spool_place){.name = ""};
    const int error = dispose(s, &e, report, place);
    if (error == 0)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_IO,
                      error == ENOSPC || error == EDQUOT ? "make room on the spool's disk"
                                                         : "see that the spool's disk is sound",
                      "%s/active/%s: cannot be moved to %s/: %s", s->folders.path, active_name,
                      folder_name(e.folder), strerror(error));
}
