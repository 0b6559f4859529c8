/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/tuning.h: the limits of server, spool, readers, memory and file descriptors,
 * computed from the configuration. */
#pragma once

#include "reader/reader.h"
#include "server/server.h"
#include "sheard/config.h"
#include "spool/spool.h"

/* Raise the limit of file descriptors to what this configuration needs (for the service's own
 * files, jobs and administrators, whatever clients use), or to the hard limit; log a warning if
 * that is not enough. */
void tuning_raise_descriptors(const sheard_config *c);
/* Return [limits] connections, or as many as there are descriptors for. */
int64_t tuning_connections(const sheard_config *c);
server_limits tuning_server(const sheard_config *c);
spool_tuning tuning_spool(const sheard_config *c);
reader_limits tuning_reader(const sheard_config *c); /* except the paths */
/* Return the jobs' memory budget in bytes; log a warning if the machine has less. */
int64_t tuning_memory(const sheard_config *c);
