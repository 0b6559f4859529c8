/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/directory.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

int directory_make(const char *path, mode_t mode, shear_error *err) {
    if (mkdir(path, mode) == 0 || errno == EEXIST)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_IO, "create it, or set another directory",
                      "cannot make the directory '%s': %s", path, strerror(errno));
}
