/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/fingerprint.h: a file's fingerprint, by which a change of it is noticed. */
#pragma once

#include <stdbool.h>
#include <sys/stat.h>

typedef struct file_fingerprint {
    dev_t device;
    ino_t inode;
    off_t size;
    struct timespec modified, changed;
} file_fingerprint;

file_fingerprint fingerprint_of(const struct stat *st);
/* Return true if it is the same file with, as far as can be seen, the same content. It may have
 * been renamed, or its owner or mode changed; fingerprint_same excludes these, too. */
bool fingerprint_same_content(const file_fingerprint *a, const file_fingerprint *b);
bool fingerprint_same(const file_fingerprint *a, const file_fingerprint *b);

/* Return whether both are the same file, whatever its content. */
bool fingerprint_same_file(const struct stat *a, const struct stat *b);
