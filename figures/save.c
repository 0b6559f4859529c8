/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writing a PNG file, which appears complete or not at all. */
#include "internal.h"

#include "base/cleanup.h"
#include "base/io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char ADVICE_PLACE[] = "choose another output file or make its directory writable";

static int fail_io(shear_error *err, const char *doing, const char *path, int number) {
    return shear_fail(err, SHEAR_E_IO, ADVICE_PLACE, "cannot %s %s: %s", doing, path,
                      strerror(number));
}

static int fail_exists(shear_error *err, const char *path) {
    return shear_fail(err, SHEAR_E_EXISTS, "choose another name, or allow it to be replaced",
                      "%s exists", path);
}

/* Allow only a regular file to be replaced: renaming over a device or a pipe would remove it. */
static int check_target(const char *path, bool replace, shear_error *err) {
    struct stat st;
    if (stat(path, &st) != 0) {
        return SHEAR_OK; /* new, or a path for which open will fail */
    }
    if (!S_ISREG(st.st_mode))
        return shear_fail(err, SHEAR_E_IO, "name a file", "%s is not a regular file", path);
    return replace ? SHEAR_OK : fail_exists(err, path);
}

static cairo_status_t write_bytes(void *closure, const unsigned char *data, unsigned int length) {
    errno = io_write(*(const int *)closure, data, length);
    return errno == 0 ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static int put_in_place(const char *part, const char *path, bool replace, shear_error *err) {
    const int number = io_rename(AT_FDCWD, part, path, replace);
    if (number == EEXIST)
        return fail_exists(err, path);
    return number == 0 ? SHEAR_OK : fail_io(err, "write", path, number);
}

/* Write the image to the descriptor, sync it to disk, and close it. */
static int write_png(shear_figure *f, int fd, const char *path, shear_error *err) {
    errno = 0;
    const cairo_status_t status = cairo_surface_write_to_png_stream(f->surface, write_bytes, &fd);
    const int failed = status == CAIRO_STATUS_SUCCESS ? 0 : errno != 0 ? errno : EIO;
    const int number = io_finish(fd, failed);
    if (status == CAIRO_STATUS_NO_MEMORY)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory to write %s", path);
    return number == 0 ? SHEAR_OK : fail_io(err, "write", path, number);
}

int shear_figure_save(shear_figure *figure, const char *path, bool replace, shear_error *err) {
    if (!figure_good(figure)) {
        return shear_fail(err, figure->error.code, figure->error.advice, "%s: %s", path,
                          figure->error.message);
    }
    TRY(check_target(path, replace, err));
    CLEANUP(release_free) char *part = NULL;
    if (asprintf(&part, "%s.%ld.part", path, (long)getpid()) < 0) {
        part = NULL;
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory to write %s", path);
    }
    cairo_surface_flush(figure->surface);
    const int fd = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        return fail_io(err, "create", path, errno);
    int code = write_png(figure, fd, path, err);
    code = code != SHEAR_OK ? code : put_in_place(part, path, replace, err);
    if (code != SHEAR_OK)
        unlink(part);
    return code;
}
