/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/metrics.h: write the status as Prometheus text. */
#pragma once

#include "server/server.h"
#include "service/rpc/status.h"

#include <stdio.h>

void metrics_write(FILE *out, const status *st, const server_statistics *net);
