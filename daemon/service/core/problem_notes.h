/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/problem_notes.h: recent failures that are tried again: shown by status, doctor,
 * metrics and the live view while they last, and logged with a limited rate. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { PROBLEM_NOTES = 16 };

typedef struct problem_note {
    char about[16], code[40]; /* "": the note is free */
    char message[320];        /* of the latest failure */
    int64_t since_ms;         /* wall clock: the first failure */
    int64_t until_ms; /* steady clock: the problem is over if it does not fail again before */
    int64_t count;
    int64_t burst_from_ms, burst, unlogged; /* lines logged and suppressed in this burst */
} problem_note;

typedef struct problem_notes {
    problem_note notes[PROBLEM_NOTES];
} problem_notes;

/* Record a failure. The problem is over if it does not fail again within lasts_ms. */
void problem_note_add(problem_notes *all, const char *about, const char *code, int64_t lasts_ms,
                      const char *message);
/* Return true if one more line about the problem may be logged. Suppressed lines are counted, and
 * problem_notes_tick logs their number. */
bool problem_note_may_log(problem_notes *all, const char *about, const char *code);
void problem_note_end(problem_notes *all, const char *about); /* with any code */
/* Return a problem that lasts, or NULL. `code` NULL: any code. */
const problem_note *problem_note_find(const problem_notes *all, const char *about,
                                      const char *code);
/* Log the numbers of suppressed lines. Call once a second. */
void problem_notes_tick(problem_notes *all);
