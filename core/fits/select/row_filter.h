/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/select/row_filter.h: which rows of a table fulfil a row expression, evaluated by CFITSIO on
 * a view of the table (view.h), in blocks of rows. */
#pragma once

#include "fits/header/table.h"

/* Evaluate the expression (expression.h) over the table's columns of one number, logical or short
 * text: selected[i], for each row, is 1 or 0; a row where it is undefined is 0. Any thread;
 * evaluations wait for each other, as CFITSIO's parser had global variables before 4.2.
 * SHEAR_E_SETTING: what is wrong with the expression; SHEAR_E_FORMAT, SHEAR_E_NOMEM. */
int sf_row_filter(const sf_table *t, const char *expression, uint8_t *selected, shear_error *err);
