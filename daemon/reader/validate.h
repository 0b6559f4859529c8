/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/validate.h: what a child answers is checked before it is used: the child may have been
 * taken over by the file that it reads. */
#ifndef SHEARD_READER_VALIDATE_H
#define SHEARD_READER_VALIDATE_H

#include "shear/field.h"
#include "shear/input.h"

/* Numbers that the daemon will allocate and index by. Ends the name, too. */
bool validate_info(shear_field_info *info);
bool validate_checksum(const char text[SHEAR_CHECKSUM_SIZE]);

#endif
