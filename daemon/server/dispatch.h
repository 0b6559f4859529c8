/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/dispatch.h: parse lines into requests, and pass these to the owner. */
#pragma once

#include "server/connection.h"

/* Return whether the limits allow another line. */
bool dispatch_is_allowed(const connection *c);
/* Take one line of the input, if it is complete, and pass its request to the owner. */
void dispatch_line(connection *c);
