/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rpc/envelope.h: read and write what all messages share: the id, and the conversion between trees
 * and lines. */
#pragma once

#include "sheard/rpc.h"
#include "json/text.h"

#include <jansson.h>

/* Read an id. Return false, with a null id, if the value is not an id. */
bool rpc_id_read(sheard_rpc_id *id, const json_t *value);
json_t *rpc_id_write(const sheard_rpc_id *id);

/* Return whether it is {"jsonrpc": "2.0", ...}. */
bool rpc_is_2_0(const json_t *root);

/* Parse `line` within `limits`. Return NULL with *error on failure; *id (may be NULL) is then set
 * if it could be read. */
json_t *rpc_read_line(const char *line, size_t n, const sheard_rpc_limits *limits,
                      sheard_rpc_id *id, sheard_rpc_error *error);
/* The same for a text that must be an object: "WHAT must be one object". */
json_t *rpc_read_object(const char *text, size_t n, const sheard_rpc_limits *limits,
                        const char *what, sheard_rpc_error *error);

/* Write the object {"jsonrpc": "2.0", ...} as a line, and take over the reference; NULL means out
 * of memory. */
int rpc_write_line(char **line, size_t *n, json_t *object, sheard_rpc_error *error);
/* Write any value as text: see tree_dump; *n may be NULL. The reference is taken over. If the value
 * is NULL, *error is already set. */
int rpc_write_text(char **text, size_t *n, json_t *value, size_t flags, const char *tail,
                   sheard_rpc_error *error);
