/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From active/ to done/ or failed/.
 *
 * Two names are to appear, the report's and the file's, and no rename does both. So there is an
 * undo log, a symbolic link active/.ACTIVE_NAME.end -> done/NAME, while an ending is under way:
 *
 *     link;  report to active/.ACTIVE_NAME.tmp, fsync;  rename it to done/NAME.json, fsync of
 * done/; move the file;  fsync of both;  remove the link
 *
 * Where a link is found at the start and its file is still in active/, the report goes; where the
 * file has moved, only the link. The link itself needs no fsync: if the power fails and it is lost
 * but the report is not, there is a report too many, and no file is lost or overwritten. */
#include "spool/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct ending {
    const char *active_name;
    const char *name;
    int folder; /* DONE or FAILED */
    char target[NAME_SIZE];
    char report[NAME_SIZE];
    char temporary[NAME_SIZE];
} ending;

static const char undo_suffix[] = ".end";
static const char temporary_suffix[] = ".tmp";

static void join(char out[NAME_SIZE], const char *before, const char *name, const char *after) {
    /* Names are bounded so that this fits (names.h). */
    if (strlen(before) + strlen(name) + strlen(after) < NAME_SIZE) {
        stpcpy(stpcpy(stpcpy(out, before), name), after);
    }
}

static void remove_name(const folders *f, int folder, const char *name) {
    unlinkat(f->fd[folder], name, 0); /* gone, or seen by the next start */
}

/* ---- recovery ---- */

/* "done/NAME" -> folder and NAME; false where it is nothing of ours. */
static bool read_undo(const folders *f, const char *undo, int *folder, char name[NAME_SIZE]) {
    char text[NAME_SIZE + 8];
    const ssize_t n = readlinkat(f->fd[ACTIVE], undo, text, sizeof text);
    if (n <= 0 || n >= (ssize_t)sizeof text) {
        return false;
    }
    text[n] = '\0';
    for (*folder = DONE; *folder <= FAILED; (*folder)++) {
        const char *prefix = folder_name(*folder);
        const size_t m = strlen(prefix);
        if (strncmp(text, prefix, m) == 0 && text[m] == '/' && strlen(text + m + 1) < NAME_SIZE) {
            join(name, "", text + m + 1, "");
            return strchr(name, '/') == NULL;
        }
    }
    return false;
}

/* The active name in ".ACTIVE_NAME" SUFFIX; false where the file is none such. */
static bool strip(char out[NAME_SIZE], const char *name, const char *suffix) {
    const size_t n = strlen(name);
    const size_t m = strlen(suffix);
    if (name[0] != '.' || n <= m + 1 || strcmp(name + n - m, suffix) != 0) {
        return false;
    }
    snprintf(out, NAME_SIZE, "%.*s", (int)(n - m - 1), name + 1);
    return name_of_active(out) != NULL;
}

static int undo(const folders *f, const char *link, const char *active_name) {
    char name[NAME_SIZE];
    char report[NAME_SIZE];
    struct stat st;
    int folder = DONE;
    int error = folder_stat(f, ACTIVE, active_name, &st);
    if (error == 0 && read_undo(f, link, &folder, name)) {
        join(report, "", name, ".json");
        error = unlinkat(f->fd[folder], report, 0) == 0 || errno == ENOENT ? 0 : errno;
    }
    if (error != 0 && error != ENOENT) {
        return error;
    }
    return unlinkat(f->fd[ACTIVE], link, 0) == 0 ? 0 : errno;
}

int ending_recover(const folders *f, shear_error *err) {
    DIR *dir = folder_list(f, ACTIVE);
    const struct dirent *entry = NULL;
    char active_name[NAME_SIZE];
    int error = dir == NULL ? errno : 0;
    while (dir != NULL && error == 0) {
        errno = 0;
        entry = readdir(dir);
        if (entry == NULL) {
            error = errno;
            break;
        }
        if (strip(active_name, entry->d_name, undo_suffix)) {
            error = undo(f, entry->d_name, active_name);
        } else if (strip(active_name, entry->d_name, temporary_suffix)) {
            remove_name(f, ACTIVE, entry->d_name);
        }
    }
    if (dir != NULL) {
        closedir(dir);
    }
    return error == 0
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_IO, "see that the service may write there",
                            "%s/active: cannot be put in order: %s", f->path, strerror(error));
}

/* ---- the target's name ---- */

/* Is NAME.n or its report there? Returns 0 or errno. */
static int is_taken(const folders *f, const ending *e, int64_t n, bool *taken) {
    char name[NAME_SIZE];
    char report[NAME_SIZE];
    struct stat st;
    name_number(name, e->name, n);
    join(report, "", name, ".json");
    int error = folder_stat(f, e->folder, name, &st);
    if (error == ENOENT) {
        error = folder_stat(f, e->folder, report, &st);
    }
    *taken = error == 0;
    return error == ENOENT ? 0 : error;
}

/* A free number just above a taken one, or 0: in steps that double, then by halves, for some
 * observatories call every file the same. */
