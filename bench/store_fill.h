/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench/store_fill.h: a database of the service with many finished jobs, made in bulk. */
#ifndef BENCH_STORE_FILL_H
#define BENCH_STORE_FILL_H

#include "store/store.h"

/* A new database at `path` with `jobs` counted jobs, spread evenly over `fields` fields
 * ("field-0000000" and up), each with its attempt and its contribution. Job ids are 1 ... jobs; the
 * owner is 1000. Not durable while it is made. */
int store_fill(const char *path, int64_t jobs, int64_t fields, shear_error *err);

/* The exact sums of one made-up file, as text; malloc'd, NULL when memory is out. */
char *store_fill_sums(void);

#endif
