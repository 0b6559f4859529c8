/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text.h: format text for messages, help and samples. */
#pragma once

#include "sheard/config.h"

/* Describe the values of a setting: "A whole number of threads from 1 to 1024, or auto." Return
 * buf. */
char *text_expected(const sheard_setting *s, char *buf, size_t size);

/* Flush `out`. Return SHEAR_OK, or SHEAR_E_IO if anything could not be written. */
int text_flushed(FILE *out, shear_error *err);
