/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Move a file back from done/ or failed/ to active/. This uses the undo log of disposal.c: while
 * the log is there and the file is in active/, the next start removes the report. So:
 *
 *     write the undo log
 *     move the file and fsync both folders
 *     remove the report and fsync its folder
 *     remove the undo log and fsync active/
 *
 * Without the last fsync a power failure could bring back the log, when another file may be at
 * failed/NAME with a report of its own. */
#include "spool/internal.h"

#include "base/cleanup.h"
#include "spool/place.h"
#include "spool/undo_log.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static int check_same(const spool *s, enum folder folder, const char *name,
                      const spool_place *place, shear_error *err) {
    struct stat st;
    char fingerprint[SPOOL_FINGERPRINT_SIZE];
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
    place_fingerprint(&st, fingerprint);
    if (place->fingerprint[0] != '\0' && strcmp(fingerprint, place->fingerprint) != 0) {
        return shear_fail(err, SPOOL_REPLACED,
                          "put what is to be measured into incoming/, it becomes a new job",
                          "%s/%s: is not the file that was dropped: its size or its time has "
                          "changed since its job ended",
                          s->folders.path, place->name);
    }
    return SHEAR_OK;
}

/* The file is in active/: bring that to disk and remove its report. Return 0 or errno. */
static int remove_report(const folders *f, enum folder folder, const char *name) {
    char report[NAME_REPORT_SIZE];
    TRY(folder_sync_move(f, folder));
    name_report(report, name);
    return unlinkat(f->fd[folder], report, 0) == 0 || errno == ENOENT ? 0 : errno;
}

/* Move the file and remove its report. Return 0, or errno with the file where it was. */
static int move_back(const folders *f, const char *active_name, enum folder folder,
                     const char *name) {
    int error = undo_log_write(f, active_name, folder, name);
    if (error == 0)
        error = folder_move(f, folder, name, ACTIVE, active_name);
    if (error != 0) {
        undo_log_remove(f, active_name);
        return error;
    }
    error = remove_report(f, folder, name);
    if (error != 0) {
        /* If this fails, too, the file stays in active/, and the next start reports it. */
        if (folder_move(f, ACTIVE, active_name, folder, name) == 0)
            undo_log_remove(f, active_name);
        return error;
    }
    if (folder_sync(f, folder) == 0) {
        undo_log_remove(f, active_name);
        folder_sync(f, ACTIVE);
    }
    return 0;
}

int spool_restore(spool *s, const char *active_name, const spool_place *place, shear_error *err) {
    struct stat st;
    enum folder folder = DONE;
    const char *name = place_parse(place, &folder);
    if (name_of_active(active_name) == NULL)
        return name_fail_active(active_name, err);
    if (folder_stat(&s->folders, ACTIVE, active_name, &st) == 0)
        return SHEAR_OK;
    if (name == NULL) {
        return shear_fail(err, SPOOL_GONE,
                          "put the file into incoming/ again, it becomes a new job",
                          "%s: the file %s is in none of done/ and failed/", s->folders.path,
                          name_of_active(active_name));
    }
    TRY(check_same(s, folder, name, place, err));
    const int error = move_back(&s->folders, active_name, folder, name);
    if (error != 0) {
        return shear_fail(err, SHEAR_E_IO, "see that the spool's disk is sound and has room",
                          "%s/%s: cannot be moved to active/: %s", s->folders.path, place->name,
                          strerror(error));
    }
    s->stats.active++;
    return SHEAR_OK;
}
