/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/program.h"

#include "base/io.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Paths relative to the running program's directory. READER_FROM_DAEMON leads from the installed
 * daemon's directory to the installed reader. */
static const char *const places[] = {"sheard-reader", READER_FROM_DAEMON};
enum { N_PLACES = sizeof places / sizeof places[0] };

int reader_find_program(char *path, size_t size, shear_error *err) {
    char directory[PATH_MAX];
    const int error = io_own_directory(directory, sizeof directory);
    if (error != 0) {
        return shear_fail(err, SHEAR_E_IO, "mount /proc, which sheard needs",
                          "/proc/self/exe cannot be read: %s", strerror(error));
    }
    for (int i = 0; i < N_PLACES; i++) {
        const int n = snprintf(path, size, "%s/%s", directory, places[i]);
        if (n > 0 && (size_t)n < size && access(path, X_OK) == 0)
            return SHEAR_OK;
    }
    return shear_fail(
        err, SHEAR_E_IO, "install sheard again: no file can be read without this program",
        "sheard-reader is neither in %s nor at %s/%s", directory, directory, READER_FROM_DAEMON);
}
