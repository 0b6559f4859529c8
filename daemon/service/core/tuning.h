/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/tuning.h: the limits of server, spool, readers and memory, computed from the
 * configuration. */
#pragma once

#include "reader/reader.h"
#include "server/server.h"
#include "sheard/config.h"
#include "spool/spool.h"

server_limits tuning_server(const sheard_config *c);
spool_tuning tuning_spool(const sheard_config *c);
reader_limits tuning_reader(const sheard_config *c); /* except the paths */
/* Return the jobs' memory budget in bytes; log a warning if the machine has less. */
int64_t tuning_memory(const sheard_config *c);
