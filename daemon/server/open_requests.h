/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The requests of a connection that have not been answered. */
#ifndef SERVER_OPEN_REQUESTS_H
#define SERVER_OPEN_REQUESTS_H

#include "sheard/rpc.h"

typedef struct open_request {
    uint64_t number;
    int method;
    bool is_long; /* may take as long as the client likes */
    shear_rpc_id id;
} open_request;

typedef struct open_requests {
    open_request **items; /* [n] of [size], by number */
    size_t n, size;
    size_t n_long;
    uint64_t last; /* number given out */
} open_requests;

void open_requests_deinit(open_requests *o); /* zeroed: fine */
/* Its number; 0: out of memory. */
uint64_t open_requests_add(open_requests *o, const shear_request *request);
/* NULL: there is none. */
const open_request *open_requests_find(const open_requests *o, uint64_t number);
void open_requests_remove(open_requests *o, uint64_t number);

/* Whether the answer of a request may be long in coming. */
bool open_request_is_long(const shear_request *request);

#endif
