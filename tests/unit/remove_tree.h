/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/remove_tree.h: remove a test's directory. */
#pragma once

#include <ftw.h>
#include <stdio.h>

static inline int remove_entry(const char *path, const struct stat *st, int type,
                               struct FTW *where) {
    (void)st;
    (void)type;
    (void)where;
    return remove(path);
}

/* Remove a directory and all in it. Return 0, or not if something is left. */
static inline int remove_tree(const char *directory) {
    return nftw(directory, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}
