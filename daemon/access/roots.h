/* SPDX-License-Identifier: GPL-3.0-or-later */
/* access/roots.h: the data roots. */
#ifndef SHEARD_ACCESS_ROOTS_H
#define SHEARD_ACCESS_ROOTS_H

#include "access/access.h"

struct access_roots {
    char **names; /* [n] */
    size_t n;
    char *text; /* all of them, for advice */
};

/* The root as it is now, by O_PATH. SHEAR_OK or ACCESS_E_ROOT. */
int root_open(const char *name, int *fd, shear_error *err);

/* What of `path` lies beneath `root`, without leading slashes; NULL where nothing does. */
const char *path_beneath(const char *path, const char *root);
/* "..", as a component? */
bool path_climbs(const char *path);

#endif
