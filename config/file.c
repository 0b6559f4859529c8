/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "file.h"

#include "base/cleanup.h"
#include "base/io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int check_kind(int fd, shear_error *err) {
    struct stat st;
    if (fstat(fd, &st) != 0)
        return shear_fail(err, SHEAR_E_IO, NULL, "cannot be examined: %s", strerror(errno));
    if (!S_ISREG(st.st_mode)) {
        return shear_fail(err, SHEAR_E_IO, "give the path of a configuration file",
                          "is not a regular file");
    }
    return SHEAR_OK;
}

static int read_all(int fd, char **text, size_t *size, shear_error *err) {
    /* One byte more than allowed, to detect a larger file. */
    CLEANUP(release_free) char *buf = malloc(CONFIG_FILE_MAX + 1);
    if (buf == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the configuration");
    const ssize_t n = io_read(fd, buf, CONFIG_FILE_MAX + 1);
    if (n < 0)
        return shear_fail(err, SHEAR_E_IO, NULL, "cannot be read: %s", strerror(errno));
    if (n > CONFIG_FILE_MAX) {
        return shear_fail(err, SHEAR_E_IO, "is this the configuration?", "is larger than %d bytes",
                          (int)CONFIG_FILE_MAX);
    }
    *text = CLEANUP_TAKE(buf);
    *size = (size_t)n;
    return SHEAR_OK;
}

int file_read(const char *path, bool may_miss, char **text, size_t *size, shear_error *err) {
    *text = NULL;
    *size = 0;
    /* O_NONBLOCK: do not wait for a writer if the path is a FIFO. */
    CLEANUP(release_fd) int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (fd < 0 && errno == ENOENT && may_miss)
        return SHEAR_OK;
    if (fd < 0) {
        return shear_fail(err, SHEAR_E_IO,
                          errno == ENOENT ? "without --config, the defaults are used" : NULL,
                          "cannot be opened: %s", strerror(errno));
    }
    TRY(check_kind(fd, err));
    return read_all(fd, text, size, err);
}
