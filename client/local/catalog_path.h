/* SPDX-License-Identifier: GPL-3.0-or-later */
/* catalog_path.h: the paths of the result catalogs (--catalog). */
#pragma once

#include "local/measure_input.h"

/* Set inputs[].catalog of all wanted inputs, and check in advance that the catalogs can be written.
 * `out` is an existing directory (each catalog is DIRECTORY/BASE.shear.fits) or, for a single
 * input, the path of the catalog. No input is overwritten, no two inputs share a catalog, and an
 * existing file is replaced only with `force`. Returns EXIT_CODE_DONE, or another exit code if an
 * error has been printed. */
enum exit_code catalog_paths_resolve(measure_input *inputs, size_t n, const char *out, bool force);
