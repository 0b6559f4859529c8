/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/candidates.h: the known files of incoming/, by name, and in a queue for each state. */
#pragma once

#include "base/fingerprint.h"

#include <stddef.h>
#include <stdint.h>
#include <sys/queue.h>

enum candidate_state {
    CANDIDATE_SETTLING, /* must not change for a while; queue in the order of since_ms */
    CANDIDATE_BEGUN,    /* probably being written; queue in the order of since_ms, too */
    CANDIDATE_READY,    /* queue in the order of becoming ready */
    CANDIDATE_IGNORED,
    CANDIDATE_N_STATES
};

typedef struct candidate {
    TAILQ_ENTRY(candidate) link;
    char *name;
    enum candidate_state state;
    int reason;          /* why it is ignored (examine.c); 0: not reported yet */
    uint64_t generation; /* of the last scan that found it */
    int64_t since_ms;    /* settling, begun: since when it has this fingerprint */
    file_fingerprint fingerprint;
} candidate;
TAILQ_HEAD(candidate_queue, candidate);

typedef struct candidates {
    void *by_name; /* a tree of candidates: tsearch(3) */
    struct candidate_queue queues[CANDIDATE_N_STATES];
    size_t counts[CANDIDATE_N_STATES];
} candidates;

void candidates_init(candidates *w);
void candidates_deinit(candidates *w);
candidate *candidates_find(const candidates *w, const char *name); /* NULL: not found */
/* Add a file, ignored; the name must not be there yet. Return NULL if out of memory. */
candidate *candidates_add(candidates *w, const char *name);
void candidates_remove(candidates *w, candidate *file);
/* Remove the records of all files that the scan with this generation did not find. */
void candidates_forget_unseen(candidates *w, uint64_t generation);
/* Move the file to the end of the queue of that state. */
void candidates_set_state(candidates *w, candidate *file, enum candidate_state state);
candidate *candidates_first(const candidates *w, enum candidate_state state); /* NULL: none */
candidate *candidates_next(const candidate *file); /* of the same state; NULL: none */
