/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/refuse.h: send error replies. */
#pragma once

#include "server/server.h"

typedef struct service service;

void refuse_with(service *s, server_handle to, int code, const char *message);
/* Reply with an error of the store. */
void refuse_store(service *s, server_handle to, int code, const shear_error *err);
/* Reply that the service is draining or stopping. */
void refuse_new_jobs(service *s, server_handle to);
