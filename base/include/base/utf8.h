/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/utf8.h: decode UTF-8, as defined by table 3-7 of the Unicode standard. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Decode the code point at the beginning of `text` (ended by NUL; nothing beyond is read). Return
 * the number of its bytes, 1 to 4; or 0, with *point undefined, if it is not well formed: a byte
 * that cannot begin a sequence, a truncated or overlong sequence, a surrogate, or a value beyond
 * U+10FFFF. */
size_t utf8_decode(const char *text, uint32_t *point);
