/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/candidates.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void candidates_init(candidates *w) {
    *w = (candidates){0};
    for (int i = 0; i < CANDIDATE_N_STATES; i++)
        TAILQ_INIT(&w->queues[i]);
}

static void file_free(candidate *file) {
    free(file->name);
    free(file);
}

void candidates_deinit(candidates *w) {
    for (size_t i = 0; i < w->n; i++)
        file_free(w->files[i]);
    free(w->files);
    candidates_init(w);
}

static int by_name(const void *name, const void *file) {
    return strcmp(name, (*(candidate *const *)file)->name);
}

/* Return the index of the first name that is not less than `name`. */
static size_t place_of(const candidates *w, const char *name) {
    return array_lower_bound(w->files, w->n, sizeof(candidate *), name, by_name);
}

candidate *candidates_find(const candidates *w, const char *name) {
    const size_t i = place_of(w, name);
    return i < w->n && strcmp(w->files[i]->name, name) == 0 ? w->files[i] : NULL;
}

candidate *candidates_add(candidates *w, const char *name) {
    candidate *file = calloc(1, sizeof *file);
    if (file == NULL)
        return NULL;
    file->name = strdup(name);
    if (file->name == NULL || !ARRAY_RESERVE(w->files, w->capacity, w->n + 1)) {
        file_free(file);
        return NULL;
    }
    const size_t i = place_of(w, name);
    memmove(w->files + i + 1, w->files + i, (w->n - i) * sizeof(candidate *));
    w->files[i] = file;
    w->n++;
    file->state = CANDIDATE_IGNORED;
    TAILQ_INSERT_TAIL(&w->queues[CANDIDATE_IGNORED], file, link);
    w->counts[CANDIDATE_IGNORED]++;
    return file;
}

static void leave_queue(candidates *w, candidate *file) {
    TAILQ_REMOVE(&w->queues[file->state], file, link);
    w->counts[file->state]--;
}

void candidates_remove(candidates *w, candidate *file) {
    const size_t i = place_of(w, file->name);
    assert(i < w->n && w->files[i] == file);
    leave_queue(w, file);
    memmove(w->files + i, w->files + i + 1, (w->n - i - 1) * sizeof(candidate *));
    w->n--;
    file_free(file);
}

void candidates_forget_unseen(candidates *w, uint64_t generation) {
    size_t kept = 0;
    for (size_t i = 0; i < w->n; i++) {
        if (w->files[i]->generation == generation) {
            w->files[kept++] = w->files[i];
        } else {
            leave_queue(w, w->files[i]);
            file_free(w->files[i]);
        }
    }
    w->n = kept;
}

void candidates_set_state(candidates *w, candidate *file, enum candidate_state state) {
    leave_queue(w, file);
    file->state = state;
    TAILQ_INSERT_TAIL(&w->queues[state], file, link);
    w->counts[state]++;
}

candidate *candidates_first(const candidates *w, enum candidate_state state) {
    return TAILQ_FIRST(&w->queues[state]);
}

candidate *candidates_next(const candidate *file) {
    return TAILQ_NEXT(file, link);
}
