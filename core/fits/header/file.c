/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/file.h"

static int survey(sf_file *f, int rc, shear_error *err) {
    if (rc == SHEAR_OK) {
        rc = sf_survey_new(&f->survey, f->source.fd, f->source.size, f->source.name, err);
    }
    if (rc != SHEAR_OK) {
        sf_file_close(f);
    }
    return rc;
}

int sf_file_open(sf_file *f, const char *path, shear_error *err) {
    *f = (sf_file){0};
    return survey(f, sf_source_open(&f->source, path, err), err);
}

int sf_file_open_fd(sf_file *f, int fd, const char *name, shear_error *err) {
    *f = (sf_file){0};
    return survey(f, sf_source_open_fd(&f->source, fd, name, err), err);
}

void sf_file_close(sf_file *f) {
    sf_survey_free(&f->survey);
    sf_source_close(&f->source);
}
