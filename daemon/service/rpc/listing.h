/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/listing.h: a request whose reply is a long list: made a few items at a time, in the
 * steps of deferred work (server.h), so that nobody waits for the whole of it. */
#ifndef SHEARD_SERVICE_LISTING_H
#define SHEARD_SERVICE_LISTING_H

#include "base/buffer.h"
#include "server/server.h"

typedef struct service service;

typedef struct listing {
    service *s;
    server_handle to;
    sheard_request request; /* taken over from the one that was given */
    buffer items;           /* their texts, with commas between them */
} listing;

/* Take the request over, and have it done by `step`, which gets `l`: the first member of what it
 * works on; `drop` frees that. Where it cannot be, the request has been answered. */
void listing_begin(listing *l, service *s, const server_request *r,
                   enum server_step (*step)(void *), void (*drop)(void *));
void listing_deinit(listing *l);
/* The next item, of the request's method. False: the request has been answered with an error. */
bool listing_add(listing *l, const void *item);
/* The reply, with the items in its list. */
void listing_reply(listing *l, const sheard_reply *rest);

#endif
