/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/examine.h"

#include "base/clock.h"
#include "base/text.h"
#include "spool/internal.h"
#include "spool/report.h"

#include <assert.h>
#include <errno.h>

/* Reasons to ignore a file: the status of its name, or one of these. */
enum reason { IS_LINK = NAME_N_STATUSES, IS_DIRECTORY, IS_PIPE, IS_OTHER, UNREADABLE, N_REASONS };

/* Return the kind of a file that is not a regular one. */
static enum reason kind_of(mode_t mode) {
    return S_ISLNK(mode)    ? IS_LINK
           : S_ISDIR(mode)  ? IS_DIRECTORY
           : S_ISFIFO(mode) ? IS_PIPE
                            : IS_OTHER;
}

static const char *reason_text(int reason) {
    static const char *const texts[N_REASONS] = {
        [NAME_SUFFIX] = "its name ends neither in .fits, .fit, .fits.gz, .fit.gz, .fz nor .json",
        [NAME_CONTROL] = "its name has control characters",
        [NAME_NOT_UTF8] = "its name is not UTF-8",
        [NAME_LONG] = "its name is too long",
        [IS_LINK] = "it is a symbolic link; put the file itself there",
        [IS_DIRECTORY] = "it is a directory; put its files there",
        [IS_PIPE] = "it is a named pipe",
        [IS_OTHER] = "it is no regular file",
        [UNREADABLE] = "it cannot be examined",
    };
    assert(reason > NAME_QUIET && reason < N_REASONS);
    return texts[reason];
}

static void ignore(spool *s, candidate *file, int reason) {
    if (file->state != CANDIDATE_IGNORED)
        candidates_set_state(&s->candidates, file, CANDIDATE_IGNORED);
    if (file->reason == reason)
        return;
    char name[NAME_SIZE];
    name_printable(name, file->name);
    file->reason = reason;
    report_line(s, SPOOL_NOTICE, "incoming/%s: ignored: %s", name, reason_text(reason));
}

size_t spool_get_ignored(const spool *s, spool_ignored *list, size_t capacity) {
    size_t n = 0;
    for (const candidate *file = candidates_first(&s->candidates, CANDIDATE_IGNORED);
         file != NULL && n < capacity; file = candidates_next(file)) {
        if (file->reason == NAME_GOOD) {
            continue; /* not examined yet */
        }
        spool_ignored *one = &list[n++];
        one->name = file->name;
        text_set(one->reason, sizeof one->reason, reason_text(file->reason));
    }
    return n;
}

void examine_settle(spool *s, candidate *file, const struct stat *st, enum candidate_state state) {
    file->fingerprint = fingerprint_of(st);
    file->since_ms = clock_ms(CLOCK_MONOTONIC);
    file->reason = NAME_GOOD;
    candidates_set_state(&s->candidates, file, state);
}

/* Return the state of a regular file after an event. A second link is not a file being written; an
 * announced file that is empty may be a name that somebody has reserved. */
static enum candidate_state state_after(enum watch_event event, const struct stat *st) {
    if (event == WATCH_BEGUN && st->st_nlink == 1)
        return CANDIDATE_BEGUN;
    return event == WATCH_COMPLETE && st->st_size > 0 ? CANDIDATE_READY : CANDIDATE_SETTLING;
}

void examine_file(spool *s, candidate *file, enum watch_event event) {
    struct stat st;
    const enum name_status status = name_validate(file->name);
    const int error = folder_stat(&s->folders, INCOMING, file->name, &st);
    if (error == ENOENT) {
        candidates_remove(&s->candidates, file);
    } else if (status != NAME_GOOD) {
        ignore(s, file, (int)status);
    } else if (error != 0 || !S_ISREG(st.st_mode)) {
        ignore(s, file, (int)(error != 0 ? UNREADABLE : kind_of(st.st_mode)));
    } else {
        examine_settle(s, file, &st, state_after(event, &st));
    }
}
