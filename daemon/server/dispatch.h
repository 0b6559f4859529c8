/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/dispatch.h: from lines to requests, which go to the owner. */
#ifndef SHEARD_SERVER_DISPATCH_H
#define SHEARD_SERVER_DISPATCH_H

#include "server/connection.h"

/* Do the limits allow another line? */
bool dispatch_is_allowed(const connection *c);
/* Take a line of the input, where there is a whole one, and hand its request over. */
void dispatch_line(connection *c);

#endif
