/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/catalog/keywords.h: the keywords of a result catalog. */
#ifndef SHEAR_FITS_CATALOG_KEYWORDS_H
#define SHEAR_FITS_CATALOG_KEYWORDS_H

#include "fits/header/cards.h"
#include "shear/catalog.h"

#include <fitsio.h>

/* Room that is kept for them, in cards, so that they do not push the rows about. */
enum { SF_CATALOG_CARDS = 160 };

/* What is known before the rows: FIELD, SIM_G1, SIM_G2. Like CFITSIO's own calls, nothing happens
 * where *status is not 0. */
void sf_catalog_write_field(fitsfile *f, const shear_field_info *info, int *status);
/* What is known behind them: the software, the input, all settings, what they resolved to, the
 * result. */
void sf_catalog_write_result(fitsfile *f, const shear_plan *plan, const shear_result *result,
                             const char *input_name, const char *checksum, int *status);

/* Read back FIELD, SIM_G1, SIM_G2, BETA, R_PSF and the result. SHEAR_E_FORMAT. */
int sf_catalog_read_header(const sf_cards *cards, shear_catalog_table *t, shear_error *err);

#endif
