/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/text.h: text from outside (names, paths, messages about them) on its way to a terminal or a
 * log: one rule for all of it.
 *
 * A character is shown where it is sound UTF-8 and neither a control (C0, C1, DEL), a line or
 * paragraph separator, nor one that is not seen itself but changes how others are (bidirectional
 * controls and marks, zero width, joiners, tags, soft hyphen): such a name would look like another.
 */
#ifndef SHEAR_TEXT_H
#define SHEAR_TEXT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of the character that begins at `text` where it is shown as it is; 0 where it is not, and
 * at the end. */
size_t shear_text_shown(const char *text);

/* The text into buf[size], '?' in place of each character that is not shown and of each byte that
 * is no UTF-8; what does not fit is cut off between characters. Returns buf. */
char *shear_text_clean(const char *text, char *buf, size_t size);

#ifdef __cplusplus
}
#endif

#endif
