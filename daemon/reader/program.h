/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/program.h: where the reader's program is. */
#ifndef SHEARD_READER_PROGRAM_H
#define SHEARD_READER_PROGRAM_H

#include "shear/error.h"

#include <stddef.h>

/* The path of sheard-reader: beside the running program (a build directory), or where it is
 * installed, seen from there. Nothing else is looked at: a directory that was compiled in would be
 * wrong once the programs are in a package, or were moved. SHEAR_E_IO where it is in neither. */
int reader_find_program(char *path, size_t size, shear_error *err);

#endif
