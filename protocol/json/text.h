/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json/text.h: the pieces that all messages are made of. Every json_t* returned is a new reference,
 * or NULL where there is no memory; json_object_set_new and json_array_append_new pass such a NULL
 * on as their own failure. */
#ifndef PROTOCOL_JSON_TEXT_H
#define PROTOCOL_JSON_TEXT_H

#include "shear/error.h"
#include "shear/plan.h"
#include "shear/settings.h"

#include <jansson.h>

/* A string; bytes that are not UTF-8 become U+FFFD. NULL gives null. */
json_t *json_text_string(const char *text);
json_t *json_text_strings(const char *const *texts, size_t n); /* an array of them */
/* A number, or null where it is not finite. */
json_t *json_text_number(double x);
/* {"NAME": value, ...} for every setting of the table, in native types, "auto" as a string. */
json_t *json_text_settings(const shear_settings *s);
/* {"interpolation", "oversample", "beta_px", ...}; null for NULL. */
json_t *json_text_plan(const shear_plan_info *plan);
json_t *json_text_psf(const shear_psf_summary *psf); /* NULL: null */

/* Set a member and keep the books: `*failed` becomes true, and stays so, where value or memory is
 * missing. */
void json_text_set(json_t *object, const char *key, json_t *value, bool *failed);

/* The object, or, where its making failed, NULL (and the reference is given up). */
json_t *json_text_whole(json_t *object, bool failed);

/* The object as one line; the reference is given up. `failed` as left by json_text_set. */
int json_text_finish(char **text, json_t *object, bool failed, shear_error *err);

#endif
