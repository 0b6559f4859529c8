/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/rpc/probe_field.h: a tiny field whose shear is known, drawn by formula: for measuring
 * that the service can measure. */
#ifndef SHEARD_SERVICE_PROBE_FIELD_H
#define SHEARD_SERVICE_PROBE_FIELD_H

#include "shear/error.h"

#define PROBE_G1 0.02
#define PROBE_G2 (-0.01)
enum { PROBE_STAMPS = 16 };

/* What is measured of it differs from these by less: by what is beyond second order in the shear,
 * the pixels and the noise. */
#define PROBE_TOLERANCE 2e-4

/* Write it into `directory`, open it for reading, and remove its name. Any errors of
 * shear_field_create and its kin; SHEAR_E_IO. Waits for the disk. */
int probe_field_make(const char *directory, int *fd, shear_error *err);

#endif
