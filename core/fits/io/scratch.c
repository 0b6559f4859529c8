/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/io/scratch.h"

#include "base/io.h"
#include "shear/field.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Files that were passed to this process, which may not create any. */
static int given[SHEAR_N_PARTS];
static int n_given;
static atomic_int next_given;

void shear_field_use_scratch(const int *fds, int n) {
    n_given = n < (int)(sizeof given / sizeof *given) ? n : (int)(sizeof given / sizeof *given);
    memcpy(given, fds, (size_t)n_given * sizeof *given);
}

static int next_scratch(sf_place at, int *out, shear_error *err) {
    const int i = atomic_fetch_add(&next_given, 1);
    if (i >= n_given) {
        return sf_fail(err, SHEAR_E_IO, at, "look at the directory for unpacked copies",
                       "there is no file for its unpacked copy");
    }
    *out = given[i];
    return SHEAR_OK;
}

int sf_scratch_open(sf_place at, int *out, shear_error *err) {
    if (n_given > 0)
        return next_scratch(at, out, err);
    const char *dir = getenv("TMPDIR");
    if (dir == NULL || dir[0] == '\0')
        dir = "/tmp";
    *out = io_open_nameless(dir);
    if (*out < 0) {
        const int number = errno;
        char doing[300];
        snprintf(doing, sizeof doing, "cannot make a temporary file in '%.200s' (TMPDIR)", dir);
        return sf_fail_errno(err, at, number, doing);
    }
    return SHEAR_OK;
}
