/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/acquire.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "spool/examine.h"
#include "spool/internal.h"
#include "spool/report.h"

#include <errno.h>
#include <string.h>

enum { RETRY_MS = 1000 }; /* after a file could not be acquired */

/* A file that was created here is announced when its writer closes it. Until then, not changing
 * means little: a writer may pause. But some files are complete when their name appears and are
 * never announced (linkat of an unnamed file), so the wait is limited. */
enum { BEGUN_PATIENCE = 12, BEGUN_LEAST_MS = 2000 };

static int64_t patience_ms(const spool *s, enum candidate_state state) {
    if (state == CANDIDATE_SETTLING)
        return s->tuning.settle_ms;
    const int64_t begun_ms = BEGUN_PATIENCE * s->tuning.settle_ms;
    return begun_ms > BEGUN_LEAST_MS ? begun_ms : BEGUN_LEAST_MS;
}

int64_t acquire_next_ms(const spool *s) {
    int64_t next_ms = INT64_MAX;
    for (enum candidate_state state = CANDIDATE_SETTLING; state <= CANDIDATE_BEGUN; state++) {
        const candidate *first = candidates_first(&s->candidates, state);
        const int64_t one_ms = first != NULL ? first->since_ms + patience_ms(s, state) : INT64_MAX;
        next_ms = one_ms < next_ms ? one_ms : next_ms;
    }
    return next_ms;
}

/* Look at a regular file again, and fill *st. Return false if it has changed: it is examined again
 * if it is no regular file now, and otherwise has to settle in `state`. */
static bool is_unchanged(spool *s, candidate *file,
                         bool (*same)(const file_fingerprint *, const file_fingerprint *),
                         enum candidate_state state, struct stat *st) {
    if (folder_stat(&s->folders, INCOMING, file->name, st) != 0 || !S_ISREG(st->st_mode)) {
        examine_file(s, file, WATCH_NONE);
        return false;
    }
    const file_fingerprint present = fingerprint_of(st);
    const bool unchanged = same(&file->fingerprint, &present);
    if (!unchanged)
        examine_settle(s, file, st, state);
    return unchanged;
}

bool acquire_settled(spool *s) {
    const int64_t now_ms = clock_ms(CLOCK_MONOTONIC);
    int left = SPOOL_STEP_NAMES;
    for (enum candidate_state state = CANDIDATE_SETTLING; state <= CANDIDATE_BEGUN; state++) {
        candidate *file = candidates_first(&s->candidates, state);
        for (; file != NULL && left > 0 && file->since_ms + patience_ms(s, state) <= now_ms;
             left--) {
            struct stat st;
            if (is_unchanged(s, file, fingerprint_same, state, &st))
                candidates_set_state(&s->candidates, file, CANDIDATE_READY);
            file = candidates_first(&s->candidates, state);
        }
    }
    return left == 0;
}

static void put_off(spool *s, candidate *file, int error) {
    if (s->acquire_error != error) {
        char name[NAME_SIZE];
        name_printable(name, file->name);
        report_line(s, SPOOL_ERROR, "incoming/%s: cannot be taken, tried again later: %s%s", name,
                    strerror(error),
                    error == EPERM || error == EACCES ? "; the service must own incoming/" : "");
        s->acquire_error = error;
    }
    report_trouble(s, "%s/incoming: files cannot be taken: %s", s->folders.path, strerror(error));
    file->since_ms = clock_ms(CLOCK_MONOTONIC) + RETRY_MS;
    candidates_set_state(&s->candidates, file, CANDIDATE_SETTLING);
}

/* Between the last check and the rename, another file may have got the name, or the file may have
 * been opened for writing. Then move it back, unless its name is taken again: acquiring it early is
 * better than losing it. */
static bool caught_the_wrong_one(spool *s, const candidate *file, const char *active_name) {
    struct stat st;
    if (folder_stat(&s->folders, ACTIVE, active_name, &st) != 0)
        return false;
    const file_fingerprint caught = fingerprint_of(&st);
    return !fingerprint_same_content(&file->fingerprint, &caught) &&
           folder_move(&s->folders, ACTIVE, active_name, INCOMING, file->name) == 0;
}

/* Move the file to active/ and list it. Return 0 or errno. */
static int move_to_active(spool *s, const candidate *file, char active_name[NAME_SIZE]) {
    TRY(name_make_active(active_name, file->name, s->counter++));
    if (!unacknowledged_add(&s->unacknowledged, active_name, false, false))
        return ENOMEM;
    const int error = folder_move(&s->folders, INCOMING, file->name, ACTIVE, active_name);
    if (error != 0)
        unacknowledged_remove(&s->unacknowledged, active_name);
    return error;
}

/* Acquire the file if it is still the one that was found ready; its mode and owner may have
 * changed. */
static void acquire(spool *s, candidate *file) {
    char active_name[NAME_SIZE];
    struct stat st;
    if (!is_unchanged(s, file, fingerprint_same_content, CANDIDATE_SETTLING, &st))
        return;
    file->fingerprint = fingerprint_of(&st);
    const int error = move_to_active(s, file, active_name);
    if (error != 0) {
        put_off(s, file, error);
        return;
    }
    s->unacknowledged.unsynced = true;
    if (caught_the_wrong_one(s, file, active_name)) {
        unacknowledged_remove(&s->unacknowledged, active_name);
        examine_file(s, file, WATCH_NONE);
        return;
    }
    candidates_remove(&s->candidates, file);
    s->acquire_error = 0;
    report_no_trouble(s);
    s->stats.taken++;
    s->stats.active++;
}

bool acquire_ready(spool *s) {
    if (s->away || unacknowledged_pending(&s->unacknowledged) ||
        candidates_first(&s->candidates, CANDIDATE_READY) == NULL) {
        return false;
    }
    int64_t left = s->call.capacity(s->call.context);
    const bool more = left > SPOOL_STEP_FILES;
    left = more ? SPOOL_STEP_FILES : left;
    for (; !s->closed && left > 0; left--) {
        candidate *file = candidates_first(&s->candidates, CANDIDATE_READY);
        if (file == NULL)
            return false;
        acquire(s, file);
    }
    return more && !s->closed && candidates_first(&s->candidates, CANDIDATE_READY) != NULL;
}
