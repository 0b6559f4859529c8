/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/terms.h: the terms of stamps (shear/symmetry.h) beside checkpoints and contributions.
 * Within an operation. */
#ifndef SHEARD_STORE_TERMS_H
#define SHEARD_STORE_TERMS_H

#include "store/store.h"

/* SHEAR_E_INTERNAL where the bytes are no terms. */
int terms_check(const unsigned char *bytes, size_t size, shear_error *err);

/* Those of a checkpoint, which is in its row already. */
int terms_save(store *s, int64_t job, const store_progress *progress, shear_error *err);

/* Those of the contribution that was added last. */
int terms_count(store *s, const unsigned char *bytes, size_t size, shear_error *err);

#endif
