/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/listing.h"

#include "base/cleanup.h"
#include "service/core/parts.h"

void listing_begin(listing *l, service *s, const server_request *r,
                   enum server_step (*step)(void *), void (*drop)(void *)) {
    const server_work work = {.step = step, .drop = drop, .context = l};
    *l = (listing){.s = s, .to = r->handle, .request = *r->request};
    *r->request = (sheard_request){0}; /* taken over */
    server_defer(s->server, l->to, &work);
}

void listing_deinit(listing *l) {
    sheard_request_deinit(&l->request);
    buffer_deinit(&l->items);
}

bool listing_add(listing *l, const void *item) {
    CLEANUP(release_free) char *text = NULL;
    sheard_rpc_error error;
    size_t n = 0;
    if (sheard_reply_item(&text, &n, l->request.method, item, &error) != SHEARD_RPC_OK) {
        server_reply_error(l->s->server, l->to, &error);
        return false;
    }
    if ((l->items.n > 0 && !buffer_add_text(&l->items, ",")) || !buffer_add(&l->items, text, n)) {
        sheard_rpc_fail(&error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "out of memory for the reply");
        server_reply_error(l->s->server, l->to, &error);
        return false;
    }
    return true;
}

void listing_reply(listing *l, const sheard_reply *rest) {
    sheard_rpc_error error;
    char *line = NULL;
    size_t n = 0;
    if (sheard_reply_list_line(&line, &n, &l->request.id, l->request.method, rest, l->items.bytes,
                               l->items.n, &error) != SHEARD_RPC_OK) {
        server_reply_error(l->s->server, l->to, &error);
        return;
    }
    server_reply_line(l->s->server, l->to, line, n);
}
