/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rpc/scan.h: check the limits of a line and find its id, before anything is allocated for it. */
#pragma once

#include "sheard/rpc.h"

typedef struct rpc_scan {
    size_t id_at, id_end; /* position of the value of the outermost object's "id" */
    int n_ids;            /* number of such members; the id is known only if 1 */
} rpc_scan;

/* Scan a line. Return SHEARD_RPC_OK, _LINE_TOO_LONG, _NUL_BYTE or _TOO_COMPLEX. *scan is filled in
 * any case. */
int rpc_scan_line(rpc_scan *scan, const char *line, size_t n, const sheard_rpc_limits *limits,
                  sheard_rpc_error *error);
