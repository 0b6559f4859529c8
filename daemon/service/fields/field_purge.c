/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/field_purge.h"

#include "base/cleanup.h"
#include "log/log.h"
#include "service/core/parts.h"
#include "service/jobs/catalogs.h"

void field_purge_init(field_purge *p) {
    TAILQ_INIT(&p->waiters);
}

void field_purge_deinit(field_purge *p) {
    for (purge_waiter *w; (w = TAILQ_FIRST(&p->waiters)) != NULL;) {
        TAILQ_REMOVE(&p->waiters, w, link);
        free(w);
    }
}

void field_purge_wait(service *s, purge_waiter *w) {
    TAILQ_INSERT_TAIL(&s->purge->waiters, w, link);
}

/* What one group removes. */
typedef struct purge_slice {
    post_commit post; /* first */
    int64_t row;      /* number of the field's row (store_removal) */
    int64_t jobs;
    bool over;   /* the row is now empty and removed */
    bool failed; /* a change failed; it is tried again later */
    char *field; /* the field's name, if over */
} purge_slice;

/* Return the request that waits for the row, or NULL: the field was forgotten before the start. */
static purge_waiter *find_waiter(const field_purge *p, int64_t row) {
    purge_waiter *w;
    TAILQ_FOREACH(w, &p->waiters, link) {
        if (row > w->numbers.last - w->numbers.rows && row <= w->numbers.last)
            break;
    }
    return w;
}

static void tell(service *s, const purge_slice *slice) {
    purge_waiter *w = find_waiter(s->purge, slice->row);
    if (w != NULL)
        w->jobs += slice->jobs;
    if (w != NULL && slice->over && slice->row == w->numbers.last) {
        TAILQ_REMOVE(&s->purge->waiters, w, link);
        w->done(s, w);
    }
    if (slice->over)
        log_notice("field '%s' is forgotten", slice->field);
}

/* The removals are on disk: notify the waiter and continue. */
static void have_left(post_commit *post, int code, const shear_error *err) {
    service *s = post->context;
    const purge_slice *slice = (const purge_slice *)post;
    const bool left = code == SHEAR_OK;
    (void)err;
    s->purge->under_way = false;
    if (left)
        tell(s, slice);
    if (left && !slice->failed)
        field_purge_continue(s);
    free(slice->field);
}

static int remove_one(service *s, purge_slice *slice, shear_error *err) {
    CLEANUP(store_removal_deinit) store_removal next = {0};
    TRY(store_next_removal(s->store, &next, err));
    if (next.forgotten != 0) {
        const bool gone = next.contribution != 0 && catalog_remove_leaving(s, &next);
        TRY(store_remove(s->store, &next, gone, err));
    }
    slice->row = next.forgotten;
    slice->jobs += next.kept;
    slice->over = next.contribution == 0;
    if (slice->over)
        slice->field = CLEANUP_TAKE(next.field);
    return SHEAR_OK;
}

static int remove_some(service *s, purge_slice *slice, shear_error *err) {
    enum { SLICE_NS = 3000000 };
    const uint64_t end = uv_hrtime() + SLICE_NS;
    TRY(group_begin(&s->group, err));
    while (!slice->over && uv_hrtime() < end)
        TRY(remove_one(s, slice, err));
    return SHEAR_OK;
}

static bool is_any_left(const service *s) {
    CLEANUP(store_removal_deinit) store_removal next = {0};
    shear_error ignored;
    store_next_removal(s->store, &next, &ignored);
    return next.forgotten != 0;
}

void field_purge_continue(service *s) {
    enum { SECONDS_MS = 5000 };
    shear_error err = {0};
    if (s->purge->under_way || s->life.state == SHEARD_SERVER_STOPPING || !is_any_left(s))
        return;
    purge_slice *slice = group_then(&s->group, have_left, 0, sizeof *slice);
    if (slice == NULL)
        return;
    s->purge->under_way = true;
    const int code = remove_some(s, slice, &err);
    slice->failed = code != SHEAR_OK;
    if (slice->failed)
        problem_note_add(&s->notes, "store", store_code_name(code), SECONDS_MS, err.message);
}
