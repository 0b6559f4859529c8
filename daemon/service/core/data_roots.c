/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/data_roots.h"

#include "access/access.h"
#include "base/text.h"
#include "log/log.h"
#include "service/core/clock.h"
#include "sheard/rpc.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { EVERY_S = 5 };

/* Check one root. Called from either thread, on data that the other one does not use. */
static void look(root_list *list, size_t i) {
    shear_error err = {0};
    sheard_msg_root *r = &list->roots[i];
    r->missing = access_root_check(r->path, &err) != SHEAR_OK;
    text_set(list->reasons[i], sizeof list->reasons[i], err.message);
    r->reason = r->missing ? list->reasons[i] : NULL;
}

static void list_deinit(root_list *list) {
    sheard_list_deinit(&list->paths);
    free(list->roots);
    free(list->reasons);
    *list = (root_list){0};
}

/* Make a list of roots that have not been checked. False: out of memory; deinit it also then. */
static bool list_init(root_list *list, const sheard_list *paths) {
    *list = (root_list){.roots = calloc(paths->n + 1, sizeof *list->roots),
                        .reasons = calloc(paths->n + 1, sizeof *list->reasons)};
    bool good = list->roots != NULL && list->reasons != NULL;
    for (size_t i = 0; good && i < paths->n; i++) {
        good = sheard_list_append(&list->paths, paths->items[i], NULL) == SHEAR_OK;
        if (good)
            list->roots[list->n++].path = list->paths.items[i];
    }
    return good;
}

static void warn(const sheard_msg_root *r) {
    log_warning("%s; jobs beneath it wait", r->reason);
}

void data_roots_init(data_roots *d, uv_loop_t *loop, group *g, const lifecycle *life) {
    *d = (data_roots){.loop = loop, .group = g, .life = life};
}

void data_roots_deinit(data_roots *d) {
    list_deinit(&d->known);
    list_deinit(&d->looking);
}

int data_roots_set(data_roots *d, const sheard_list *paths, shear_error *err) {
    root_list list;
    if (!list_init(&list, paths)) {
        list_deinit(&list);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the data roots");
    }
    list_deinit(&d->known);
    d->known = list;
    d->stale = true;
    for (size_t i = 0; i < list.n; i++) {
        look(&d->known, i);
        if (list.roots[i].missing)
            warn(&list.roots[i]);
    }
    return SHEAR_OK;
}

/* ---- periodic checks ---- */

/* Make jobs that wait for a root due now. */
static void retry_jobs(group *g) {
    const char *reason = sheard_rpc_code_get(SHEARD_RPC_ROOT_MISSING)->name;
    shear_error err = {0};
    if (group_begin(g, &err) != SHEAR_OK ||
        store_retry_waiting(g->store, reason, clock_wall_ms(), &err) != SHEAR_OK) {
        log_warning("jobs that wait for a data root are tried later: %s", err.message);
    }
}

/* Take over what was found about a root. */
static void update(data_roots *d, size_t i) {
    sheard_msg_root *r = &d->known.roots[i];
    const bool was_missing = r->missing;
    r->missing = d->looking.roots[i].missing;
    r->reason = r->missing ? d->known.reasons[i] : NULL;
    memcpy(d->known.reasons[i], d->looking.reasons[i], sizeof d->known.reasons[i]);
    if (r->missing && !was_missing) {
        warn(r);
    } else if (was_missing && !r->missing) {
        log_notice("data root %s is there again", r->path);
        retry_jobs(d->group);
    }
}

static void look_at_all(uv_work_t *work) {
    data_roots *d = work->data;
    for (size_t i = 0; i < d->looking.n; i++)
        look(&d->looking, i);
}

static void looked(uv_work_t *work, int status) {
    data_roots *d = work->data;
    if (status == 0 && !d->stale && !d->life->closing) {
        assert(d->looking.n == d->known.n);
        for (size_t i = 0; i < d->looking.n; i++)
            update(d, i);
    }
    list_deinit(&d->looking);
}

void data_roots_tick(data_roots *d) {
    d->ticks++;
    if (d->ticks % EVERY_S != 0 || d->looking.n > 0 || d->known.n == 0 || d->life->closing)
        return;
    d->stale = false;
    d->work.data = d;
    if (!list_init(&d->looking, &d->known.paths) ||
        uv_queue_work(d->loop, &d->work, look_at_all, looked) != 0) {
        list_deinit(&d->looking);
    }
}
