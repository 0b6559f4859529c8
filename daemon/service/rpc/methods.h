/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/methods.h: the methods of the protocol. A method is an entry of the protocol's table
 * (its name, parameters and reply, and whether it is for administrators only: protocol/rpc) and an
 * entry of the table in methods.c: its handler, which replies now or later. */
#ifndef SHEARD_SERVICE_METHODS_H
#define SHEARD_SERVICE_METHODS_H

#include "server/server.h"

typedef struct service service;

/* The server's request handler; its context is the service. */
void methods_request(void *context, const server_request *request);

typedef void method_handler(service *s, const server_request *r);

/* method_connection.c */
method_handler method_hello, method_subscribe, method_unsubscribe;
/* method_submit.c, method_cancel.c, method_retry.c, method_retract.c, method_forget.c */
method_handler method_submit, method_cancel, method_retry, method_retract, method_forget;
/* method_jobs.c, method_fields.c, pending_waits.c */
method_handler method_job, method_jobs, method_field, method_fields, method_wait;
/* method_service.c, probe.c */
method_handler method_status, method_metrics, method_reload, method_drain, method_shutdown,
    method_probe;

#endif
