/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/output.h: a FITS file that appears under its name only when it is complete.
 *
 * It is written as a hidden file ".sheard-PID-RANDOM.part" in the same directory, synced, and
 * renamed. One that is to outlive its process is ".NAME.part", so that it can be found again.
 * CFITSIO sees only "/proc/self/fd/N/.sheard-...", N being the open directory: no user's path ever
 * reaches its file-name syntax.
 */
#ifndef SHEAR_FITS_IO_OUTPUT_H
#define SHEAR_FITS_IO_OUTPUT_H

#include "fits/io/status.h"

#include <fitsio.h>
#include <stdbool.h>

typedef struct sf_output {
    fitsfile *fits;
    int directory; /* -1 = closed */
    char temporary[272];
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

/* ---- files that outlive their process ---- */

/* As sf_output_create, replacing what is there, with a temporary file of lasting name; one that is
 * there is replaced as well. */
int sf_output_create_kept(sf_output *out, const char *path, shear_error *err);
/* The one that is there, open for writing, after `check` has looked at it by a path of its own:
 * CFITSIO reads its headers, and what a power failure may have left of it must not confuse it.
 * SHEAR_E_IO if there is no such file. Leave or discard it after an error, too. */
typedef int sf_output_check(const char *path, void *context, shear_error *err);
int sf_output_reopen(sf_output *out, const char *path, sf_output_check *check, void *context,
                     shear_error *err);
/* Bring all that was written to disk, headers and all; it goes on being written. */
int sf_output_sync(sf_output *out, shear_error *err);
/* Close, and let it stay. */
void sf_output_suspend(sf_output *out);
/* Remove the temporary file of lasting name, where there is one. */
int sf_output_discard_kept(const char *path, shear_error *err);

#endif
