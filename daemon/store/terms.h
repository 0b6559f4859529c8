/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/terms.h: the terms of stamps (shear/symmetry.h) beside checkpoints and contributions.
 * Within an operation. */
#ifndef SHEARD_STORE_TERMS_H
#define SHEARD_STORE_TERMS_H

#include "store/store.h"

/* SHEAR_E_INTERNAL where the bytes are no terms. */
int terms_check(const unsigned char *bytes, size_t size, shear_error *err);

/* Add those of a checkpoint, whose row is there already. */
int terms_add_checkpoint(store *s, int64_t job, const store_progress *progress, shear_error *err);

/* Add those of the contribution whose row was added last. */
int terms_add_contribution(store *s, const unsigned char *bytes, size_t size, shear_error *err);

#endif
