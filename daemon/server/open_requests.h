/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/open_requests.h: the requests of a connection that have not been answered. */
#ifndef SERVER_OPEN_REQUESTS_H
#define SERVER_OPEN_REQUESTS_H

#include "server/server.h"

#include <sys/queue.h>

typedef struct open_request {
    uint64_t number;
    enum sheard_method method;
    bool is_long; /* may take as long as the client likes */
    bool answered;
    bool awake; /* its work wants to go on: in the list of these */
    sheard_rpc_id id;
    server_work work; /* without a step: there is none */
    TAILQ_ENTRY(open_request) link;
} open_request;

typedef struct open_requests {
    open_request **items; /* [n] of [capacity], by number */
    size_t n, capacity;
    size_t n_long;
    uint64_t last; /* number given out */
    TAILQ_HEAD(, open_request) awake;
} open_requests;

void open_requests_init(open_requests *o);
void open_requests_deinit(open_requests *o);
/* Its number; 0: out of memory. */
uint64_t open_requests_add(open_requests *o, const sheard_request *request);
/* NULL: there is none. */
open_request *open_requests_find(const open_requests *o, uint64_t number);
/* With its work. */
void open_requests_remove(open_requests *o, uint64_t number);

void open_requests_wake(open_requests *o, open_request *r);
void open_requests_pause(open_requests *o, open_request *r);

/* Whether the answer of a request may be long in coming. */
bool open_request_is_long(const sheard_request *request);

#endif
