/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/open_requests.h: the unanswered requests of a connection. */
#pragma once

#include "server/server.h"

#include <sys/queue.h>

typedef struct open_request {
    uint64_t number;
    enum sheard_method method;
    bool is_long; /* may last for hours: wait, or submit with wait */
    bool answered;
    bool awake; /* its deferred work is runnable: in the list `awake` */
    sheard_rpc_id id;
    server_work work; /* deferred work; `step` is NULL if there is none */
    TAILQ_ENTRY(open_request) link;
} open_request;

typedef struct open_requests {
    open_request **items; /* [n] of [capacity], in ascending order of number */
    size_t n, capacity;
    size_t n_long;
    uint64_t last; /* last number given out */
    TAILQ_HEAD(, open_request) awake;
} open_requests;

void open_requests_init(open_requests *o);
/* Free all requests, and drop their deferred work. */
void open_requests_deinit(open_requests *o);
/* Add a request. Return its number, or 0 if out of memory. */
uint64_t open_requests_add(open_requests *o, const sheard_request *request);
/* Return the request, or NULL if there is none of that number. */
open_request *open_requests_find(const open_requests *o, uint64_t number);
/* Remove a request, and drop its deferred work. */
void open_requests_remove(open_requests *o, open_request *r);

/* Mark a request's deferred work as runnable, or as paused. */
void open_requests_wake(open_requests *o, open_request *r);
void open_requests_pause(open_requests *o, open_request *r);

/* Return whether the request may last for hours. */
bool open_request_is_long(const sheard_request *request);
