/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/listing.h"

#include "base/cleanup.h"
#include "service/core/parts.h"

void *listing_new(service *s, server_handle to, sheard_request *request, const listing_kind *kind,
                  size_t size, sheard_rpc_error *error) {
    listing *l = calloc(1, size);
    if (l == NULL) {
        sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory for %s", kind->what);
        return NULL;
    }
    l->kind = kind;
    l->s = s;
    l->to = to;
    if (request != NULL) {
        l->request = *request;
        *request = (sheard_request){0};
    }
    return l;
}

static enum server_step step(void *context) {
    listing *l = context;
    sheard_rpc_error error;
    const int code = l->kind->step(l, &error);
    if (code > SHEARD_RPC_OK)
        server_reply_error(l->s->server, l->to, &error);
    return code == SHEARD_RPC_OK ? SERVER_MORE : SERVER_PAUSE;
}

void listing_free(listing *l) {
    if (l->kind->deinit != NULL)
        l->kind->deinit(l);
    sheard_request_deinit(&l->request);
    buffer_deinit(&l->items);
    free(l);
}

static void drop(void *context) {
    listing_free(context);
}

void listing_begin(listing *l) {
    const server_work work = {.step = step, .drop = drop, .context = l};
    server_defer(l->s->server, l->to, &work);
}

int listing_add(listing *l, const void *item, sheard_rpc_error *error) {
    CLEANUP(release_free) char *text = NULL;
    size_t n = 0;
    TRY(sheard_reply_item(&text, &n, l->request.method, item, error));
    if ((l->items.n > 0 && !buffer_add_text(&l->items, ",")) || !buffer_add(&l->items, text, n)) {
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL,
                               "out of memory for the reply");
    }
    return SHEARD_RPC_OK;
}

int listing_reply(listing *l, const sheard_reply *rest, sheard_rpc_error *error) {
    char *line = NULL;
    size_t n = 0;
    TRY(sheard_reply_list_line(&line, &n, &l->request.id, l->request.method, rest, l->items.bytes,
                               l->items.n, error));
    server_reply_line(l->s->server, l->to, line, n);
    return SHEARD_RPC_OK;
}
