/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/store_audit.h: is a database sound, and consistent? Both checks read all of it. */
#pragma once

#include "store/store.h"

/* Check that every page is well formed (SQLite's quick_check). SHEAR_E_FORMAT if one is not. */
int store_check(store *s, shear_error *err);
/* Check that all agrees: the counts with the jobs, each counted job with one contribution, each
 * field's sums with the exact join of its contributions. SHEAR_E_FORMAT if something does not. */
int store_audit(store *s, shear_error *err);
