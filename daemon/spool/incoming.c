/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From incoming/ to active/. */
#include "spool/internal.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Reasons to ignore a file: name verdicts, and these. */
enum { IS_LINK = NAME_N_VERDICTS, IS_DIRECTORY, IS_PIPE, IS_OTHER, UNREADABLE, N_REASONS };

/* What it is, where it is no regular file. */
static int kind_of(mode_t mode) {
    return S_ISLNK(mode)    ? IS_LINK
           : S_ISDIR(mode)  ? IS_DIRECTORY
           : S_ISFIFO(mode) ? IS_PIPE
                            : IS_OTHER;
}

static const char *reason_text(int reason) {
    static const char *const texts[N_REASONS] = {
        [IS_LINK] = "it is a symbolic link; put the file itself there",
        [IS_DIRECTORY] = "it is a directory; put its files there",
        [IS_PIPE] = "it is a named pipe",
        [IS_OTHER] = "it is no regular file",
        [UNREADABLE] = "it cannot be examined",
    };
    return reason >= 0 && reason < N_REASONS && texts[reason] != NULL ? texts[reason] : "";
}

enum { NO_EVENT = -1 }; /* beside enum watch_event: a scan found it */

enum { RETRY_MS = 1000 }; /* after a file could not be taken */

/* Who made a file here closes it one day, and then it is announced. That it stands still tells
 * little before: a writer may pause. But some files are complete when their name appears, and never
 * announced (linkat of an unnamed file), so it is given up after a while. */
enum { BEGUN_PATIENCE = 12, BEGUN_LEAST_MS = 2000 };

static void ignore(spool *s, waiting_file *file, int reason) {
    if (file->state != WAITING_IGNORED) {
        waiting_set(&s->waiting, file, WAITING_IGNORED);
    }
    if (file->reason == reason) {
        return;
    }
    char name[NAME_SIZE];
    name_printable(name, file->name);
    file->reason = reason;
    if (reason < NAME_N_VERDICTS) {
        spool_log(s, SPOOL_NOTICE, "incoming/%s: ignored: its name %s", name,
                  name_complaint(reason));
    } else {
        spool_log(s, SPOOL_NOTICE, "incoming/%s: ignored: %s", name, reason_text(reason));
    }
}

size_t spool_get_ignored(const spool *s, spool_ignored *list, size_t room) {
    size_t n = 0;
    for (const waiting_file *file = waiting_first(&s->waiting, WAITING_IGNORED);
         file != NULL && n < room; file = waiting_next(file)) {
        spool_ignored *one = &list[n];
        if (file->reason == NAME_GOOD) {
            continue; /* not looked at yet */
        }
        one->name = file->name;
        snprintf(one->reason, sizeof one->reason, "%s%s",
                 file->reason < NAME_N_VERDICTS ? "its name " : "",
                 file->reason < NAME_N_VERDICTS ? name_complaint(file->reason)
                                                : reason_text(file->reason));
        n++;
    }
    return n;
}

/* What keeps files from being taken, for those who ask (spool_get_stats). */
static void __attribute__((format(printf, 2, 3))) note_trouble(spool *s, const char *format, ...) {
    va_list list;
    if (s->trouble[0] == '\0') {
        s->trouble_since_ms = s->call.now_ms(s->call.context);
    }
    va_start(list, format);
    vsnprintf(s->trouble, sizeof s->trouble, format, list);
    va_end(list);
}

/* It has this print from now on. */
static void settle(spool *s, waiting_file *file, const struct stat *st, int state) {
    file->print = waiting_print_of(st);
    file->since_ms = spool_clock_ms();
    file->reason = NAME_GOOD;
    waiting_set(&s->waiting, file, state);
}

/* What follows from an event for a regular file. A second link is no file under construction; an
 * announced file that is empty may only be a name that somebody has reserved. */
static int state_after(int event, const struct stat *st) {
    if (event == WATCH_BEGUN && st->st_nlink == 1) {
        return WAITING_BEGUN;
    }
    return event == WATCH_COMPLETE && st->st_size > 0 ? WAITING_READY : WAITING_SETTLING;
}

/* Look at it anew. */
static void examine(spool *s, waiting_file *file, int event) {
    struct stat st;
    const int verdict = name_judge(file->name);
    const int error = folder_stat(&s->folders, INCOMING, file->name, &st);
    if (error == ENOENT) {
        waiting_remove(&s->waiting, file);
    } else if (verdict != NAME_GOOD) {
        ignore(s, file, verdict);
    } else if (error != 0 || !S_ISREG(st.st_mode)) {
        ignore(s, file, error != 0 ? UNREADABLE : kind_of(st.st_mode));
    } else {
        settle(s, file, &st, state_after(event, &st));
    }
}

