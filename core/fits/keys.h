/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/keys.h: optional keywords of an open HDU. A keyword without a value counts as not there. */
#ifndef SHEAR_FITS_KEYS_H
#define SHEAR_FITS_KEYS_H

#include "fits/status.h"

#include <fitsio.h>
#include <stdbool.h>
#include <stdint.h>

/* *found tells whether the keyword is there; the value is left alone where it is not.
 * SHEAR_E_FORMAT: the value is no finite number; no integer in [min, max]; no string that fits. */
int sf_key_double(fitsfile *fits, sf_place at, const char *key, double *value, bool *found,
                  shear_error *err);
int sf_key_int(fitsfile *fits, sf_place at, const char *key, int64_t min, int64_t max,
               int64_t *value, bool *found, shear_error *err);
/* Strings may continue over several cards; *text is malloc'd, NULL where not found. */
int sf_key_string(fitsfile *fits, sf_place at, const char *key, char **text, shear_error *err);

/* Write a number with as few digits as give it back to the last bit; nothing where it is not
 * finite, which FITS cannot say. */
void sf_write_double(fitsfile *fits, const char *key, double value, const char *comment,
                     int *status);

#endif
