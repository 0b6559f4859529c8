/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/store_fill.h: creates a database of the service with many finished jobs. */
#pragma once

#include "store/store.h"

/* Create a database at `path` with `jobs` counted jobs, spread evenly over `fields` fields
 * ("field-0000000" and up), each with its attempt and its contribution. Job ids are 1 ... jobs; the
 * owner is 1000. It is not durable until it is complete. */
int store_fill(const char *path, int64_t jobs, int64_t fields, shear_error *err);

/* Return the exact sums of one synthetic file as text, to be freed by the caller; NULL if out of
 * memory. */
char *store_fill_sums(void);

/* Submit a job on field-0000000. */
int store_fill_submit(store *s, const char *source, int priority, int64_t created_ms, int64_t *id,
                      shear_error *err);
