/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/connection_loop.h: what a connection does next. Each call may close it. */
#ifndef SHEARD_SERVER_CONNECTION_LOOP_H
#define SHEARD_SERVER_CONNECTION_LOOP_H

#include "server/connection.h"

/* Begin to read. */
void connection_start(connection *c);
/* The one thing that is next: a request, or a step of the work of one. */
void connection_process(connection *c);
/* Write what is queued, as much as the socket takes. */
void connection_flush(connection *c);
/* Is it silent, stalled or gone? */
void connection_tick(connection *c);

#endif
