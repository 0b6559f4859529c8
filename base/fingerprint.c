/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/fingerprint.h"

file_fingerprint fingerprint_of(const struct stat *st) {
    return (file_fingerprint){st->st_dev, st->st_ino, st->st_size, st->st_mtim, st->st_ctim};
}

static bool same_time(struct timespec a, struct timespec b) {
    return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

bool fingerprint_same_content(const file_fingerprint *a, const file_fingerprint *b) {
    return a->device == b->device && a->inode == b->inode && a->size == b->size &&
           same_time(a->modified, b->modified);
}

bool fingerprint_same(const file_fingerprint *a, const file_fingerprint *b) {
    return fingerprint_same_content(a, b) && same_time(a->changed, b->changed);
}

bool fingerprint_same_file(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}
