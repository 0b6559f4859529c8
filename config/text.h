/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text.h: words for people. */
#ifndef CONFIG_TEXT_H
#define CONFIG_TEXT_H

#include "sheard/config.h"

enum { TEXT_LINE = 78 }; /* columns */

/* Print the words of `text` from column `column` on; further lines begin with `indent`. Ends the
 * line. */
void text_wrap(FILE *out, const char *text, int column, const char *indent);

/* "A whole number of threads from 1 to 1024, or auto." Returns buf. */
char *text_expected(const sheard_setting *s, char *buf, size_t size);

/* All has reached `out`: SHEAR_OK or SHEAR_E_IO. */
int text_flushed(FILE *out, shear_error *err);

#endif
