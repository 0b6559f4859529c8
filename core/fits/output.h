/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/output.h: a FITS file that appears under its name only when it is complete.
 *
 * It is written as a hidden file ".sheard-PID-RANDOM.part" in the same directory, synced, and
 * renamed. CFITSIO sees only
 * "/proc/self/fd/N/.sheard-...", N being the open directory: no user's path ever reaches its
 * file-name syntax.
 */
#ifndef SHEAR_FITS_OUTPUT_H
#define SHEAR_FITS_OUTPUT_H

#include "fits/status.h"

#include <fitsio.h>
#include <stdbool.h>

typedef struct sf_output {
    fitsfile *fits;
    int directory; /* -1 = closed */
    char temporary[64];
    char base[256]; /* the name in the directory */
    char name[161]; /* for messages */
    bool overwrite;
    bool exists; /* the temporary file does */
} sf_output;

/* Begin the file; out->fits is open for writing, without an HDU. SHEAR_E_EXISTS, SHEAR_E_IO.
 * Discard it after an error. */
int sf_output_create(sf_output *out, const char *path, bool overwrite, shear_error *err);

/* Close, sync and rename. On error the temporary file is gone. SHEAR_E_EXISTS where the name was
 * taken meanwhile. */
int sf_output_commit(sf_output *out, shear_error *err);

/* Close and remove. */
void sf_output_discard(sf_output *out);

#endif
