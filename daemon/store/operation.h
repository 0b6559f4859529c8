/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/operation.h: atomic operations: each is a transaction of its own, or a savepoint in the
 * open group. */
#pragma once

#include "store/database.h"

#include <assert.h>

/* Assert that an operation is open. */
#define OPERATION_ASSERT_OPEN(s) assert(sqlite3_get_autocommit((s)->db) == 0)

int operation_begin(store *s, shear_error *err);
/* End an operation after a successful begin: keep its changes if `code` is SHEAR_OK, otherwise undo
 * them. Return `code`, or the error that prevents keeping them. */
int operation_end(store *s, int code, shear_error *err);

/* Run `work`, an expression that gives an error code, as one operation. The value is that code, or
 * the error of beginning or ending the operation. */
#define OPERATION(s, work, err)                                                                    \
    __extension__({                                                                                \
        const int operation_begun_ = operation_begin((s), (err));                                  \
        operation_begun_ != SHEAR_OK ? operation_begun_ : operation_end((s), (work), (err));       \
    })
