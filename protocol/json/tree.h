/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/tree.h: bytes to a JSON tree and back, complete or not at all, also when memory runs out.
 * (What jansson itself gets wrong then is told in the source.) */
#ifndef PROTOCOL_JSON_TREE_H
#define PROTOCOL_JSON_TREE_H

#include <jansson.h>
#include <stddef.h>

enum tree_fault { TREE_NO_MEMORY, TREE_SYNTAX, TREE_DUPLICATE_KEY };

typedef struct tree_error {
    enum tree_fault fault;
    char text[200]; /* jansson's words, with line and column */
} tree_error;

/* A new reference, or NULL and *why. `flags` as of json_loadb. Keys must differ. \u0000 is let
 * through: the reader of a message refuses it by the parameter's name. */
json_t *tree_load(const char *text, size_t n, size_t flags, tree_error *why);

/* Any value on one line (numbers with 17 digits, ASCII), or, with JSON_INDENT(n) in `flags`, on
 * several; then `tail`. malloc'd, ended by a NUL; *n (may be NULL) becomes its length. NULL: memory
 * is out, or there is no value. */
char *tree_dump(const json_t *value, size_t flags, const char *tail, size_t *n);

#endif
