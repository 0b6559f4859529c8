/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/scratch.h"

#include "engine/must.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FOLDER = 480 };
static char folder[FOLDER];
static char path[FOLDER + 16];

/* Remove the files. If writing has failed, a partial file under another name remains in the
 * directory. */
static void clean_up(void) {
    DIR *d = opendir(folder);
    for (struct dirent *e = NULL; d != NULL && (e = readdir(d)) != NULL;)
        unlinkat(dirfd(d), e->d_name, 0);
    if (d != NULL)
        closedir(d);
    rmdir(folder);
}

const char *scratch_path(void) {
    if (folder[0] != '\0')
        return path;
    const char *base = getenv("TMPDIR");
    base = base != NULL && base[0] != '\0' ? base : "/tmp";
    if (snprintf(folder, sizeof folder, "%s/shear-paper-XXXXXX", base) >= FOLDER)
        must_fail(SHEAR_E_IO, NULL, "TMPDIR is too long a name");
    if (mkdtemp(folder) == NULL) {
        must_fail(SHEAR_E_IO, "set TMPDIR to a folder with room", "cannot make a folder in %s: %s",
                  base, strerror(errno));
    }
    snprintf(path, sizeof path, "%s/stamps.fits", folder);
    atexit(clean_up);
    return path;
}
