/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/lifetime.h"

#include "server/internal.h"

#include <assert.h>
#include <stdlib.h>

void lifetime_free(server *s) {
    assert(s->handles == 0);
    void (*done)(void *) = s->done;
    void *context = s->done_context;
    free(s->table.items);
    for (int i = 0; i < N_REFUSALS; i++)
        free(s->refusals[i]);
    free(s);
    if (done != NULL)
        done(context);
}

static void on_closed(uv_handle_t *handle) {
    lifetime_handle_closed(handle->data);
}

void lifetime_close_handle(void *handle) {
    uv_handle_t *h = handle;
    if (!uv_is_closing(h))
        uv_close(h, on_closed);
}

void lifetime_end_if_empty(server *s) {
    if (s->closing && s->statistics.connections == 0) {
        lifetime_close_handle(&s->scheduler.idle);
        lifetime_close_handle(&s->tick);
        lifetime_close_handle(&s->deadline);
    }
}

void lifetime_handle_closed(server *s) {
    assert(s->handles > 0);
    if (--s->handles == 0) {
        lifetime_free(s);
    } else {
        lifetime_end_if_empty(s);
    }
}
