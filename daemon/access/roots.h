/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The data roots. */
#ifndef SHEARD_ACCESS_ROOTS_H
#define SHEARD_ACCESS_ROOTS_H

#include "access/access.h"

typedef struct access_root {
    int fd; /* O_PATH */
    char *name, *canonical;
} access_root;

struct access_roots {
    access_root *roots; /* [n] */
    size_t n;
    char *names; /* all of them, for advice */
};

/* What of `path` lies beneath `root`, without leading slashes; NULL where nothing does. */
const char *path_beneath(const char *path, const char *root);
/* "..", as a component? */
bool path_climbs(const char *path);

#endif
