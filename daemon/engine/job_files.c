/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/job_files.h"

#include "base/cleanup.h"
#include "engine/engine.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static bool copy(const char **to, const char *from) {
    *to = from != NULL ? strdup(from) : NULL;
    return from == NULL || *to != NULL;
}

bool job_files_acquire(job_files *f, const shear_input *input, const int *fds) {
    *f = (job_files){.input = shear_input_of_file(NULL)};
    bool ok = copy(&f->input.path, input->path);
    f->input.mosaic = input->mosaic;
    f->input.exposure = input->exposure;
    for (int i = 0; i < SHEAR_N_EXPOSURE_OPTIONS; i++) {
        const char **text = shear_exposure_text(&f->input.exposure, i);
        ok = (text == NULL || copy(text, *text)) && ok;
    }
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        f->fds[i] = i == 0 || input->path == NULL ? fds[i] : -1;
        f->input.parts[i].hdu = input->parts[i].hdu;
        ok = copy(&f->input.parts[i].path, input->parts[i].path) && ok;
        ok = copy(&f->input.parts[i].extname, input->parts[i].extname) && ok;
        struct stat st;
        if (f->fds[i] >= 0 && fstat(f->fds[i], &st) == 0) {
            f->initial[i] = fingerprint_of(&st); /* zeros otherwise: then the check fails, too */
        }
    }
    return ok;
}

void job_files_close(job_files *f) {
    free((char *)f->input.path);
    for (int i = 0; i < SHEAR_N_EXPOSURE_OPTIONS; i++) {
        const char **text = shear_exposure_text(&f->input.exposure, i);
        free(text != NULL ? (char *)*text : NULL);
    }
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        free((char *)f->input.parts[i].path);
        free((char *)f->input.parts[i].extname);
        release_fd(&f->fds[i]);
    }
}

static bool is_same_file(const job_files *f, int a, int b) {
    return f->fds[a] >= 0 && f->initial[a].device == f->initial[b].device &&
           f->initial[a].inode == f->initial[b].inode;
}

int64_t job_files_bytes(const job_files *f) {
    int64_t bytes = 0;
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        bool counted = f->fds[i] < 0;
        for (int before = 0; before < i; before++)
            counted = counted || is_same_file(f, before, i);
        bytes += counted ? 0 : f->initial[i].size;
    }
    return bytes;
}

int job_files_check(const job_files *f, shear_error *err) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        struct stat st;
        const char *name = f->input.path != NULL ? f->input.path : f->input.parts[i].path;
        if (f->fds[i] < 0)
            continue;
        if (fstat(f->fds[i], &st) != 0) {
            return shear_fail(err, SHEAR_E_IO, NULL, "%.300s: cannot be examined: %s", name,
                              strerror(errno));
        }
        const file_fingerprint now = fingerprint_of(&st);
        if (!fingerprint_same(&f->initial[i], &now)) {
            return shear_fail(err, ENGINE_E_CHANGED,
                              "leave a file alone from its submission until its job has ended",
                              "%.300s: changed while it was read", name);
        }
    }
    return SHEAR_OK;
}
