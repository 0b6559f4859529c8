/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/reorder_buffer.h"

#include <stdlib.h>
#include <string.h>

int joined_init(joined *j, int64_t first_block, bool terms, shear_jackknife *jackknife,
                shear_error *err) {
    *j = (joined){.next_block = first_block, .jackknife = jackknife};
    int code = shear_field_sums_new(&j->sums, err);
    if (code == SHEAR_OK && terms) {
        code = shear_symmetry_new(&j->terms, err);
    }
    if (code != SHEAR_OK) {
        joined_deinit(j);
    }
    return code;
}

static void finished_deinit(finished *f) {
    free(f->sums);
    shear_symmetry_free(f->terms);
}

void joined_deinit(joined *j) {
    for (size_t i = 0; i < j->n_waiting; i++) {
        finished_deinit(&j->waiting[i]);
    }
    free(j->waiting);
    shear_field_sums_free(j->sums);
    shear_symmetry_free(j->terms);
}

/* Blocks that come next. */
static int join(joined *j, const finished *f, shear_error *err) {
    int code = f->terms != NULL ? shear_symmetry_join(j->terms, f->terms, 0, err) : SHEAR_OK;
    for (int i = 0; i < f->n && code == SHEAR_OK; i++) {
        if (j->jackknife != NULL) {
            code = shear_jackknife_add(j->jackknife, &f->sums[i], err);
        }
        shear_field_sums_add(j->sums, &f->sums[i]);
    }
    j->next_block += f->n;
    return code;
}

static int make_room(joined *j, shear_error *err) {
    if (j->n_waiting < j->room) {
        return SHEAR_OK;
    }
    const size_t room = j->room > 0 ? 2 * j->room : 16;
    finished *waiting = realloc(j->waiting, room * sizeof *waiting);
    if (waiting == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %zu finished turns", room);
    }
    j->waiting = waiting;
    j->room = room;
    return SHEAR_OK;
}

static int put_aside(joined *j, const finished *f, shear_error *err) {
    finished copy = {.block = f->block, .n = f->n};
    int code = make_room(j, err);
    if (code != SHEAR_OK) {
        return code;
    }
    copy.sums = malloc((size_t)f->n * sizeof *copy.sums);
    if (copy.sums == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a finished turn");
    }
    memcpy(copy.sums, f->sums, (size_t)f->n * sizeof *copy.sums);
    if (f->terms != NULL) {
        code = shear_symmetry_new(&copy.terms, err);
    }
    if (code == SHEAR_OK && f->terms != NULL) {
        code = shear_symmetry_join(copy.terms, f->terms, 0, err);
    }
    if (code != SHEAR_OK) {
        finished_deinit(&copy);
        return code;
    }
    j->waiting[j->n_waiting++] = copy;
    return SHEAR_OK;
}

/* Whatever waits and comes next now. */
static int join_waiting(joined *j, shear_error *err) {
    int code = SHEAR_OK;
    for (size_t i = 0; i < j->n_waiting && code == SHEAR_OK;) {
        if (j->waiting[i].block != j->next_block) {
            i++;
            continue;
        }
        finished next = j->waiting[i];
        j->waiting[i] = j->waiting[--j->n_waiting];
        code = join(j, &next, err);
        finished_deinit(&next);
        i = 0;
    }
    return code;
}

int joined_take(joined *j, const finished *f, shear_error *err) {
    if (f->block != j->next_block) {
        return put_aside(j, f, err);
    }
    const int code = join(j, f, err);
    return code == SHEAR_OK ? join_waiting(j, err) : code;
}
