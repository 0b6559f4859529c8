/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear/text.h
 * Make text from outside (names, paths, messages about them) safe for a terminal or a log, by one
 * rule for all of it.
 *
 * A character is shown if it is valid UTF-8 and neither a control (C0, C1, DEL), a line or
 * paragraph separator, nor an invisible character that changes how others are shown (bidirectional
 * controls and marks, zero width, joiners, tags, soft hyphen): a name with such a character would
 * look like another name.
 */
#ifndef SHEAR_TEXT_H
#define SHEAR_TEXT_H

#include "shear/linkage.h"

#include <stddef.h>

SHEAR_BEGIN_C

/** Return the length in bytes of the character at the beginning of `text` if it is shown as it is;
 * 0 if it is not, and at the end. */
size_t shear_text_shown(const char *text);

/** Copy the text into buf[size], with '?' in place of every character that is not shown and every
 * byte that is not UTF-8. Text that does not fit is cut off between characters. Return buf. */
char *shear_text_clean(const char *text, char *buf, size_t size);

SHEAR_END_C

#endif
