/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/directory.h: make a directory if it is missing. */
#pragma once

#include "shear/error.h"

#include <sys/types.h>

/* Make the directory, unless it exists. SHEAR_E_IO. */
int directory_make(const char *path, mode_t mode, shear_error *err);
