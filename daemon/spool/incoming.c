/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/incoming.h"

#include "base/clock.h"
#include "spool/examine.h"
#include "spool/internal.h"
#include "spool/report.h"

#include <errno.h>
#include <string.h>

/* Return the file's record, or NULL if its name is passed over or out of memory: a later scan finds
 * it. */
static candidate *find_or_add(spool *s, const char *name) {
    candidate *file = NULL;
    if (name_validate(name) != NAME_QUIET) {
        file = candidates_find(&s->candidates, name);
        file = file != NULL ? file : candidates_add(&s->candidates, name);
    }
    if (file != NULL)
        file->generation = s->scan.generation;
    return file;
}

static void lost_watch(spool *s) {
    report_line(s, SPOOL_WARNING, "%s/incoming: was removed, renamed or unmounted; looking for it",
                s->folders.path);
    s->stats.watching = false;
    s->scan.next_ms = clock_ms(CLOCK_MONOTONIC);
}

void incoming_event(void *context, enum watch_event event, const char *name) {
    spool *s = context;
    if (event == WATCH_OVERFLOW) {
        report_line(s, SPOOL_NOTICE, "%s/incoming: too many events at once; searching it",
                    s->folders.path);
        s->scan.next_ms = clock_ms(CLOCK_MONOTONIC);
        return;
    }
    if (event == WATCH_LOST) {
        lost_watch(s);
        return;
    }
    candidate *file =
        event == WATCH_GONE ? candidates_find(&s->candidates, name) : find_or_add(s, name);
    if (file != NULL)
        examine_file(s, file, event);
}

/* ---- scans ---- */

static void watch_again(spool *s) {
    if (s->watch.fd < 0) {
        return; /* spool_open has reported it */
    }
    const int error = watch_start(&s->watch, s->folders.fd[INCOMING], s->folders.root);
    s->stats.watching = error == 0;
    if (error != 0) {
        report_line(s, SPOOL_WARNING,
                    "%s/incoming: cannot be watched, scans alone find files: %s%s", s->folders.path,
                    strerror(error), error == ENOSPC ? "; raise fs.inotify.max_user_watches" : "");
    }
}

/* Check the folders, and watch incoming/ if it is new. Return false if the spool is missing. The
 * watch begins before the scan, so that no file is missed in between. */
static bool look_for_folders(spool *s) {
    bool changed = false;
    shear_error err = {0};
    const int code = folders_check(&s->folders, &changed, &err);
    if (code != SHEAR_OK) {
        if (!s->away) {
            report_line(s, SPOOL_ERROR, "%s; no files are taken meanwhile (%s)", err.message,
                        err.advice);
        }
        s->away = true;
        report_trouble(s, "%s", err.message);
        return false;
    }
    if (s->away || changed)
        report_line(s, SPOOL_NOTICE, "%s: is there again", s->folders.path);
    s->away = false;
    if (s->acquire_error == 0)
        report_no_trouble(s);
    if (changed || !s->stats.watching)
        watch_again(s);
    return true;
}

bool incoming_begin_scan(spool *s) {
    s->scan.next_ms = clock_ms(CLOCK_MONOTONIC) + s->tuning.scan_ms;
    if (!look_for_folders(s))
        return false;
    s->scan.dir = folder_list(&s->folders, INCOMING);
    if (s->scan.dir == NULL) {
        report_line(s, SPOOL_ERROR, "%s/incoming: cannot be searched: %s", s->folders.path,
                    strerror(errno));
        report_trouble(s, "%s/incoming cannot be searched: %s", s->folders.path, strerror(errno));
        return false;
    }
    s->scan.generation++;
    return true;
}

static void end_scan(spool *s, int error) {
    closedir(s->scan.dir);
    s->scan.dir = NULL;
    s->stats.scans++;
    if (error == 0) {
        candidates_forget_unseen(&s->candidates, s->scan.generation);
    } else {
        report_line(s, SPOOL_ERROR, "%s/incoming: cannot be searched: %s", s->folders.path,
                    strerror(error));
    }
}

bool incoming_scan(spool *s) {
    for (int i = 0; s->scan.dir != NULL && i < SPOOL_STEP_NAMES; i++) {
        errno = 0;
        const struct dirent *entry = readdir(s->scan.dir);
        if (entry == NULL) {
            end_scan(s, errno);
            break;
        }
        candidate *file = find_or_add(s, entry->d_name);
        if (file != NULL && file->state == CANDIDATE_IGNORED)
            examine_file(s, file, WATCH_NONE);
    }
    return s->scan.dir != NULL;
}
