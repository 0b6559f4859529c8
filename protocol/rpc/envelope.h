/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rpc/envelope.h: what stands around every message: ids, and trees to lines and texts. */
#ifndef PROTOCOL_RPC_ENVELOPE_H
#define PROTOCOL_RPC_ENVELOPE_H

#include "sheard/rpc.h"
#include "json/text.h"

#include <jansson.h>

/* False, and a null id: the value is no id. */
bool rpc_id_read(sheard_rpc_id *id, const json_t *value);
json_t *rpc_id_write(const sheard_rpc_id *id);

/* Is it {"jsonrpc": "2.0", ...}? */
bool rpc_is_2_0(const json_t *root);

/* Reads `line` within `limits`. NULL and *error on failure, *id (may be NULL) then as far as it is
 * known. */
json_t *rpc_read_line(const char *line, size_t n, const sheard_rpc_limits *limits,
                      sheard_rpc_id *id, sheard_rpc_error *error);
/* The same, which must be an object: "WHAT must be one object". */
json_t *rpc_read_object(const char *text, size_t n, const sheard_rpc_limits *limits,
                        const char *what, sheard_rpc_error *error);

/* The object, {"jsonrpc": "2.0", ...}, as a line. Takes the reference; NULL is want of memory. */
int rpc_write_line(char **line, size_t *n, json_t *object, sheard_rpc_error *error);
/* Any value as text: see tree_dump; *n may be NULL. Takes the reference. A NULL value has its error
 * already. */
int rpc_write_text(char **text, size_t *n, json_t *value, size_t flags, const char *tail,
                   sheard_rpc_error *error);

#endif
