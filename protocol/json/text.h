/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/text.h: make and read JSON values, with failures carried to the end.
 *
 * Every json_t* returned is a new reference, or NULL if out of memory. Objects and arrays that are
 * given such a NULL become NULL themselves. */
#pragma once

#include "shear/error.h"

#include <jansson.h>

/* Make a string; bytes that are not UTF-8 become U+FFFD, and NULL becomes null. */
json_t *json_text_string(const char *text);
json_t *json_text_strings(const char *const *texts, size_t n); /* an array of strings */
/* Make a number, or null if it is not finite. */
json_t *json_text_number(double x);
/* Make a count, or null if it is negative. */
json_t *json_text_index(int64_t i);
/* Make {"NAME": count, ...} of counts[n], named by their index. */
json_t *json_text_counts(const int64_t *counts, int n, const char *(*name_of)(int));

typedef struct json_pair {
    const char *key; /* "": the pair is left out */
    json_t *value;   /* NULL: out of memory */
} json_pair;

/* Make the object of the pairs, in their order, up to one whose key is NULL. All references are
 * taken over, also on failure. Example: JSON_OBJECT({"g1", json_text_number(g1)}, {"n",
 * json_integer(n)}) */
json_t *json_text_object(const json_pair *pairs);
#define JSON_OBJECT(...) json_text_object((const json_pair[]){__VA_ARGS__, {NULL, NULL}})

/* Set a member or append an item, and take over its reference. If the item is NULL or memory is
 * out, the object or array is released and becomes NULL; further calls leave it so. */
void json_text_set(json_t **object, const char *key, json_t *value);
void json_text_append(json_t **array, json_t *item);

/* Write the object as one line to *text, from malloc, and take over the reference. Return SHEAR_OK,
 * or SHEAR_E_NOMEM, also for a NULL object. */
int json_text_finish(char **text, json_t *object, shear_error *err);

/* Parse a text that must be one object; *object is a new reference. Return SHEAR_OK, SHEAR_E_FORMAT
 * ("WHAT is no JSON object") or SHEAR_E_NOMEM. */
int json_text_load(json_t **object, const char *text, const char *what, shear_error *err);

/* ---- Reading members; one of another type counts as absent ---- */

double json_text_number_at(const json_t *object, const char *key);      /* NaN if absent */
int64_t json_text_count_at(const json_t *object, const char *key);      /* 0 if absent */
const char *json_text_string_at(const json_t *object, const char *key); /* NULL if absent */

/* Return the type of a value in words, such as "an object" or "null"; "nothing" for NULL. */
const char *json_text_kind(const json_t *value);
