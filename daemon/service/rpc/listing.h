/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/listing.h: a reply that is made in steps of deferred work (server.h), most often a
 * long list of which each step adds a few items, so that other clients do not wait for all of it.
 */
#pragma once

#include "base/buffer.h"
#include "server/server.h"

typedef struct service service;
typedef struct listing listing;

/* What a step returns to be called again only after server_wake. */
enum { LISTING_PAUSE = -1 };

typedef struct listing_kind {
    const char *what; /* "a field": for messages */
    /* Do one step. Return SHEARD_RPC_OK (to be called again, unless the reply has been sent),
     * LISTING_PAUSE, or the code of *error, which is then sent. */
    int (*step)(listing *l, sheard_rpc_error *error);
    void (*deinit)(listing *l); /* release what else the record owns; NULL: nothing */
} listing_kind;

struct listing {
    const listing_kind *kind;
    service *s;
    server_handle to;
    sheard_request request; /* taken over from the server's request */
    buffer items;           /* JSON texts, separated by commas */
};

/* Return a zeroed record of `size` bytes whose first member is a listing, and take over *request
 * (NULL: none is needed). NULL: out of memory, with *error filled. */
void *listing_new(service *s, server_handle to, sheard_request *request, const listing_kind *kind,
                  size_t size, sheard_rpc_error *error);
void listing_free(listing *l); /* and deinit it, before the steps */
/* Begin the steps. The record is freed when the reply has been sent or the client is gone, which
 * may be at once. */
void listing_begin(listing *l);
/* Append an item of the request's method. Return SHEARD_RPC_OK, or the code of *error. */
int listing_add(listing *l, const void *item, sheard_rpc_error *error);
/* Send the reply: `rest`, with the items in its list. Return SHEARD_RPC_OK, or the code of
 * *error. */
int listing_reply(listing *l, const sheard_reply *rest, sheard_rpc_error *error);
