/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scratch.h: a temporary file. */
#pragma once

/* Return a file name in a new directory in $TMPDIR (or /tmp), the same at every call. File and
 * directory are removed when the program ends, also by must_fail. */
const char *scratch_path(void);
