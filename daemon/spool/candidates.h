/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/candidates.h: the files of incoming/ as they are known: by name, and in a queue for each
 * state. */
#ifndef SHEARD_SPOOL_CANDIDATES_H
#define SHEARD_SPOOL_CANDIDATES_H

#include "spool/fingerprint.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/queue.h>

enum candidate_state {
    CANDIDATE_SETTLING, /* to stand still for a while; queue by since_ms */
    CANDIDATE_BEGUN,    /* being written, it seems; queue by since_ms, too */
    CANDIDATE_READY,    /* queue by arrival here */
    CANDIDATE_IGNORED,
    CANDIDATE_N_STATES
};

typedef struct candidate {
    TAILQ_ENTRY(candidate) link;
    char *name;
    enum candidate_state state;
    int reason;          /* why it is ignored: the caller's number; 0: not told yet */
    uint64_t generation; /* the last scan that saw it */
    int64_t since_ms;    /* settling, begun: it has this fingerprint since then */
    file_fingerprint fingerprint;
} candidate;
TAILQ_HEAD(candidate_queue, candidate);

typedef struct candidates {
    candidate **files; /* [n] of [capacity], sorted by name */
    size_t n, capacity;
    struct candidate_queue queues[CANDIDATE_N_STATES];
    size_t counts[CANDIDATE_N_STATES];
} candidates;

void candidates_init(candidates *w);
void candidates_deinit(candidates *w);
candidate *candidates_find(const candidates *w, const char *name); /* or NULL */
/* A new one, ignored; the name is not yet there. NULL: out of memory. */
candidate *candidates_add(candidates *w, const char *name);
void candidates_remove(candidates *w, candidate *file);
void candidates_forget_unseen(candidates *w,
                              uint64_t generation); /* those that this scan did not see */
/* Put it at the end of that state's queue. */
void candidates_set_state(candidates *w, candidate *file, enum candidate_state state);
candidate *candidates_first(const candidates *w, enum candidate_state state); /* or NULL */
candidate *candidates_next(const candidate *file); /* of the same state; or NULL */

#endif
