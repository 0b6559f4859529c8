/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/source.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "fits/io/gunzip.h"
#include "shear/text.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void sf_printable_name(char *out, size_t size, const char *path) {
    const size_t length = strlen(path);
    if (length < size) {
        shear_text_clean(path, out, size);
        return;
    }
    const char *tail = path + length - (size - 4);
    while ((*tail & 0xc0) == 0x80) { /* do not begin inside a character */
        tail++;
    }
    memcpy(out, "...", 4);
    shear_text_clean(tail, out + 3, size - 3);
}

static const char *kind_of(mode_t mode) {
    if (S_ISDIR(mode))
        return "a directory";
    if (S_ISFIFO(mode))
        return "a FIFO (named pipe)";
    if (S_ISSOCK(mode))
        return "a socket";
    return "a device";
}

static int open_path(const char *path, sf_place at, int *out, shear_error *err) {
    /* O_NONBLOCK: opening a FIFO without a writer must not block. */
    *out = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (*out >= 0)
        return SHEAR_OK;
    return errno == ENXIO ? sf_fail(err, SHEAR_E_IO, at, "give a regular file",
                                    "is a socket or a device, not a regular file")
                          : sf_fail_errno(err, at, errno, "cannot be opened");
}

/* The duplicate has the same offset, so only pread is used. */
static int duplicate(int fd, sf_place at, int *out, shear_error *err) {
    const int mode = fcntl(fd, F_GETFL);
    if (mode < 0)
        return sf_fail_errno(err, at, errno, "its descriptor cannot be used");
    if ((mode & O_ACCMODE) == O_WRONLY || (mode & O_PATH) != 0)
        return sf_fail(err, SHEAR_E_IO, at, NULL, "its descriptor is not open for reading");
    *out = fcntl(fd, F_DUPFD_CLOEXEC, 0);
    return *out >= 0 ? SHEAR_OK : sf_fail_errno(err, at, errno, "cannot be duplicated");
}

int sf_open_regular(const char *path, int fd, sf_place at, int *out, int64_t *bytes,
                    shear_error *err) {
    struct stat st;
    CLEANUP(release_fd) int opened = -1;
    TRY(fd >= 0 ? duplicate(fd, at, &opened, err) : open_path(path, at, &opened, err));
    if (fstat(opened, &st) != 0)
        return sf_fail_errno(err, at, errno, "cannot be examined");
    if (!S_ISREG(st.st_mode)) {
        return sf_fail(err, SHEAR_E_IO, at, "give a regular file", "is %s, not a regular file",
                       kind_of(st.st_mode));
    }
    *bytes = st.st_size;
    *out = opened;
    opened = -1;
    return SHEAR_OK;
}

/* Unpack the file if it is gzipped; then s->fd must begin like FITS. */
static int look_inside(sf_source *s, shear_error *err) {
    const sf_place at = {s->name, NULL};
    unsigned char head[16];
    const ssize_t n = pread(s->fd, head, sizeof head, 0);
    if (n < 0)
        return sf_fail_errno(err, at, errno, "cannot be read");
    if (n == 0)
        return sf_fail(err, SHEAR_E_FORMAT, at, NULL, "is empty (0 bytes)");
    if (sf_is_gzip(head, n)) {
        int unpacked = -1;
        TRY(sf_gunzip(s->fd, at, false, &unpacked, &s->size, err));
        close(s->fd);
        s->fd = unpacked;
        s->gzipped = true;
    } else if (!sf_is_fits(head, n)) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "it must be FITS, or FITS packed with gzip",
                       "not a FITS file: it does not begin with 'SIMPLE  ='");
    }
    return SHEAR_OK;
}

int sf_source_open(sf_source *s, const char *path, int fd, shear_error *err) {
    const char *slash = strrchr(path, '/');
    *s = (sf_source){.fd = -1};
    sf_printable_name(s->name, sizeof s->name, path);
    text_set(s->base, sizeof s->base, slash != NULL ? slash + 1 : path);
    TRY(sf_open_regular(path, fd, (sf_place){s->name, NULL}, &s->fd, &s->file_bytes, err));
    s->size = s->file_bytes;
    return look_inside(s, err);
}

void sf_source_close(sf_source *s) {
    release_fd(&s->fd);
    s->fd = -1;
}
