/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/io.h: whole reads and writes of descriptors; a signal does not end them (EINTR). */
#ifndef BASE_IO_H
#define BASE_IO_H

#include <stddef.h>
#include <sys/types.h>

/* Read until `size` bytes or the end. Returns the bytes read, fewer only at the end, or -1 with
 * errno set. */
ssize_t io_read(int fd, void *buffer, size_t size);

/* The same from `offset` of the file, whose position stays. */
ssize_t io_read_at(int fd, void *buffer, size_t size, off_t offset);

/* Write all. A descriptor that does not block is waited for. Returns 0 or errno. */
int io_write(int fd, const void *bytes, size_t n);

/* Bring what was written to the disk, if `error` is 0, and close the descriptor, whatever it is.
 * Returns `error`, or else 0 or errno. */
int io_finish(int fd, int error);

/* A file without a name in `directory`, open for reading and writing, gone when it is closed.
 * Returns a descriptor (close-on-exec), or -1 with errno set. */
int io_open_nameless(const char *directory);

#endif
