/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/listing.h: a reply that is a long list, made a few items at a time in steps of
 * deferred work (server.h), so that other clients do not wait for all of it. */
#pragma once

#include "base/buffer.h"
#include "server/server.h"

typedef struct service service;

typedef struct listing {
    service *s;
    server_handle to;
    sheard_request request; /* taken over from the server's request */
    buffer items;           /* JSON texts, separated by commas */
} listing;

/* Take over the request and defer its work: `step` makes the reply, `drop` frees `l` and the record
 * whose first member it is. */
void listing_begin(listing *l, service *s, const server_request *r,
                   enum server_step (*step)(void *), void (*drop)(void *));
void listing_deinit(listing *l);
/* Append an item of the request's method. False: the error reply has been sent. */
bool listing_add(listing *l, const void *item);
/* Send the reply: `rest`, with the items in its list. */
void listing_reply(listing *l, const sheard_reply *rest);
