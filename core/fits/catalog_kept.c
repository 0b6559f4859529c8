/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogues of work that outlives its process. */
#include "fits/catalog_schema.h"
#include "fits/catalog_state.h"
#include "fits/keys.h"

#include <stdlib.h>
#include <string.h>

static int not_usable(const shear_catalog *c, const char *why, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){c->out.name, SF_CATALOG_HDU}, NULL,
                   "its temporary file cannot be gone on with: %s", why);
}

int shear_catalog_begin(shear_catalog **catalog, const char *path, const shear_field_info *info,
                        const char *checksum, shear_error *err) {
    int rc = sf_catalog_new(catalog, path, info, err);
    shear_catalog *c = *catalog;
    if (rc == SHEAR_OK) {
        rc = sf_output_create_kept(&c->out, path, err);
    }
    if (rc == SHEAR_OK) {
        rc = sf_catalog_create_table(c, info, checksum, err);
    }
    if (rc != SHEAR_OK) {
        shear_catalog_abort(c);
        *catalog = NULL;
    }
    return rc;
}

/* Is it this input's? */
static int check_input(shear_catalog *c, const char *checksum, shear_error *err) {
    const sf_place at = {c->out.name, SF_CATALOG_HDU};
    char *text = NULL;
    int rc = sf_key_string(c->out.fits, at, SF_KEPT_FOR, &text, err);
    if (rc == SHEAR_OK && (text == NULL || strcmp(text, checksum) != 0)) {
        rc = not_usable(c, "it is of another input", err);
    }
    free(text);
    return rc;
}

/* Are its rows those of this layout, and enough of them on disk? */
static int check_rows(shear_catalog *c, int64_t rows, shear_error *err) {
    const sf_place at = {c->out.name, SF_CATALOG_HDU};
    LONGLONG n = 0;
    int64_t kept = 0;
    bool found = false;
    int status = 0;
    fits_get_num_rowsll(c->out.fits, &n, &status);
    if (status != 0 || n != c->n || !sf_catalog_has_columns(c)) {
        fits_clear_errmsg();
        return not_usable(c, "its table has another shape", err);
    }
    int rc = sf_key_int(c->out.fits, at, SF_KEPT_ROWS, 0, c->n, &kept, &found, err);
    if (rc == SHEAR_OK && (!found || kept < rows)) {
        rc = not_usable(c, "fewer rows are on disk than have been counted", err);
    }
    return rc;
}

static int move_to_table(shear_catalog *c, shear_error *err) {
    int status = 0;
    char name[] = SF_CATALOG_HDU;
    fits_movnam_hdu(c->out.fits, BINARY_TBL, name, 0, &status);
    fits_clear_errmsg();
    return status == 0 ? SHEAR_OK : not_usable(c, "it has no table", err);
}

int shear_catalog_resume(shear_catalog **catalog, const char *path, const shear_field_info *info,
                         const char *checksum, int64_t rows, shear_error *err) {
    int rc = sf_catalog_new(catalog, path, info, err);
    shear_catalog *c = *catalog;
    if (rc == SHEAR_OK) {
        rc = sf_output_reopen(&c->out, path, err);
    }
    if (rc == SHEAR_OK) {
        rc = move_to_table(c, err);
    }
    if (rc == SHEAR_OK) {
        rc = check_input(c, checksum, err);
    }
    if (rc == SHEAR_OK) {
        rc = check_rows(c, rows, err);
    }
    if (rc != SHEAR_OK) {
        shear_catalog_leave(c);
        *catalog = NULL;
        return rc;
    }
    sf_bitset_add(&c->written, 0, rows);
    return SHEAR_OK;
}

/* First the rows, then the word that they are there: a file that was begun anew and never came so
 * far does not have it, whatever a checkpoint of before says. */
int shear_catalog_keep(shear_catalog *c, int64_t rows, shear_error *err) {
    const sf_place at = {c->out.name, SF_CATALOG_HDU};
    int64_t kept = 0;
    bool found = false;
    int status = 0;
    int rc = sf_output_sync(&c->out, err);
    if (rc == SHEAR_OK) {
        rc = sf_key_int(c->out.fits, at, SF_KEPT_ROWS, 0, c->n, &kept, &found, err);
    }
    if (rc != SHEAR_OK || kept >= rows) {
        return rc;
    }
    fits_update_key_lng(c->out.fits, SF_KEPT_ROWS, rows, NULL, &status);
    return status == 0 ? sf_output_sync(&c->out, err)
                       : sf_fail_status(err, at, status, "cannot be written");
}

void shear_catalog_leave(shear_catalog *c) {
    if (c != NULL) {
        sf_output_leave(&c->out);
        shear_catalog_abort(c);
    }
}

int shear_catalog_forget(const char *path, shear_error *err) {
    return sf_output_forget(path, err);
}
