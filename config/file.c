/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Read until the end or `most` bytes; the number of bytes, or -1. */
static ssize_t read_up_to(int fd, char *buf, size_t most) {
    size_t n = 0;
    while (n < most) {
        ssize_t got = read(fd, buf + n, most - n);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            return -1;
        }
        if (got == 0) {
            break;
        }
        n += (size_t)got;
    }
    return (ssize_t)n;
}

static int check_kind(int fd, shear_error *err) {
    struct stat st;
    if (fstat(fd, &st) != 0) {
        return shear_fail(err, SHEAR_E_IO, NULL, "cannot be examined: %s", strerror(errno));
    }
    if (!S_ISREG(st.st_mode)) {
        return shear_fail(err, SHEAR_E_IO, "give the path of a configuration file",
                          "is not a regular file");
    }
    return SHEAR_OK;
}

static int read_all(int fd, char **text, size_t *size, shear_error *err) {
    int code = check_kind(fd, err);
    if (code != SHEAR_OK) {
        return code;
    }
    /* One byte more than allowed, to see whether there is more. */
    char *buf = malloc(CONFIG_FILE_MAX + 1);
    if (buf == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the configuration");
    }
    ssize_t n = read_up_to(fd, buf, CONFIG_FILE_MAX + 1);
    if (n < 0 || n > CONFIG_FILE_MAX) {
        code = n < 0 ? shear_fail(err, SHEAR_E_IO, NULL, "cannot be read: %s", strerror(errno))
                     : shear_fail(err, SHEAR_E_IO, "is this the configuration?",
                                  "is larger than %d bytes", (int)CONFIG_FILE_MAX);
        free(buf);
        return code;
    }
    *text = buf;
    *size = (size_t)n;
    return SHEAR_OK;
}

int file_read(const char *path, bool may_miss, char **text, size_t *size, shear_error *err) {
    *text = NULL;
    *size = 0;
    /* Not blocked by a FIFO that nobody writes to. */
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (fd < 0 && errno == ENOENT && may_miss) {
        return SHEAR_OK;
    }
    if (fd < 0) {
        return shear_fail(err, SHEAR_E_IO,
                          errno == ENOENT ? "without --config, the defaults are used" : NULL,
                          "cannot be opened: %s", strerror(errno));
    }
    int code = read_all(fd, text, size, err);
    close(fd);
    return code;
}
