/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/problem_notes.h"

#include "log/log.h"
#include "service/core/clock.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* At most BURST lines about one problem in burst_ms. */
enum { BURST = 5 };
static const int64_t burst_ms = 30000;

static bool is_of(const problem_note *note, const char *about, const char *code) {
    return strcmp(note->about, about) == 0 && (code == NULL || strcmp(note->code, code) == 0);
}

/* Return the problem's own note; if there is none, the one that is over or will be over first. */
static problem_note *choose(problem_notes *all, const char *about, const char *code) {
    problem_note *first = &all->notes[0];
    for (size_t i = 0; i < PROBLEM_NOTES; i++) {
        problem_note *at = &all->notes[i];
        if (is_of(at, about, code))
            return at;
        first = at->until_ms < first->until_ms ? at : first;
    }
    return first;
}

void problem_note_add(problem_notes *all, const char *about, const char *code, int64_t lasts_ms,
                      const char *message) {
    const int64_t now = clock_steady_ms();
    problem_note *note = choose(all, about, code);
    if (!is_of(note, about, code) || note->until_ms <= now) {
        *note = (problem_note){.since_ms = clock_wall_ms(), .burst_from_ms = now};
        snprintf(note->about, sizeof note->about, "%s", about);
        snprintf(note->code, sizeof note->code, "%s", code);
    }
    note->until_ms = lasts_ms < INT64_MAX - now ? now + lasts_ms : INT64_MAX;
    note->count++;
    snprintf(note->message, sizeof note->message, "%s", message);
}

bool problem_note_may_log(problem_notes *all, const char *about, const char *code) {
    const int64_t now = clock_steady_ms();
    problem_note *note = choose(all, about, code);
    if (now - note->burst_from_ms >= burst_ms) {
        note->burst_from_ms = now;
        note->burst = 0;
    }
    const bool may = note->burst < BURST;
    note->burst += may;
    note->unlogged += !may;
    return may;
}

static bool lasts(const problem_note *note) {
    return note->until_ms > clock_steady_ms();
}

const problem_note *problem_note_find(const problem_notes *all, const char *about,
                                      const char *code) {
    for (size_t i = 0; i < PROBLEM_NOTES; i++) {
        if (lasts(&all->notes[i]) && is_of(&all->notes[i], about, code))
            return &all->notes[i];
    }
    return NULL;
}

void problem_note_end(problem_notes *all, const char *about) {
    for (size_t i = 0; i < PROBLEM_NOTES; i++) {
        if (lasts(&all->notes[i]) && is_of(&all->notes[i], about, NULL))
            all->notes[i] = (problem_note){0};
    }
}

void problem_notes_tick(problem_notes *all) {
    const int64_t now = clock_steady_ms();
    for (size_t i = 0; i < PROBLEM_NOTES; i++) {
        problem_note *note = &all->notes[i];
        if (note->unlogged > 0 && now - note->burst_from_ms >= burst_ms) {
            log_warning("%" PRId64 " times more, %s: %s: %s", note->unlogged, note->about,
                        note->code, note->message);
            note->unlogged = 0;
        }
    }
}