/* NULL where it is passed over, or memory is out: then a later scan finds it. */
static waiting_file *find_or_add(spool *s, const char *name) {
    waiting_file *file = NULL;
    if (name_judge(name) != NAME_QUIET) {
        file = waiting_find(&s->waiting, name);
        file = file != NULL ? file : waiting_add(&s->waiting, name);
    }
    if (file != NULL) {
        file->generation = s->scan.generation;
    }
    return file;
}

static void lost_watch(spool *s) {
    spool_log(s, SPOOL_WARNING, "%s/incoming: was removed, renamed or unmounted; looking for it",
              s->folders.path);
    s->stats.watching = false;
    s->scan.next_ms = spool_clock_ms();
}

void incoming_event(spool *s, int event, const char *name) {
    if (event == WATCH_OVERFLOW) {
        spool_log(s, SPOOL_NOTICE, "%s/incoming: too many events at once; searching it",
                  s->folders.path);
        s->scan.next_ms = spool_clock_ms();
        return;
    }
    if (event == WATCH_LOST) {
        lost_watch(s);
        return;
    }
    waiting_file *file =
        event == WATCH_GONE ? waiting_find(&s->waiting, name) : find_or_add(s, name);
    if (file != NULL) {
        examine(s, file, event);
    }
}

/* ---- scans ---- */

static void watch_anew(spool *s) {
    if (s->watch.fd < 0) {
        return; /* told by spool_open */
    }
    const int error = watch_start(&s->watch, s->folders.fd[INCOMING], s->folders.root);
    s->stats.watching = error == 0;
    if (error != 0) {
        spool_log(s, SPOOL_WARNING, "%s/incoming: cannot be watched, scans alone find files: %s%s",
                  s->folders.path, strerror(error),
                  error == ENOSPC ? "; raise fs.inotify.max_user_watches" : "");
    }
}

/* False where the spool is not there. The watch comes before the scan: nothing falls between. */
static bool look_for_folders(spool *s) {
    bool changed = false;
    shear_error err = {0};
    const int code = folders_check(&s->folders, &changed, &err);
    if (code != SHEAR_OK) {
        if (!s->away) {
            spool_log(s, SPOOL_ERROR, "%s; no file is taken meanwhile (%s)", err.message,
                      err.advice);
        }
        s->away = true;
        note_trouble(s, "%s", err.message);
        return false;
    }
    if (s->away || changed) {
        spool_log(s, SPOOL_NOTICE, "%s: is there again", s->folders.path);
    }
    s->away = false;
    if (s->take_error == 0) {
        s->trouble[0] = '\0';
    }
    if (changed || !s->stats.watching) {
        watch_anew(s);
    }
    return true;
}

