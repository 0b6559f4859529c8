/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/candidates.h"

#include <stdlib.h>
#include <string.h>

waiting_print waiting_print_of(const struct stat *st) {
    return (waiting_print){st->st_dev, st->st_ino, st->st_size, st->st_mtim, st->st_ctim};
}

static bool same_time(struct timespec a, struct timespec b) {
    return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

bool waiting_same_content(const waiting_print *a, const waiting_print *b) {
    return a->device == b->device && a->inode == b->inode && a->size == b->size &&
           same_time(a->modified, b->modified);
}

bool waiting_same(const waiting_print *a, const waiting_print *b) {
    return waiting_same_content(a, b) && same_time(a->changed, b->changed);
}

void waiting_init(waiting *w) {
    *w = (waiting){0};
    for (int i = 0; i < WAITING_N_STATES; i++) {
        TAILQ_INIT(&w->queues[i]);
    }
}

static void file_free(waiting_file *file) {
    free(file->name);
    free(file);
}

void waiting_deinit(waiting *w) {
    for (size_t i = 0; i < w->n; i++) {
        file_free(w->files[i]);
    }
    free(w->files);
    waiting_init(w);
}

/* Index of the first name not before `name`. */
static size_t place_of(const waiting *w, const char *name) {
    size_t low = 0;
    size_t high = w->n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (strcmp(w->files[middle]->name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

waiting_file *waiting_find(const waiting *w, const char *name) {
    const size_t i = place_of(w, name);
    return i < w->n && strcmp(w->files[i]->name, name) == 0 ? w->files[i] : NULL;
}

static bool make_room(waiting *w) {
    if (w->n < w->room) {
        return true;
    }
    const size_t room = w->room == 0 ? 64 : 2 * w->room;
    waiting_file **files = reallocarray(w->files, room, sizeof(waiting_file *));
    if (files == NULL) {
        return false;
    }
    w->files = files;
    w->room = room;
    return true;
}

waiting_file *waiting_add(waiting *w, const char *name) {
    waiting_file *file = calloc(1, sizeof *file);
    if (file == NULL) {
        return NULL;
    }
    file->name = strdup(name);
    if (file->name == NULL || !make_room(w)) {
        file_free(file);
        return NULL;
    }
    const size_t i = place_of(w, name);
    memmove(w->files + i + 1, w->files + i, (w->n - i) * sizeof(waiting_file *));
    w->files[i] = file;
    w->n++;
    file->state = WAITING_IGNORED;
    TAILQ_INSERT_TAIL(&w->queues[WAITING_IGNORED], file, link);
    w->counts[WAITING_IGNORED]++;
    return file;
}

static void leave_queue(waiting *w, waiting_file *file) {
    TAILQ_REMOVE(&w->queues[file->state], file, link);
    w->counts[file->state]--;
}

void waiting_remove(waiting *w, waiting_file *file) {
    const size_t i = place_of(w, file->name);
    leave_queue(w, file);
    memmove(w->files + i, w->files + i + 1, (w->n - i - 1) * sizeof(waiting_file *));
    w->n--;
    file_free(file);
}

void waiting_forget_others(waiting *w, uint64_t generation) {
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

void waiting_set(waiting *w, waiting_file *file, int state) {
    leave_queue(w, file);
    file->state = state;
    TAILQ_INSERT_TAIL(&w->queues[state], file, link);
    w->counts[state]++;
}

waiting_file *waiting_first(const waiting *w, int state) {
    return TAILQ_FIRST(&w->queues[state]);
}

waiting_file *waiting_next(const waiting_file *file) {
    return TAILQ_NEXT(file, link);
}
