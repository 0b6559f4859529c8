/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/undo_log.h"

#include "base/cleanup.h"
#include "base/text.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char undo_suffix[] = ".end";
static const char temporary_suffix[] = ".tmp";

/* Make ".ACTIVE_NAME" SUFFIX, which fits because names are limited (names.h). */
static void join(char out[NAME_SIZE], const char *active_name, const char *suffix) {
    const int n = snprintf(out, NAME_SIZE, ".%s%s", active_name, suffix);
    assert(n > 0 && n < NAME_SIZE);
    (void)n;
}

void undo_log_temporary(char out[NAME_SIZE], const char *active_name) {
    join(out, active_name, temporary_suffix);
}

/* ---- recovery ---- */

/* Read the link: set *folder and `name` from "done/NAME". Return false if it is not a link of the
 * service. */
static bool read_link(const folders *f, const char *link, enum folder *folder,
                      char name[NAME_SIZE]) {
    char text[NAME_SIZE + 8];
    const ssize_t n = readlinkat(f->fd[ACTIVE], link, text, sizeof text);
    if (n <= 0 || n >= (ssize_t)sizeof text)
        return false;
    text[n] = '\0';
    const char *target = folder_of_place(text, folder);
    return target != NULL && strchr(target, '/') == NULL && text_set(name, NAME_SIZE, target);
}

/* Extract the active name from ".ACTIVE_NAME" SUFFIX. Return false if the name has another form. */
static bool strip(char out[NAME_SIZE], const char *name, const char *suffix) {
    const size_t n = strlen(name);
    const size_t m = strlen(suffix);
    if (name[0] != '.' || n <= m + 1 || strcmp(name + n - m, suffix) != 0)
        return false;
    snprintf(out, NAME_SIZE, "%.*s", (int)(n - m - 1), name + 1);
    return name_of_active(out) != NULL;
}

static int undo(const folders *f, const char *link, const char *active_name) {
    char name[NAME_SIZE];
    char report[NAME_REPORT_SIZE];
    struct stat st;
    enum folder folder = DONE;
    const int error = folder_stat(f, ACTIVE, active_name, &st);
    if (error != 0 && error != ENOENT)
        return error;
    if (error == 0 && read_link(f, link, &folder, name)) {
        name_report(report, name);
        if (unlinkat(f->fd[folder], report, 0) != 0 && errno != ENOENT)
            return errno;
    }
    return unlinkat(f->fd[ACTIVE], link, 0) == 0 ? 0 : errno;
}

/* Undo one move. Return 0 or errno. */
static int recover_one(const folders *f, const char *name) {
    char active_name[NAME_SIZE];
    if (strip(active_name, name, undo_suffix))
        return undo(f, name, active_name);
    if (strip(active_name, name, temporary_suffix)) {
        unlinkat(f->fd[ACTIVE], name, 0); /* if this fails, the next start tries again */
    }
    return 0;
}

static int recover_all(const folders *f) {
    CLEANUP(folder_list_close) DIR *dir = folder_list(f, ACTIVE);
    if (dir == NULL)
        return errno;
    for (;;) {
        errno = 0;
        const struct dirent *entry = readdir(dir);
        if (entry == NULL)
            return errno;
        TRY(recover_one(f, entry->d_name));
    }
}

int undo_log_recover(const folders *f, shear_error *err) {
    const int error = recover_all(f);
    return error == 0
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_IO, "see that the service may write there",
                            "%s/active: cannot be put in order: %s", f->path, strerror(error));
}

/* ---- the link ---- */

int undo_log_write(const folders *f, const char *active_name, enum folder folder,
                   const char *name) {
    char text[NAME_SIZE + 8];
    char link[NAME_SIZE];
    join(link, active_name, undo_suffix);
    snprintf(text, sizeof text, "%s/%s", folder_name(folder), name);
    unlinkat(f->fd[ACTIVE], link, 0); /* left by a disposal that could not be undone */
    return symlinkat(text, f->fd[ACTIVE], link) == 0 ? 0 : errno;
}

void undo_log_remove(const folders *f, const char *active_name) {
    char link[NAME_SIZE];
    join(link, active_name, undo_suffix);
    unlinkat(f->fd[ACTIVE], link, 0); /* if this fails, the next start removes it */
}
