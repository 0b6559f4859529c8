/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scratch.h: the name of a file that is written, read and removed again. */
#ifndef VALIDATION_SCRATCH_H
#define VALIDATION_SCRATCH_H

#include "shear/error.h"

enum { SCRATCH_PATH = 512 };

/* A file name in a new folder in $TMPDIR (else /tmp). SHEAR_E_IO; path is "" then. */
int scratch_new(char path[SCRATCH_PATH], shear_error *err);
/* Remove file and folder; "" is accepted. */
void scratch_free(const char *path);

#endif
