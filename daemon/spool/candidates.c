/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/candidates.h"

#include <search.h>
#include <stdlib.h>
#include <string.h>

void candidates_init(candidates *w) {
    *w = (candidates){0};
    for (int i = 0; i < CANDIDATE_N_STATES; i++)
        TAILQ_INIT(&w->queues[i]);
}

static int compare(const void *a, const void *b) {
    return strcmp(((const candidate *)a)->name, ((const candidate *)b)->name);
}

candidate *candidates_find(const candidates *w, const char *name) {
    const candidate key = {.name = (char *)name};
    candidate *const *found = tfind(&key, &w->by_name, compare);
    return found != NULL ? *found : NULL;
}

static void file_free(candidate *file) {
    free(file->name);
    free(file);
}

static void enter_queue(candidates *w, candidate *file, enum candidate_state state) {
    file->state = state;
    TAILQ_INSERT_TAIL(&w->queues[state], file, link);
    w->counts[state]++;
}

static void leave_queue(candidates *w, candidate *file) {
    TAILQ_REMOVE(&w->queues[file->state], file, link);
    w->counts[file->state]--;
}

candidate *candidates_add(candidates *w, const char *name) {
    candidate *file = calloc(1, sizeof *file);
    if (file == NULL)
        return NULL;
    file->name = strdup(name);
    if (file->name == NULL || tsearch(file, &w->by_name, compare) == NULL) {
        file_free(file);
        return NULL;
    }
    enter_queue(w, file, CANDIDATE_IGNORED);
    return file;
}

void candidates_remove(candidates *w, candidate *file) {
    leave_queue(w, file);
    tdelete(file, &w->by_name, compare);
    file_free(file);
}

void candidates_forget_unseen(candidates *w, uint64_t generation) {
    for (int i = 0; i < CANDIDATE_N_STATES; i++) {
        candidate *next = NULL;
        for (candidate *file = TAILQ_FIRST(&w->queues[i]); file != NULL; file = next) {
            next = TAILQ_NEXT(file, link);
            if (file->generation != generation)
                candidates_remove(w, file);
        }
    }
}

void candidates_deinit(candidates *w) {
    candidates_forget_unseen(w, UINT64_MAX);
}

void candidates_set_state(candidates *w, candidate *file, enum candidate_state state) {
    leave_queue(w, file);
    enter_queue(w, file, state);
}

candidate *candidates_first(const candidates *w, enum candidate_state state) {
    return TAILQ_FIRST(&w->queues[state]);
}

candidate *candidates_next(const candidate *file) {
    return TAILQ_NEXT(file, link);
}
