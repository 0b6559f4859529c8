/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/gunzip.h: unpack a gzip file into an unlinked temporary file in $TMPDIR (or /tmp). */
#pragma once

#include "fits/io/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Return whether the bytes are the beginning of a FITS file. */
bool sf_is_fits(const unsigned char *bytes, int64_t count);
bool sf_is_gzip(const unsigned char *bytes, int64_t count);

/* Unpack the gzip file `in`. Its first bytes must be a FITS header, or, if `text` is set, '#',
 * before the rest is unpacked. On success *out is a descriptor that the caller closes, and
 * *out_size is its size in bytes. The offset of `in` is not used. SHEAR_E_FORMAT: damaged,
 * truncated, not FITS, too large; SHEAR_E_IO or SHEAR_E_FULL: the copy cannot be written;
 * SHEAR_E_NOMEM. */
int sf_gunzip(int in, sf_place at, bool text, int *out, int64_t *out_size, shear_error *err);
