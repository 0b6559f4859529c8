/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/operation.h: an operation is all or nothing: a transaction of its own, or a savepoint in
 * the group that is open. */
#ifndef SHEARD_STORE_OPERATION_H
#define SHEARD_STORE_OPERATION_H

#include "store/database.h"

int operation_begin(store *s, shear_error *err);
/* After a successful begin, always: keep what was done where `code` is SHEAR_OK, else undo it.
 * Returns `code`, or why it could not be kept. */
int operation_end(store *s, int code, shear_error *err);

#endif
