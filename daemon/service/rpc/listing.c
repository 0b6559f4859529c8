/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/listing.h"

#include "service/rpc/methods.h"

#include <stdlib.h>
#include <string.h>

void listing_begin(listing *l, service *s, const server_request *r, int (*step)(void *),
                   void (*drop)(void *)) {
    const server_work work = {.step = step, .drop = drop, .context = l};
    *l = (listing){.s = s, .to = r->handle, .request = *r->request};
    *r->request = (sheard_request){0}; /* taken over */
    server_defer(s->server, l->to, &work);
}

void listing_deinit(listing *l) {
    sheard_request_deinit(&l->request);
    free(l->items);
}

static bool make_room(listing *l, size_t n) {
    if (n <= l->size - l->used) {
        return true;
    }
    const size_t size = 2 * l->size > l->used + n ? 2 * l->size : l->used + n;
    char *larger = realloc(l->items, size);
    if (larger == NULL) {
        return false;
    }
    l->items = larger;
    l->size = size;
    return true;
}

bool listing_add(listing *l, const void *item) {
    sheard_rpc_error error;
    char *text = NULL;
    size_t n = 0;
    int rc = sheard_reply_item(&text, &n, l->request.method, item, &error);
    if (rc == SHEARD_RPC_OK && !make_room(l, n + 1)) {
        rc = sheard_rpc_fail(&error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory for the reply");
    }
    if (rc != SHEARD_RPC_OK) {
        server_reply_error(l->s->server, l->to, &error);
    } else {
        if (l->used > 0) {
            l->items[l->used++] = ',';
        }
        memcpy(l->items + l->used, text, n);
        l->used += n;
    }
    free(text);
    return rc == SHEARD_RPC_OK;
}

void listing_clear(listing *l) {
    free(l->items);
    l->items = NULL;
    l->used = l->size = 0;
}

void listing_reply(listing *l, const sheard_reply *rest) {
    sheard_rpc_error error;
    char *line = NULL;
    size_t n = 0;
    if (sheard_reply_list_line(&line, &n, &l->request.id, l->request.method, rest, l->items,
                               l->used, &error) == SHEARD_RPC_OK) {
        server_reply_line(l->s->server, l->to, line, n);
    } else {
        server_reply_error(l->s->server, l->to, &error);
    }
}

void listing_refuse_store(listing *l, int code, const shear_error *err) {
    method_refuse_store(l->s, l->to, code, err);
}

void listing_refuse(listing *l, int code, const char *message) {
    method_refuse(l->s, l->to, code, message);
}
