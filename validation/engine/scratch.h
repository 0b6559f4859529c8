/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scratch.h: the name of a file that is written and read again. */
#ifndef VALIDATION_SCRATCH_H
#define VALIDATION_SCRATCH_H

/* A file name in a new folder in $TMPDIR (else /tmp), the same at every call. File and folder are
 * removed when the program ends, also by must_fail. */
const char *scratch_path(void);

#endif
