/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text.h: numbers and tables as text in figures. */
#pragma once

#include "shear_figures/figure.h"

#include <stddef.h>

enum { PLOT_TABLE_ROWS = 16, PLOT_CELL = 96 };

/* Two columns of text for shear_figure_table. Rows that do not fit are dropped. */
typedef struct plot_table {
    int n;
    char keys[PLOT_TABLE_ROWS][PLOT_CELL];
    char values[PLOT_TABLE_ROWS][PLOT_CELL];
} plot_table;

/* Add a row. The value is formatted as by printf, with real minus signs. */
void plot_table_add(plot_table *t, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void plot_table_draw(const plot_table *t, shear_figure *f, shear_rect cell, const char *title);

/* Format as snprintf does, with a hyphen before a digit replaced by a minus sign (U+2212). Returns
 * buf. */
char *plot_print(char *buf, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
