/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/catalog/keywords.h: write and read the keywords of a result catalog. */
#pragma once

#include "fits/header/cards.h"
#include "shear/catalog.h"

#include <fitsio.h>

/* Header cards that are reserved for them, so that writing them does not move the rows. */
enum { SF_CATALOG_CARDS = 160 };

/* Write what is known before the rows: FIELD, SIM_G1, SIM_G2. As in CFITSIO's own calls, nothing
 * happens if *status is not 0. */
void sf_catalog_write_field(fitsfile *f, const shear_field_info *info, int *status);
/* Write what is known after the rows: the software, the input, all settings, their resolved values,
 * the result. */
void sf_catalog_write_result(fitsfile *f, const shear_plan *plan, const shear_result *result,
                             const char *input_name, const char *checksum, int *status);

/* Read back FIELD, SIM_G1, SIM_G2, BETA, R_PSF and the result. SHEAR_E_FORMAT. */
int sf_catalog_read_header(const sf_cards *cards, shear_catalog_table *t, shear_error *err);