bool incoming_begin_scan(spool *s) {
    s->scan.next_ms = spool_clock_ms() + s->tuning.scan_ms;
    if (!look_for_folders(s)) {
        return false;
    }
    s->scan.dir = folder_list(&s->folders, INCOMING);
    if (s->scan.dir == NULL) {
        spool_log(s, SPOOL_ERROR, "%s/incoming: cannot be searched: %s", s->folders.path,
                  strerror(errno));
        note_trouble(s, "%s/incoming cannot be searched: %s", s->folders.path, strerror(errno));
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
        waiting_forget_others(&s->waiting, s->scan.generation);
    } else {
        spool_log(s, SPOOL_ERROR, "%s/incoming: cannot be searched: %s", s->folders.path,
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
        waiting_file *file = find_or_add(s, entry->d_name);
        if (file != NULL && file->state == WAITING_IGNORED) {
            examine(s, file, NO_EVENT);
        }
    }
    return s->scan.dir != NULL;
}

/* ---- taking ---- */

static int64_t patience_ms(const spool *s, int state) {
    if (state == WAITING_SETTLING) {
        return s->tuning.settle_ms;
    }
    const int64_t begun_ms = BEGUN_PATIENCE * s->tuning.settle_ms;
    return begun_ms > BEGUN_LEAST_MS ? begun_ms : BEGUN_LEAST_MS;
}

int64_t incoming_next_ms(const spool *s) {
    int64_t next_ms = INT64_MAX;
    for (int state = WAITING_SETTLING; state <= WAITING_BEGUN; state++) {
        const waiting_file *first = waiting_first(&s->waiting, state);
        const int64_t one_ms = first != NULL ? first->since_ms + patience_ms(s, state) : INT64_MAX;
        next_ms = one_ms < next_ms ? one_ms : next_ms;
    }
    return next_ms;
}

/* It has had its time: has it stood still? */
static void judge(spool *s, waiting_file *file) {
    struct stat st;
    if (folder_stat(&s->folders, INCOMING, file->name, &st) != 0 || !S_ISREG(st.st_mode)) {
        examine(s, file, NO_EVENT);
        return;
    }
    const waiting_print present = waiting_print_of(&st);
    if (waiting_same(&file->print, &present)) {
        waiting_set(&s->waiting, file, WAITING_READY);
    } else {
        settle(s, file, &st, file->state);
    }
}

bool incoming_settle(spool *s) {
    const int64_t now_ms = spool_clock_ms();
    int left = SPOOL_STEP_NAMES;
    for (int state = WAITING_SETTLING; state <= WAITING_BEGUN; state++) {
        waiting_file *file = waiting_first(&s->waiting, state);
        for (; file != NULL && left > 0 && file->since_ms + patience_ms(s, state) <= now_ms;
             left--) {
            judge(s, file);
            file = waiting_first(&s->waiting, state);
        }
    }
    return left == 0;
}

static void put_off(spool *s, waiting_file *file, int error) {
    if (s->take_error != error) {
        char name[NAME_SIZE];
        name_printable(name, file->name);
        spool_log(s, SPOOL_ERROR, "incoming/%s: cannot be taken, tried again later: %s%s", name,
                  strerror(error),
                  error == EPERM || error == EACCES ? "; the service must own incoming/" : "");
        s->take_error = error;
    }
    note_trouble(s, "%s/incoming: files cannot be taken: %s", s->folders.path, strerror(error));
    file->since_ms = spool_clock_ms() + RETRY_MS;
    waiting_set(&s->waiting, file, WAITING_SETTLING);
}

/* Between the last look and the rename, somebody may have put another file there, or have begun to
 * write to it. Then it goes back, unless the name is taken again: better early than lost. */
static bool caught_the_wrong_one(spool *s, const waiting_file *file, const char *active_name) {
    struct stat st;
    if (folder_stat(&s->folders, ACTIVE, active_name, &st) != 0) {
        return false;
    }
    const waiting_print caught = waiting_print_of(&st);
    return !waiting_same_content(&file->print, &caught) &&
           folder_move(&s->folders, ACTIVE, active_name, INCOMING, file->name) == 0;
}

static void take(spool *s, waiting_file *file, const struct stat *st) {
    char active_name[NAME_SIZE];
    file->print = waiting_print_of(st);
    int error = name_make_active(active_name, file->name, s->counter++);
    if (error == 0 && !offers_add(&s->offers, active_name, false, false)) {
        error = ENOMEM;
    }
    if (error == 0) {
        error = folder_move(&s->folders, INCOMING, file->name, ACTIVE, active_name);
        if (error != 0) {
            offers_drop(&s->offers, active_name);
        }
    }
    if (error != 0) {
        put_off(s, file, error);
        return;
    }
    s->offers.unsynced = true;
    if (caught_the_wrong_one(s, file, active_name)) {
        offers_drop(&s->offers, active_name);
        examine(s, file, NO_EVENT);
        return;
    }
    waiting_remove(&s->waiting, file);
    s->take_error = 0;
    s->trouble[0] = '\0';
    s->stats.taken++;
    s->stats.active++;
}

/* Still what was found ready? Its mode or owner may have changed. */
static void take_if_unchanged(spool *s, waiting_file *file) {
    struct stat st;
    if (folder_stat(&s->folders, INCOMING, file->name, &st) != 0 || !S_ISREG(st.st_mode)) {
        examine(s, file, NO_EVENT);
        return;
    }
    const waiting_print present = waiting_print_of(&st);
    if (waiting_same_content(&file->print, &present)) {
        take(s, file, &st);
    } else {
        settle(s, file, &st, WAITING_SETTLING);
    }
}

bool incoming_take(spool *s) {
    if (s->away || offers_pending(&s->offers) ||
        waiting_first(&s->waiting, WAITING_READY) == NULL) {
        return false;
    }
    int64_t room = s->call.capacity(s->call.context);
    const bool more = room > SPOOL_STEP_FILES;
    room = more ? SPOOL_STEP_FILES : room;
    for (; !s->closed && room > 0; room--) {
        waiting_file *file = waiting_first(&s->waiting, WAITING_READY);
        if (file == NULL) {
            return false;
        }
        take_if_unchanged(s, file);
    }
    return more && !s->closed && waiting_first(&s->waiting, WAITING_READY) != NULL;
}
