/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scratch.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const file = "/stamps.fits";

int scratch_new(char path[SCRATCH_PATH], shear_error *err) {
    const char *base = getenv("TMPDIR");
    base = base != NULL && base[0] ? base : "/tmp";
    path[0] = '\0';
    if (strlen(base) + 64 > SCRATCH_PATH) {
        return shear_fail(err, SHEAR_E_IO, NULL, "TMPDIR is too long a name");
    }
    snprintf(path, SCRATCH_PATH, "%s/shear-paper-XXXXXX", base);
    if (mkdtemp(path) == NULL) {
        const int code = shear_fail(err, SHEAR_E_IO, "set TMPDIR to a folder with room",
                                    "cannot make a folder in %s: %s", base, strerror(errno));
        path[0] = '\0';
        return code;
    }
    strcat(path, file);
    return SHEAR_OK;
}

void scratch_free(const char *path) {
    char folder[SCRATCH_PATH];
    if (path[0]) {
        unlink(path);
        snprintf(folder, sizeof folder, "%.*s", (int)(strlen(path) - strlen(file)), path);
        rmdir(folder);
    }
}
