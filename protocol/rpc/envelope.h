/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rpc/envelope.h: what stands around every message: ids, and trees to lines. */
#ifndef PROTOCOL_RPC_ENVELOPE_H
#define PROTOCOL_RPC_ENVELOPE_H

#include "sheard/rpc.h"

#include <jansson.h>

/* False, and a null id: the value is no id. */
bool rpc_id_read(sheard_rpc_id *id, const json_t *value);
json_t *rpc_id_write(const sheard_rpc_id *id);

/* Reads `line` within `limits`. NULL and *error on failure, *id (may be NULL) then as far as it is
 * known. */
json_t *rpc_read_line(const char *line, size_t n, const sheard_rpc_limits *limits,
                      sheard_rpc_id *id, sheard_rpc_error *error);

/* {"jsonrpc": "2.0", then members up to a NULL name: const char *, json_t *, ...} as a line. Takes
 * the references; a NULL among them is want of memory. */
int rpc_write_line(char **line, size_t *n, sheard_rpc_error *error, ...);

int rpc_no_memory(sheard_rpc_error *error);

#endif
