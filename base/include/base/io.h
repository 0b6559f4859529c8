/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/io.h: complete reads and writes of descriptors, continued after a signal (EINTR), and files
 * that appear under their name at once. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* Read until `size` bytes or the end of the file. Return the bytes read, fewer only at the end, or
 * -1 with errno set. */
ssize_t io_read(int fd, void *buffer, size_t size);

/* The same from `offset` of the file, without moving its position. */
ssize_t io_read_at(int fd, void *buffer, size_t size, off_t offset);

/* Write all n bytes, waiting if the descriptor does not block. Return 0 or errno. */
int io_write(int fd, const void *bytes, size_t n);

/* Sync the file to disk if `error` is 0, and close the descriptor in any case. Return `error`, or
 * else 0 or errno. */
int io_finish(int fd, int error);

/* Rename a file within `directory` (AT_FDCWD: two paths), to a name that must be free unless
 * `replace` is set. Return 0 or errno, EEXIST if the name is taken. */
int io_rename(int directory, const char *from, const char *to, bool replace);

/* Write the directory of the running program into out[size]. Return 0 or errno. */
int io_own_directory(char *out, size_t size);

/* Open a nameless file in `directory` for reading and writing; it is gone when it is closed. Return
 * a descriptor (close-on-exec), or -1 with errno set. */
int io_open_nameless(const char *directory);