static int choose_target(const folders *f, ending *e) {
    int64_t below = -1;
    int64_t free_one = 0;
    bool taken = true;
    for (;;) {
        const int error = is_taken(f, e, free_one, &taken);
        if (error != 0) {
            return error;
        }
        if (!taken) {
            break;
        }
        below = free_one;
        free_one = 2 * free_one + 1;
    }
    while (free_one - below > 1) {
        const int64_t middle = below + (free_one - below) / 2;
        const int error = is_taken(f, e, middle, &taken);
        if (error != 0) {
            return error;
        }
        if (taken) {
            below = middle;
        } else {
            free_one = middle;
        }
    }
    name_number(e->target, e->name, free_one);
    join(e->report, "", e->target, ".json");
    return 0;
}

/* ---- the steps ---- */

static int write_all(int fd, const char *text) {
    size_t left = strlen(text);
    while (left > 0) {
        const ssize_t n = write(fd, text, left);
        if (n < 0 && errno != EINTR) {
            return errno;
        }
        text += n > 0 ? n : 0;
        left -= n > 0 ? (size_t)n : 0;
    }
    return 0;
}

static int write_report(const folders *f, const ending *e, const char *text) {
    const int fd = openat(f->fd[ACTIVE], e->temporary,
                          O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640);
    if (fd < 0) {
        return errno;
    }
    int error = write_all(fd, text);
    if (error == 0 && fsync(fd) != 0) {
        error = errno;
    }
    if (close(fd) != 0 && error == 0) {
        error = errno;
    }
    return error;
}

int ending_note(const folders *f, const char *active_name, int folder, const char *name) {
    char text[NAME_SIZE + 8];
    char link[NAME_SIZE];
    join(link, ".", active_name, undo_suffix);
    snprintf(text, sizeof text, "%s/%s", folder_name(folder), name);
    ending_forget(f, active_name); /* of an ending that could not even be undone */
    return symlinkat(text, f->fd[ACTIVE], link) == 0 ? 0 : errno;
}

void ending_forget(const folders *f, const char *active_name) {
    char link[NAME_SIZE];
    join(link, ".", active_name, undo_suffix);
    remove_name(f, ACTIVE, link);
}

/* Everything up to the move of the file; all undone where it fails. */
static int move_with_report(const folders *f, const ending *e, const char *text) {
    bool reported = false;
    int error = ending_note(f, e->active_name, e->folder, e->target);
    if (error == 0) {
        error = write_report(f, e, text);
    }
    if (error == 0) {
        error = folder_move(f, ACTIVE, e->temporary, e->folder, e->report);
        reported = error == 0;
    }
    if (error == 0) {
        error = folder_sync(f, e->folder);
    }
    if (error == 0) {
        error = folder_move(f, ACTIVE, e->active_name, e->folder, e->target);
    }
    if (error != 0) {
        if (reported) {
            remove_name(f, e->folder, e->report);
        }
        remove_name(f, ACTIVE, e->temporary);
        ending_forget(f, e->active_name);
    }
    return error;
}

int ending_sync(const folders *f, int folder) {
    const int error = folder_sync(f, folder);
    return error == 0 ? folder_sync(f, ACTIVE) : error;
}

static int end_file(spool *s, ending *e, const char *text, spool_place *place) {
    struct stat st;
    const folders *f = &s->folders;
    int error = folder_stat(f, ACTIVE, e->active_name, &st);
    if (error == ENOENT) {
        ending_forget(f, e->active_name);
        return ending_sync(f, e->folder);
    }
    if (error == 0) {
        error = choose_target(f, e);
    }
    if (error == 0) {
        error = move_with_report(f, e, text);
    }
    if (error != 0) {
        return error;
    }
    offers_drop(&s->offers, e->active_name);
    s->stats.active--;
    s->stats.done += e->folder == DONE;
    s->stats.failed += e->folder == FAILED;
    place_set(f, place, e->folder, e->target);
    error = ending_sync(f, e->folder);
    if (error == 0) {
        ending_forget(f, e->active_name);
    }
    return error;
}

int spool_dispose(spool *s, const char *active_name, bool good, const char *report,
                  spool_place *place, shear_error *err) {
    spool_place ignored;
    ending e = {.active_name = active_name,
                .name = name_of_active(active_name),
                .folder = good ? DONE : FAILED};
    if (e.name == NULL) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "'%.255s' is no name of the spool's",
                          active_name);
    }
    join(e.temporary, ".", active_name, temporary_suffix);
    place = place != NULL ? place : &ignored;
    *place = (spool_place){.name = ""};
    const int error = end_file(s, &e, report, place);
    if (error == 0) {
        return SHEAR_OK;
    }
    return shear_fail(err, SHEAR_E_IO,
                      error == ENOSPC || error == EDQUOT ? "make room on the spool's disk"
                                                         : "see that the spool's disk is sound",
                      "%s/active/%s: cannot be moved to %s/: %s", s->folders.path, active_name,
                      folder_name(e.folder), strerror(error));
}
