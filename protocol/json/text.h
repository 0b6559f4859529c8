/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/text.h: the pieces that all messages are made of. Every json_t* returned is a new reference,
 * or NULL when memory is out; objects and arrays pass such a NULL on as their own failure. */
#ifndef PROTOCOL_JSON_TEXT_H
#define PROTOCOL_JSON_TEXT_H

#include "shear/error.h"

#include <jansson.h>

/* A string; bytes that are not UTF-8 become U+FFFD. NULL gives null. */
json_t *json_text_string(const char *text);
json_t *json_text_strings(const char *const *texts, size_t n); /* an array of them */
/* A number, or null if it is not finite. */
json_t *json_text_number(double x);
/* A count, or null if it is negative. */
json_t *json_text_index(int64_t i);
/* {"NAME": count, ...} of counts[n], named by their index. */
json_t *json_text_counts(const int64_t *counts, int n, const char *(*name_of)(int));

typedef struct json_pair {
    const char *key; /* "": this pair is left out */
    json_t *value;   /* NULL: memory was out */
} json_pair;

/* The object of the pairs, in their order, up to one whose key is NULL. All references are given
 * up, also on failure.
 *
 *     JSON_OBJECT({"g1", json_text_number(g1)}, {"n", json_integer(n)}) */
json_t *json_text_object(const json_pair *pairs);
#define JSON_OBJECT(...) json_text_object((const json_pair[]){__VA_ARGS__, {NULL, NULL}})

/* Set a member, append an item; the reference is given up. If it is NULL or memory is out, the
 * object or array is released and becomes NULL, and stays so. */
void json_text_set(json_t **object, const char *key, json_t *value);
void json_text_append(json_t **array, json_t *item);

/* The object as one line, *text, which is malloc'd; the reference is given up. SHEAR_E_NOMEM, also
 * for a NULL object. */
int json_text_finish(char **text, json_t *object, shear_error *err);

/* A text that must be one object, *object: a new reference. SHEAR_E_FORMAT ("WHAT is no JSON
 * object"), SHEAR_E_NOMEM. */
int json_text_load(json_t **object, const char *text, const char *what, shear_error *err);

/* ---- Members as they are read: passed over if they are of another type ---- */

double json_text_number_at(const json_t *object, const char *key);      /* NaN */
int64_t json_text_count_at(const json_t *object, const char *key);      /* 0 */
const char *json_text_string_at(const json_t *object, const char *key); /* NULL */

/* "an object", "null": what a value is; "nothing" for NULL. */
const char *json_text_kind(const json_t *value);

#endif
