/* SPDX-License-Identifier: GPL-3.0-or-later */
/* catalog_path.h: where the result catalogs of --catalog go. */
#ifndef CLIENT_LOCAL_CATALOG_PATH_H
#define CLIENT_LOCAL_CATALOG_PATH_H

#include "local/measure_input.h"

/* Set inputs[].catalog of all wanted inputs, and see to it, before hours of work, that they can be
 * written: `out` is an existing directory (then DIRECTORY/BASE.shear.fits each) or, for a single
 * input, the file itself. No input is overwritten, no two inputs share a catalog, and nothing
 * that exists is replaced without `force`. Returns EXIT_CODE_DONE, or the exit code of the error
 * that it has printed. */
enum exit_code catalog_paths_resolve(measure_input *inputs, size_t n, const char *out, bool force);

#endif
