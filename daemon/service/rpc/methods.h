/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/methods.h: dispatch requests to the methods of the protocol. A method is a row of
 * SHEARD_METHODS (sheard/rpc.h: name, parameters, reply, administrators only or not) and a handler
 * method_NAME. */
#pragma once

#include "server/server.h"
#include "sheard/rpc.h"

typedef struct service service;

/* The server's request handler; `context` is the service. */
void methods_request(void *context, const server_request *request);

/* Reply to the request, now or later, and return SHEARD_RPC_OK; or return the code of *error, which
 * is then the reply. */
typedef int method_handler(service *s, const server_request *r, sheard_rpc_error *error);

/* Declare a handler for each method: method_hello, method_submit, ... */
#define METHOD(NAME, name, params, reply, admin) method_handler method_##name;
SHEARD_METHODS(METHOD)
#undef METHOD
