/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/tuning.h: what the configuration means for the rooms that have limits of their own.
 */
#ifndef SHEARD_SERVICE_TUNING_H
#define SHEARD_SERVICE_TUNING_H

#include "reader/reader.h"
#include "server/server.h"
#include "sheard/config.h"
#include "spool/spool.h"

server_limits tuning_server(const sheard_config *c);
spool_tuning tuning_spool(const sheard_config *c);
reader_limits tuning_reader(const sheard_config *c); /* but its paths */
/* The jobs' budget, in bytes; one that the machine does not have is warned of. */
int64_t tuning_memory(const sheard_config *c);

#endif
