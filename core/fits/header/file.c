/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/file.h"

#include "base/cleanup.h"

static int index_hdus(sf_file *f, shear_error *err) {
    return sf_hdu_index_init(&f->index, f->source.fd, f->source.size, f->source.name, err);
}

int sf_file_open(sf_file *f, const char *path, shear_error *err) {
    *f = (sf_file){0};
    TRY(sf_source_open(&f->source, path, err));
    return index_hdus(f, err);
}

int sf_file_open_fd(sf_file *f, int fd, const char *name, shear_error *err) {
    *f = (sf_file){0};
    TRY(sf_source_open_fd(&f->source, fd, name, err));
    return index_hdus(f, err);
}

void sf_file_close(sf_file *f) {
    sf_hdu_index_deinit(&f->index);
    sf_source_close(&f->source);
}
