/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/terms.h: the terms of stamps (shear/symmetry.h) of checkpoints and contributions. Call
 * within an operation. */
#pragma once

#include "store/store.h"

/* Check that the bytes are terms, or NULL; otherwise SHEAR_E_INTERNAL. */
int terms_check(const unsigned char *bytes, size_t size, shear_error *err);

/* Add the terms of a checkpoint whose row has been added. */
int terms_add_checkpoint(store *s, int64_t job, const store_progress *progress, shear_error *err);

/* Add the terms of the contribution whose row was added last. */
int terms_add_contribution(store *s, const unsigned char *bytes, size_t size, shear_error *err);
