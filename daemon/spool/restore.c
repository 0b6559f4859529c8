/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where an ended file lies, and its way back from done/ or failed/ to active/.
 *
 * The way back uses the undo log of the way out (ending.c): while the link active/.ACTIVE_NAME.end
 * -> failed/NAME is there and the file is in active/, the next start removes the report. So:
 *
 *     link;  move the file;  fsync of both;  remove the report, fsync;  remove the link, fsync
 *
 * The last fsync keeps a link that is gone from coming back with the power: by then another file
 * may lie at failed/NAME, with a report of its own. */
#include "spool/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The file's size and time of change: they go with it through renames and copies that keep times.
 */
static void print_of(const struct stat *st, char out[SPOOL_FINGERPRINT_SIZE]) {
    snprintf(out, SPOOL_FINGERPRINT_SIZE, "%" PRId64 " %" PRId64 ".%09ld", (int64_t)st->st_size,
             (int64_t)st->st_mtim.tv_sec, st->st_mtim.tv_nsec);
}

void place_set(const folders *f, spool_place *place, int folder, const char *name) {
    struct stat st;
    *place = (spool_place){.name = ""};
    if (folder_stat(f, folder, name, &st) == 0) {
        snprintf(place->name, sizeof place->name, "%s/%.255s", folder_name(folder), name);
        print_of(&st, place->fingerprint);
    }
}

/* "failed/NAME" -> folder and NAME; NULL where it is no place of ours. */
static const char *read_place(const spool_place *place, int *folder) {
    for (*folder = DONE; *folder <= FAILED; (*folder)++) {
        const size_t n = strlen(folder_name(*folder));
        const char *name = place->name + n + 1;
        if (strncmp(place->name, folder_name(*folder), n) == 0 && place->name[n] == '/' &&
            name_judge(name) == NAME_GOOD) {
            return name;
        }
    }
    return NULL;
}

const char *spool_locate(const spool *s, const char *active_name, const spool_place *place,
                         char buffer[SPOOL_PLACE_SIZE]) {
    struct stat st;
    int folder = 0;
    if (name_of_active(active_name) != NULL &&
        folder_stat(&s->folders, ACTIVE, active_name, &st) == 0) {
        snprintf(buffer, SPOOL_PLACE_SIZE, "%s/%.255s", folder_name(ACTIVE), active_name);
        return buffer;
    }
    const char *name = read_place(place, &folder);
    return name != NULL && folder_stat(&s->folders, folder, name, &st) == 0 ? place->name : NULL;
}

/* ---- finding ---- */

static bool has_key(const folders *f, int folder, const char *report, const char *key) {
    enum { REPORT_MAX = 1 << 20 };
    const int fd =
        openat(f->fd[folder], report, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    char *text = fd >= 0 ? malloc(REPORT_MAX) : NULL;
    size_t n = 0;
    ssize_t got = text != NULL ? 1 : 0;
    while (got > 0 && n < REPORT_MAX) {
        got = read(fd, text + n, REPORT_MAX - n);
        n += got > 0 ? (size_t)got : 0;
    }
    const bool found = text != NULL && memmem(text, n, key, strlen(key)) != NULL;
    free(text);
    if (fd >= 0) {
        close(fd);
    }
    return found;
}

void spool_find_place(const spool *s, const char *active_name, int names, spool_place *place) {
    const char *name = name_of_active(active_name);
    char key[SPOOL_KEY_SIZE];
    *place = (spool_place){.name = ""};
    if (name == NULL) {
        return;
    }
    name_key(key, active_name);
    for (int64_t n = 0; n < names; n++) {
        char one[NAME_SIZE];
        char report[NAME_SIZE + 8];
        name_number(one, name, n);
        snprintf(report, sizeof report, "%s.json", one);
        for (int folder = DONE; folder <= FAILED; folder++) {
            if (has_key(&s->folders, folder, report, key)) {
                place_set(&s->folders, place, folder, one);
                return;
            }
        }
    }
}

/* ---- the way back ---- */

static int check_same(const spool *s, int folder, const char *name, const spool_place *place,
                      shear_error *err) {
    struct stat st;
    char print[SPOOL_FINGERPRINT_SIZE];
    const int error = folder_stat(&s->folders, folder, name, &st);
    if (error != 0) {
        return shear_fail(err, error == ENOENT ? SPOOL_GONE : SHEAR_E_IO,
                          "put the file into incoming/ again, it becomes a new job", "%s/%s: %s",
                          s->folders.path, place->name,
                          error == ENOENT ? "is not there any more" : strerror(error));
    }
    if (!S_ISREG(st.st_mode)) {
        return shear_fail(err, SPOOL_NOT_REGULAR,
                          "put the file into incoming/ again, it becomes a new job",
                          "%s/%s: is no regular file", s->folders.path, place->name);
    }
    print_of(&st, print);
    if (place->fingerprint[0] != '\0' && strcmp(print, place->fingerprint) != 0) {
        return shear_fail(err, SPOOL_REPLACED,
                          "put what is to be measured into incoming/, it becomes a new job",
                          "%s/%s: is not the file that was dropped: its size or its time has "
                          "changed since its job ended",
                          s->folders.path, place->name);
    }
    return SHEAR_OK;
}

/* Returns 0 or errno; then the file is where it was. */
static int move_back(const folders *f, const char *active_name, int folder, const char *name) {
    char report[NAME_SIZE + 8];
    snprintf(report, sizeof report, "%s.json", name);
    int error = ending_note(f, active_name, folder, name);
    if (error == 0) {
        error = folder_move(f, folder, name, ACTIVE, active_name);
    }
    if (error != 0) {
        ending_forget(f, active_name);
        return error;
    }
    error = ending_sync(f, folder);
    if (error == 0 && unlinkat(f->fd[folder], report, 0) != 0 && errno != ENOENT) {
        error = errno;
    }
    if (error != 0) {
        /* Where that fails, too, it stays in active/, and the next start tells of it. */
        if (folder_move(f, ACTIVE, active_name, folder, name) == 0) {
            ending_forget(f, active_name);
        }
        return error;
    }
    if (folder_sync(f, folder) == 0) {
        ending_forget(f, active_name);
        folder_sync(f, ACTIVE);
    }
    return 0;
}

int spool_restore(spool *s, const char *active_name, const spool_place *place, shear_error *err) {
    struct stat st;
    int folder = 0;
    const char *name = read_place(place, &folder);
    if (name_of_active(active_name) == NULL) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "'%.255s' is no name of the spool's",
                          active_name);
    }
    if (folder_stat(&s->folders, ACTIVE, active_name, &st) == 0) {
        return SHEAR_OK;
    }
    if (name == NULL) {
        return shear_fail(err, SPOOL_GONE,
                          "put the file into incoming/ again, it becomes a new job",
                          "%s: the file %s is in none of done/ and failed/", s->folders.path,
                          name_of_active(active_name));
    }
    const int code = check_same(s, folder, name, place, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const int error = move_back(&s->folders, active_name, folder, name);
    if (error != 0) {
        return shear_fail(err, SHEAR_E_IO, "see that the spool's disk is sound and has room",
                          "%s/%s: cannot be moved to active/: %s", s->folders.path, place->name,
                          strerror(error));
    }
    s->stats.active++;
    return SHEAR_OK;
}
