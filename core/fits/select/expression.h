/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/select/expression.h: a row expression of CFITSIO, checked and made safe before CFITSIO
 * parses it.
 *
 * CFITSIO's parser opens files ('@file', gtifilter, regfilter), copies long words into buffers of
 * fixed size, and divides integers by the processor's instruction, which ends the process at
 * -2^63 / -1. So only functions of numbers are let through, words and strings of at most 60
 * characters, no vectors, and every division is made one of doubles: 7 / 2 is 3.5. An expression
 * without a column, for which it reads beyond an array, is refused. */
#pragma once

#include "fits/header/table.h"

enum {
    SF_EXPRESSION_MOST = 1000,                      /* characters */
    SF_EXPRESSION_SIZE = 5 * SF_EXPRESSION_MOST + 1 /* of the safe one */
};

/* Write the expression for CFITSIO into `safe`. SHEAR_E_SETTING: it is too long, names no
 * column, or one that the table does not have once or that does not hold one value per row, or has
 * something that is not let through. */
int sf_expression_make(const char *given, const sf_table *t, char safe[SF_EXPRESSION_SIZE],
                       shear_error *err);

/* Return whether the expression names the column, in any case. */
bool sf_expression_names(const char *given, const char *column);

/* Return whether the column can be named: it holds one value per row, and its name has at most 60
 * printable characters. */
bool sf_expression_knows(const sf_column *c);
