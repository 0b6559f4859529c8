/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/methods.h: the methods of the protocol, each with its request; the reply is given now
 * or later. */
#ifndef SHEARD_SERVICE_METHODS_H
#define SHEARD_SERVICE_METHODS_H

#include "service/inner.h"

/* method_changes.c */
/* The change is on disk: reply with the job as it is now. */
void method_reply_job(service *s, after *a, int code, const shear_error *err);
/* Owners and administrators only. Where not, the reply has been given. */
bool method_may_change(service *s, const server_request *r, int64_t id);
void method_submit(service *s, const server_request *r);
void method_cancel(service *s, const server_request *r);
void method_retry(service *s, const server_request *r);

/* method_retract.c */
void method_retract(service *s, const server_request *r);

/* method_forget.c */
void method_forget(service *s, const server_request *r);

/* method_jobs.c */
void method_job(service *s, const server_request *r);
void method_jobs(service *s, const server_request *r);

/* waits.c */
void method_wait(service *s, const server_request *r);

/* method_fields.c */
void method_field(service *s, const server_request *r);
void method_fields(service *s, const server_request *r);

/* probe.c */
void method_probe(service *s, const server_request *r);

/* methods.c: error replies */
void method_refuse(service *s, server_handle to, int code, const char *message);
void method_refuse_new(service *s, server_handle to); /* draining or stopping */
void method_refuse_store(service *s, server_handle to, int code, const shear_error *err);

#endif
