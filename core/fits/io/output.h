/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/output.h: write a FITS file that appears under its name only when it is complete.
 *
 * It is written as a hidden file ".sheard-PID-RANDOM.part" in the same directory, synced, and
 * renamed. A file that outlives its process is called ".NAME.part", so that it can be found again.
 * CFITSIO is passed only "/proc/self/fd/N/.sheard-...", where N is the open directory: no user's
 * path ever reaches its file-name syntax. */
#pragma once

#include "fits/io/status.h"

#include <fitsio.h>
#include <stdbool.h>

typedef struct sf_output {
    fitsfile *fits;
    int directory; /* -1 = closed */
    char temporary[272];
    char base[256]; /* name in the directory */
    char name[161]; /* for messages */
    bool overwrite;
    bool exists; /* the temporary file exists */
} sf_output;

/* Create the file; out->fits is open for writing, without an HDU. SHEAR_E_EXISTS, SHEAR_E_IO,
 * SHEAR_E_FULL. Call sf_output_discard after an error. */
int sf_output_create(sf_output *out, const char *path, bool overwrite, shear_error *err);

/* Close, sync and rename. SHEAR_E_EXISTS if the name was taken meanwhile. Call sf_output_discard
 * afterwards in any case. */
int sf_output_commit(sf_output *out, shear_error *err);

/* Close and remove the temporary file. */
void sf_output_discard(sf_output *out);

/* ---- files that outlive their process ---- */

/* As sf_output_create, but with a temporary file of lasting name. An existing file of either name
 * is replaced. */
int sf_output_create_kept(sf_output *out, const char *path, shear_error *err);
/* Open an existing temporary file of lasting name for writing, after `check` has examined it by the
 * path it is passed: CFITSIO reads its headers, and must not be confused by what a power failure
 * may have left. SHEAR_E_IO if there is no such file. Suspend or discard it after an error, too. */
typedef int sf_output_check(const char *path, void *context, shear_error *err);
int sf_output_reopen(sf_output *out, const char *path, sf_output_check *check, void *context,
                     shear_error *err);
/* Sync all that was written to disk, including headers; writing may continue. */
int sf_output_sync(sf_output *out, shear_error *err);
/* Close the temporary file, and keep it. */
void sf_output_suspend(sf_output *out);
/* Remove the temporary file of lasting name, if there is one. */
int sf_output_discard_kept(const char *path, shear_error *err);

/* ---- keywords ---- */

/* Write a number with the fewest digits that restore it to the last bit. Write nothing if it is not
 * finite, because FITS has no notation for that. */
void sf_output_double(fitsfile *fits, const char *key, double value, const char *comment,
                      int *status);
