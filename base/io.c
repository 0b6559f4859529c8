/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/io.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Read from `offset`, or from the descriptor's position if `offset` is negative. */
static ssize_t read_all(int fd, char *buffer, size_t size, off_t offset) {
    size_t done = 0;
    while (done < size) {
        const ssize_t n = offset < 0 ? read(fd, buffer + done, size - done)
                                     : pread(fd, buffer + done, size - done, offset + (off_t)done);
        if (n == 0)
            break;
        if (n < 0 && errno != EINTR)
            return -1;
        done += n > 0 ? (size_t)n : 0;
    }
    return (ssize_t)done;
}

ssize_t io_read(int fd, void *buffer, size_t size) {
    return read_all(fd, buffer, size, -1);
}

ssize_t io_read_at(int fd, void *buffer, size_t size, off_t offset) {
    assert(offset >= 0);
    return read_all(fd, buffer, size, offset);
}

int io_write(int fd, const void *bytes, size_t n) {
    const char *p = bytes;
    while (n > 0) {
        const ssize_t written = write(fd, p, n);
        if (written < 0 && errno == EAGAIN) {
            poll(&(struct pollfd){.fd = fd, .events = POLLOUT}, 1, -1);
        } else if (written < 0 && errno != EINTR) {
            return errno;
        }
        p += written > 0 ? written : 0;
        n -= written > 0 ? (size_t)written : 0;
    }
    return 0;
}

int io_finish(int fd, int error) {
    if (error == 0 && fsync(fd) != 0)
        error = errno;
    if (close(fd) != 0 && error == 0)
        error = errno;
    return error;
}

int io_rename(int directory, const char *from, const char *to, bool replace) {
    const int failed = replace ? renameat(directory, from, directory, to)
                               : renameat2(directory, from, directory, to, RENAME_NOREPLACE);
    if (failed == 0)
        return 0;
    if (replace || (errno != EINVAL && errno != ENOSYS))
        return errno;
    /* Not every file system supports that flag; a link does not replace a file either. */
    if (linkat(directory, from, directory, to, 0) != 0 || unlinkat(directory, from, 0) != 0)
        return errno;
    return 0;
}

int io_own_directory(char *out, size_t size) {
    const ssize_t n = readlink("/proc/self/exe", out, size);
    if (n <= 0 || (size_t)n >= size)
        return n < 0 ? errno : ENAMETOOLONG;
    out[n] = '\0';
    *strrchr(out, '/') = '\0';
    return 0;
}

int io_open_nameless(const char *directory) {
    const int fd = open(directory, O_TMPFILE | O_RDWR | O_EXCL | O_CLOEXEC, 0600);
    if (fd >= 0)
        return fd;
    /* Not every file system supports O_TMPFILE. */
    char path[4300];
    const int n = snprintf(path, sizeof path, "%s/.shear-XXXXXX", directory);
    if (n < 0 || (size_t)n >= sizeof path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    const int named = mkostemp(path, O_CLOEXEC);
    if (named >= 0)
        unlink(path);
    return named;
}
