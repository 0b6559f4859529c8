/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/limits.h: the limits in force. */
#ifndef SHEARD_SERVER_LIMITS_H
#define SHEARD_SERVER_LIMITS_H

#include "server/server.h"

/* The given ones, with what is missing filled in, and within the bounds that always hold. */
void limits_fill(server_limits *limits, const server_limits *given);

#endif
