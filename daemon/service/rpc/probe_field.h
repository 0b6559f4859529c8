/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/probe_field.h: write a tiny field of known shear, drawn by formula, for the probe. */
#pragma once

#include "shear/error.h"

#define PROBE_G1 0.02
#define PROBE_G2 (-0.01)
enum { PROBE_STAMPS = 16 };

/* Bound of |measured - true| per component: terms beyond second order in the shear, pixels and
 * noise contribute less. */
#define PROBE_TOLERANCE 2e-4

/* Write the field into `directory`, open it for reading, and remove its name. *fd is -1 on error.
 * Errors of shear_field_create and the other writers; SHEAR_E_IO. Waits for the disk. */
int probe_field_make(const char *directory, int *fd, shear_error *err);
