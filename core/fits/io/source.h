/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/io/source.h: open a regular file that begins like FITS, unpacked if it is gzipped. */
#pragma once

#include "fits/io/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct sf_source {
    int fd;             /* the file, or its unpacked copy; -1 = closed */
    int64_t size;       /* size in bytes of fd's file */
    int64_t file_bytes; /* size on disk */
    bool gzipped;
    char name[161]; /* for messages: printable; of a long path, the tail */
    char base[256]; /* base name as given */
} sf_source;

/* Open `path`, or, if fd >= 0, a duplicate of the caller's descriptor, whose offset does not
 * change; `path` is then its name. SHEAR_E_IO: cannot be opened, not a regular file, no space to
 * unpack; SHEAR_E_FORMAT: empty, not FITS, bad gzip. Call sf_source_close after an error, too. */
int sf_source_open(sf_source *s, const char *path, int fd, shear_error *err);
void sf_source_close(sf_source *s);

/* Open `path`, or duplicate `fd` if it is not negative; *out is a regular file, *bytes its size.
 * SHEAR_E_IO. */
int sf_open_regular(const char *path, int fd, sf_place at, int *out, int64_t *bytes,
                    shear_error *err);
/* Format a path for messages: control characters replaced, a long path shortened from the left. */
void sf_printable_name(char *out, size_t size, const char *path);
