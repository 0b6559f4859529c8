/* SPDX-License-Identifier: GPL-3.0-or-later */
/* catalog_fixture.h: what result catalogs are made of in tests. */
#pragma once

#include "shear/catalog.h"

enum { CATALOG_ROWS = 11 };

/* Group set-up and tear-down: fits_fixture.h's directory, and a plan. */
int catalog_setup(void **state);
int catalog_teardown(void **state);
extern shear_plan *catalog_plan;

shear_field_info catalog_info(int64_t n, unsigned columns);
/* Row i: different everywhere, in all bits of a double; each fourth is flagged. */
shear_row catalog_row(int64_t i);
shear_result catalog_result(int64_t n);
