/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/problem_notes.h: what failed lately and is tried again: told by status, doctor,
 * metrics and the live view as long as it lasts, and logged when it happens, but not too often. */
#ifndef SHEARD_SERVICE_PROBLEM_NOTES_H
#define SHEARD_SERVICE_PROBLEM_NOTES_H

#include <stdbool.h>
#include <stdint.h>

enum { PROBLEM_NOTES = 16 };

typedef struct problem_note {
    char about[16], code[40]; /* "" where the note is free */
    char message[320];        /* the last one */
    int64_t since_ms;         /* wall clock: it failed for the first time */
    int64_t until_ms;         /* steady clock: it is over if it has not failed again by then */
    int64_t count;
    int64_t burst_from_ms, burst, unlogged; /* of its lines in the log */
} problem_note;

typedef struct problem_notes {
    problem_note notes[PROBLEM_NOTES];
} problem_notes;

/* It failed, and it is over if it does not fail again in lasts_ms. */
void problem_note_add(problem_notes *all, const char *about, const char *code, int64_t lasts_ms,
                      const char *message);
/* May one more line about it be logged? Those that may not are counted, and the count follows. */
bool problem_note_may_log(problem_notes *all, const char *about, const char *code);
void problem_note_end(problem_notes *all, const char *about); /* whatever its code */
/* One that lasts; `code` NULL: any. NULL: there is none. */
const problem_note *problem_note_find(const problem_notes *all, const char *about,
                                      const char *code);
/* Once a second: log how many lines were left out. */
void problem_notes_tick(problem_notes *all);

#endif
