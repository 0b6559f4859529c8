/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/store_actions.h: one call of each operation of the store, on a store with a job in
 * each state. */
#pragma once

#include "store_fixture.h"

/* Sums of a field to submit: the caller sets them to fx_sums(1) and fx_sums(2), and frees them. */
extern char *sums_1;
extern char *sums_2;

/* Jobs in an empty store: 1 is done, 2 failed, 3 waiting, 4 and 5 run, 6 is queued. */
enum { START_MS = 1000 };
void fill(fixture *f);

/* An operation on a store that fill() made; its code. */
typedef int (*action)(store *s, shear_error *err);

int act_submit(store *s, shear_error *err);

/* All operations, in the order of the pages they touch: where the failure's kind matters little,
 * the last ones do. */
enum { N_ACTIONS = 14 };
extern const action actions[N_ACTIONS];
