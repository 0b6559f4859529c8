/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/data_roots.h: which data roots are there, as the service sees them. They are looked
 * at now and then, off the loop: a file server that does not answer holds up nobody. Jobs beneath a
 * missing root wait; when it is there again, they are tried at once. */
#ifndef SHEARD_SERVICE_DATA_ROOTS_H
#define SHEARD_SERVICE_DATA_ROOTS_H

#include "service/core/group.h"
#include "service/core/lifecycle.h"
#include "sheard/config.h"
#include "sheard/messages.h"

typedef struct data_root data_root;

/* A list of roots, and what was found. */
typedef struct root_list {
    data_root *roots; /* [n] */
    size_t n;
} root_list;

typedef struct data_roots {
    uv_loop_t *loop;
    group *group;
    const lifecycle *life;
    int64_t ticks;
    root_list known;
    sheard_msg_root *told; /* [known.n] */
    uv_work_t work;
    root_list looking; /* the copy that the pool's thread works on; n > 0: a look is under way */
    bool stale;        /* ... at the roots of another configuration */
} data_roots;

void data_roots_init(data_roots *d, uv_loop_t *loop, group *g, const lifecycle *life);
void data_roots_deinit(data_roots *d);
/* Those of the configuration, looked at; missing ones are warned of. On an error: as before. */
int data_roots_set(data_roots *d, const sheard_list *paths, shear_error *err);
void data_roots_tick(data_roots *d);                             /* once a second */
const sheard_msg_root *data_roots_get(data_roots *d, size_t *n); /* valid until the next call */
/* One line for each that is missing, into list[capacity]; how many. */
size_t data_roots_missing(const data_roots *d, const char **list, size_t capacity);

#endif
