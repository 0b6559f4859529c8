/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/source.h: an open regular file that begins like FITS, unpacked where it was gzipped. */
#ifndef SHEAR_FITS_IO_SOURCE_H
#define SHEAR_FITS_IO_SOURCE_H

#include "fits/io/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct sf_source {
    int fd;             /* the file, or its unpacked copy; -1 = closed */
    int64_t size;       /* bytes behind fd */
    int64_t file_bytes; /* as on disk */
    bool gzipped;
    char name[161]; /* for messages: printable, a long path's tail */
    char base[256]; /* base name as given */
} sf_source;

/* SHEAR_E_IO: cannot be opened, no regular file, no room to unpack; SHEAR_E_FORMAT: empty, not
 * FITS, bad gzip. Close it, also after an error. */
int sf_source_open(sf_source *s, const char *path, shear_error *err);
/* Of the caller's descriptor, which keeps its offset and stays his. */
int sf_source_open_fd(sf_source *s, int fd, const char *name, shear_error *err);
void sf_source_close(sf_source *s);

/* Open `path` for reading; *fd is a regular file, *bytes its size. */
int sf_open_regular(const char *path, sf_place at, int *fd, int64_t *bytes, shear_error *err);
/* *bytes is the size of the regular file `fd`. */
int sf_check_regular(int fd, sf_place at, int64_t *bytes, shear_error *err);
/* A path as messages show it: control characters replaced, a long one shortened from the left. */
void sf_printable_name(char *out, size_t size, const char *path);

#endif
