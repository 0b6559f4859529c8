/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/load.h: bytes to a JSON tree, safe also where memory runs out. */
#ifndef PROTOCOL_RPC_LOAD_H
#define PROTOCOL_RPC_LOAD_H

#include "sheard/rpc.h"

#include <jansson.h>

typedef struct rpc_load_error {
    int code;       /* SHEARD_RPC_PARSE_ERROR, _DUPLICATE_KEY or _OUT_OF_MEMORY */
    char text[200]; /* jansson's words, with line and column */
} rpc_load_error;

/* A new reference, or NULL and *why. `flags` as of json_loadb; keys must differ, and \u0000 is let
 * through: msg_read refuses it by the parameter's name. */
json_t *rpc_load(const char *text, size_t n, size_t flags, rpc_load_error *why);

#endif
