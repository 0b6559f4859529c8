/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/roots.h: the data roots, and which part of a path lies beneath one. */
#pragma once

#include "access/access.h"

struct access_roots {
    sheard_list names;
    char *text; /* all names, for messages */
};

/* Open the root as it is now, with O_PATH. Return SHEAR_OK or ACCESS_E_ROOT. */
int root_open(const char *name, int *fd, shear_error *err);

/* Return the part of `path` beneath `root`, without leading slashes, or NULL if it is not beneath.
 */
const char *path_beneath(const char *path, const char *root);
/* Return whether a component is "..". */
bool path_climbs(const char *path);
