/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/operation.h: an operation is all or nothing: a transaction of its own, or a savepoint in
 * the group that is open. */
#ifndef SHEARD_STORE_OPERATION_H
#define SHEARD_STORE_OPERATION_H

#include "store/database.h"

#include <assert.h>

/* Called within an operation. */
#define OPERATION_ASSERT_OPEN(s) assert(sqlite3_get_autocommit((s)->db) == 0)

int operation_begin(store *s, shear_error *err);
/* After a successful begin, always: keep what was done where `code` is SHEAR_OK, else undo it.
 * Returns `code`, or why it could not be kept. */
int operation_end(store *s, int code, shear_error *err);

/* The work, an expression that is an error code, as one operation. The code of that, or why it
 * could not begin or be kept. */
#define OPERATION(s, work, err)                                                                    \
    __extension__({                                                                                \
        const int operation_begun_ = operation_begin((s), (err));                                  \
        operation_begun_ != SHEAR_OK ? operation_begun_ : operation_end((s), (work), (err));       \
    })

#endif
