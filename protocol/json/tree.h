/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/tree.h: parse and write JSON trees, completely or not at all, also when memory runs out.
 * tree.c describes the faults of jansson that this avoids. */
#pragma once

#include <jansson.h>
#include <stddef.h>

enum tree_fault { TREE_NO_MEMORY, TREE_SYNTAX, TREE_DUPLICATE_KEY };

typedef struct tree_error {
    enum tree_fault fault;
    char text[200]; /* jansson's message, with line and column */
} tree_error;

/* Parse a text. Return a new reference, or NULL with the reason in *why. `flags` are those of
 * json_loadb. Duplicate keys are errors. \u0000 is accepted: the reader of a message refuses it, by
 * the parameter's name. */
json_t *tree_load(const char *text, size_t n, size_t flags, tree_error *why);

/* Write any value on one line (numbers with 17 digits, ASCII) or, with JSON_INDENT(n) in `flags`,
 * on several; then `tail`. The text is from malloc and terminated; *n (may be NULL) becomes its
 * length. Return NULL if out of memory or if `value` is NULL. */
char *tree_dump(const json_t *value, size_t flags, const char *tail, size_t *n);
