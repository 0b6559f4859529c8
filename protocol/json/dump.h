/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/dump.h: a JSON tree to bytes, complete or not at all. */
#ifndef PROTOCOL_RPC_DUMP_H
#define PROTOCOL_RPC_DUMP_H

#include <jansson.h>
#include <stddef.h>

/* Any value on one line (numbers with 17 digits), or, with JSON_INDENT(n) in `flags`, on several;
 * then `tail`. malloc'd, with a NUL; *n (may be NULL) becomes its length. NULL: out of memory, or
 * no value. */
char *rpc_dump(const json_t *value, size_t flags, const char *tail, size_t *n);

#endif
