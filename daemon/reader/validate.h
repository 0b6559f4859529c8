/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/validate.h: check a child's replies before they are used, because the file that it reads
 * may have taken it over. */
#pragma once

#include "shear/field.h"

/* Return whether the numbers that the daemon allocates and indexes by are in range, and the name is
 * printable. The name is terminated. */
bool validate_info(shear_field_info *info);
/* Return whether a model of that field is sound, but for its samples. */
bool validate_model(const shear_psf_model *m, const shear_field_info *info);
/* Return whether a carried column can be written: its texts are printable, or numbers, and its
 * width is that of its form. The texts are terminated. */
bool validate_carried(shear_carried *c);
/* Return whether the text is a terminated checksum of hexadecimal digits. */
bool validate_checksum(const char text[SHEAR_CHECKSUM_SIZE]);
