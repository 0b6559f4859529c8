/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/fingerprint.h: what tells whether a file was touched. */
#ifndef SHEARD_SPOOL_FINGERPRINT_H
#define SHEARD_SPOOL_FINGERPRINT_H

#include <stdbool.h>
#include <sys/stat.h>

typedef struct file_fingerprint {
    dev_t device;
    ino_t inode;
    off_t size;
    struct timespec modified, changed;
} file_fingerprint;

file_fingerprint fingerprint_of(const struct stat *st);
/* The same file with, as far as can be seen, the same content; its owner or mode may have changed,
 * and it may have been renamed. */
bool fingerprint_same_content(const file_fingerprint *a, const file_fingerprint *b);
bool fingerprint_same(const file_fingerprint *a, const file_fingerprint *b);

#endif
