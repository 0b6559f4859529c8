/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which data roots are there, as the service sees them. They are looked at now and then, off the
 * loop: a file server that does not answer holds up nobody. Jobs beneath a missing root wait; when
 * it is there again, they are tried at once. */
#include "service/inner.h"

#include <stdlib.h>
#include <string.h>

enum { EVERY_S = 5, REASON_SIZE = 160 };

typedef struct one_root {
    char *path;
    bool missing;
    char reason[REASON_SIZE];
} one_root;

/* A list of roots, and what was found; the pool's thread works on a copy. */
typedef struct root_list {
    one_root *roots; /* [n] */
    size_t n;
} root_list;

struct data_roots {
    root_list known;
    sheard_msg_root *told; /* [n] */
    uv_work_t work;
    root_list looking; /* n > 0: a look is under way */
    bool stale;        /* ... at the roots of another configuration */
};

static void look(one_root *r) {
    shear_error err = {0};
    r->missing = access_root_check(r->path, &err) != SHEAR_OK;
    snprintf(r->reason, sizeof r->reason, "%.*s", REASON_SIZE - 1, r->missing ? err.message : "");
}

static void list_deinit(root_list *list) {
    for (size_t i = 0; i < list->n; i++) {
        free(list->roots[i].path);
    }
    free(list->roots);
    *list = (root_list){0};
}

/* Room for n; list->n is how many there are. */
static bool list_init(root_list *list, size_t n) {
    *list = (root_list){.roots = calloc(n + 1, sizeof *list->roots)};
    return list->roots != NULL;
}

static bool list_add(root_list *list, const char *path) {
    char *copy = strdup(path);
    if (copy != NULL) {
        list->roots[list->n++].path = copy;
    }
    return copy != NULL;
}

static void warn(const one_root *r) {
    log_warning("%s; jobs beneath it wait", r->reason);
}

int roots_set(service *s, shear_error *err) {
    const sheard_list *paths = &s->config.access.data_roots;
    root_list list = {0};
    if (s->data_roots == NULL) {
        s->data_roots = calloc(1, sizeof *s->data_roots);
    }
    sheard_msg_root *told = calloc(paths->n + 1, sizeof *told);
    bool ok = s->data_roots != NULL && told != NULL && list_init(&list, paths->n);
    for (size_t i = 0; ok && i < paths->n; i++) {
        ok = list_add(&list, paths->items[i]);
    }
    if (!ok) {
        free(told);
        list_deinit(&list);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the data roots");
    }
    list_deinit(&s->data_roots->known);
    free(s->data_roots->told);
    s->data_roots->known = list;
    s->data_roots->told = told;
    s->data_roots->stale = true;
    for (size_t i = 0; i < list.n; i++) {
        look(&list.roots[i]);
        if (list.roots[i].missing) {
            warn(&list.roots[i]);
        }
    }
    return SHEAR_OK;
}

void roots_free(service *s) {
    if (s->data_roots != NULL) {
        list_deinit(&s->data_roots->known);
        list_deinit(&s->data_roots->looking);
        free(s->data_roots->told);
        free(s->data_roots);
        s->data_roots = NULL;
    }
}

const sheard_msg_root *roots_tell(const service *s, size_t *n) {
    const data_roots *d = s->data_roots;
    for (size_t i = 0; i < d->known.n; i++) {
        const one_root *r = &d->known.roots[i];
        d->told[i] = (sheard_msg_root){r->path, r->missing, r->missing ? r->reason : NULL};
    }
    *n = d->known.n;
    return d->told;
}

size_t roots_problems(const service *s, const char **list, size_t room) {
    size_t n = 0;
    for (size_t i = 0; i < s->data_roots->known.n && n < room; i++) {
        if (s->data_roots->known.roots[i].missing) {
            list[n++] = s->data_roots->known.roots[i].reason;
        }
    }
    return n;
}

/* ---- now and then ---- */

static void hurry(service *s) {
    shear_error err = {0};
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_retry_waiting(s->store, sheard_rpc_code_get(SHEARD_RPC_ROOT_MISSING)->name,
                                   wall_ms(), &err);
    }
    if (code != SHEAR_OK) {
        log_warning("jobs that wait for a data root are tried later: %s", err.message);
    }
}

static void take(service *s, one_root *known, const one_root *found) {
    const bool came = known->missing && !found->missing;
    const bool went = !known->missing && found->missing;
    known->missing = found->missing;
    snprintf(known->reason, sizeof known->reason, "%s", found->reason);
    if (went) {
        warn(known);
    } else if (came) {
        log_notice("data root %s is there again", known->path);
        hurry(s);
    }
}

static void look_at_all(uv_work_t *work) {
    data_roots *d = ((service *)work->data)->data_roots;
    for (size_t i = 0; i < d->looking.n; i++) {
        look(&d->looking.roots[i]);
    }
}

static void looked(uv_work_t *work, int status) {
    service *s = work->data;
    data_roots *d = s->data_roots;
    for (size_t i = 0; status == 0 && !d->stale && !s->closing && i < d->looking.n; i++) {
        take(s, &d->known.roots[i], &d->looking.roots[i]);
    }
    list_deinit(&d->looking);
}

void roots_tick(service *s) {
    data_roots *d = s->data_roots;
    if (s->ticks % EVERY_S != 0 || d->looking.n > 0 || d->known.n == 0 || s->closing) {
        return;
    }
    bool ok = list_init(&d->looking, d->known.n);
    for (size_t i = 0; ok && i < d->known.n; i++) {
        ok = list_add(&d->looking, d->known.roots[i].path);
    }
    d->stale = false;
    d->work.data = s;
    if (!ok || uv_queue_work(&s->loop, &d->work, look_at_all, looked) != 0) {
        list_deinit(&d->looking);
    }
}
