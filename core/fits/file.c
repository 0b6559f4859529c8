/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/file.h"

static int survey(sf_file *f, int rc, shear_error *err) {
    if (rc == SHEAR_OK && fits_is_reentrant() == 0) {
        rc = shear_fail(err, SHEAR_E_INTERNAL, "install a CFITSIO built with --enable-reentrant",
                        "this CFITSIO is not reentrant");
    }
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

int sf_open_hdu(const sf_file *f, int number, const char *label, fitsfile **fits,
                shear_error *err) {
    int status = 0;
    *fits = NULL;
    fits_open_diskfile(fits, f->source.proc, READONLY, &status);
    if (status == 0) {
        fits_movabs_hdu(*fits, number, NULL, &status);
    }
    if (status != 0) {
        const int rc =
            sf_fail_status(err, (sf_place){f->source.name, label}, status, "cannot be opened");
        sf_close_hdu(*fits);
        *fits = NULL;
        return rc;
    }
    return SHEAR_OK;
}

void sf_close_hdu(fitsfile *fits) {
    if (fits != NULL) {
        int status = 0;
        fits_close_file(fits, &status);
        if (status != 0) {
            fits_clear_errmsg();
        }
    }
}
