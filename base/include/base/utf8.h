/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/utf8.h: UTF-8, as Unicode's table 3-7 has it. */
#ifndef BASE_UTF8_H
#define BASE_UTF8_H

#include <stddef.h>
#include <stdint.h>

/* The code point that begins at `text` (ended by NUL; read no further than that) and the bytes it
 * takes, 1 to 4. 0 bytes where what is there is not well formed: a byte that begins none, a
 * sequence cut off or longer than need be, a surrogate, beyond U+10FFFF; *point is undefined then.
 */
size_t utf8_decode(const char *text, uint32_t *point);

#endif
