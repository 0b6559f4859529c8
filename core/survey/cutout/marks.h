/* SPDX-License-Identifier: GPL-3.0-or-later */
/* survey/cutout/marks.h: rows of marks, a byte per pixel: not 0 if it is marked. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Set to[i], which is 0 or 1, to 1 where from[i] is marked. */
void marks_add(uint8_t *restrict to, const uint8_t *restrict from, size_t n);
/* Return whether a pixel is marked in both. */
bool marks_meet(const uint8_t *restrict one, const uint8_t *restrict other, size_t n);
