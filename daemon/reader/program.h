/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/program.h: find the reader's program. */
#pragma once

#include "shear/error.h"

#include <stddef.h>

/* Find sheard-reader beside the running program (in a build directory), or in its install directory
 * relative to the running program. There is no compiled-in absolute path: it would be wrong once
 * the programs are packaged or moved. Return SHEAR_E_IO if it is in neither place. */
int reader_find_program(char *path, size_t size, shear_error *err);
