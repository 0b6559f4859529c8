/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write result catalogs of work that outlives its process: begin, resume, sync, suspend. */
#include "base/cleanup.h"
#include "fits/catalog/internal.h"
#include "fits/header/table.h"
#include "fits/schema/result_columns.h"

#include <string.h>

static int not_usable(const shear_catalog *c, const char *why, shear_error *err) {
    return sf_fail(err, SHEAR_E_FORMAT, (sf_place){c->out.name, SF_CATALOG_HDU}, NULL,
                   "its temporary file cannot be gone on with: %s", why);
}

int shear_catalog_begin(shear_catalog **catalog, const char *path, const shear_field_info *info,
                        const char *checksum, shear_error *err) {
    return sf_catalog_begin(catalog, path, info, checksum, true, err);
}

/* What the file must contain. */
typedef struct expected {
    shear_catalog *catalog;
    const shear_field_info *info;
    const char *checksum;
    int64_t rows;
} expected;

/* Check that the file belongs to this input and that enough of its rows are on disk. */
static int check_keys(const expected *e, const sf_cards *cards, shear_error *err) {
    shear_catalog *c = e->catalog;
    CLEANUP(release_free) char *text = NULL;
    int64_t rows = SF_ABSENT;
    TRY(sf_key_string(cards, SF_KEPT_FOR, &text, err));
    if (text == NULL || strcmp(text, e->checksum) != 0)
        return not_usable(c, "it is of another input", err);
    TRY(sf_key_int(cards, SF_KEPT_ROWS, 0, c->n, &rows, err));
    if (rows < e->rows)
        return not_usable(c, "fewer rows are on disk than have been counted", err);
    c->kept = rows;
    return SHEAR_OK;
}

static bool has_columns(const sf_table *table, const shear_field_info *info) {
    sf_layout l = {0};
    sf_catalog_layout(&l, info);
    bool same = table->n == l.n;
    for (int i = 0; i < l.n && same; i++)
        same = strcmp(table->columns[i].name, l.names[i]) == 0;
    return same;
}

/* Check that the file is one table and nothing else, before it is given to CFITSIO. */
static int check_file(const char *path, void *context, shear_error *err) {
    const expected *e = context;
    const sf_hdu *hdu = NULL;
    CLEANUP(sf_file_close) sf_file file;
    CLEANUP(sf_cards_deinit) sf_cards cards = {0};
    CLEANUP(sf_table_deinit) sf_table table = {0};
    TRY(sf_file_open(&file, path, -1, err));
    TRY(sf_file_find(&file, SF_CATALOG_HDU, true, &hdu, err));
    if (file.count != 2 || file.hdus[0].naxis != 0 || hdu->zimage || hdu->ztable ||
        hdu->axes[1] != e->catalog->n) {
        return not_usable(e->catalog, "its table has another shape", err);
    }
    TRY(sf_cards_init(&cards, &file, hdu, SF_CATALOG_HDU, err));
    TRY(sf_table_init(&table, &cards, err));
    TRY(check_keys(e, &cards, err));
    return has_columns(&table, e->info)
               ? SHEAR_OK
               : not_usable(e->catalog, "its table has another shape", err);
}

typedef shear_catalog suspended;
CLEANUP_DEFINE(suspended, shear_catalog_suspend)

int shear_catalog_resume(shear_catalog **catalog, const char *path, const shear_field_info *info,
                         const char *checksum, int64_t rows, shear_error *err) {
    CLEANUP(suspended_release) shear_catalog *c = NULL; /* a file that cannot be resumed is kept */
    *catalog = NULL;
    TRY(sf_catalog_new(&c, path, info, err));
    expected e = {c, info, checksum, rows};
    char name[] = SF_CATALOG_HDU;
    int status = 0;
    TRY(sf_output_reopen(&c->out, path, check_file, &e, err));
    fits_movnam_hdu(c->out.fits, BINARY_TBL, name, 0, &status);
    if (status != 0) {
        fits_clear_errmsg();
        return not_usable(c, "it has no table", err);
    }
    sf_bitset_add(&c->written, 0, rows);
    *catalog = CLEANUP_TAKE(c);
    return SHEAR_OK;
}

/* Sync the rows first, then the keyword that declares them: a file that was begun again and did not
 * get as far has a smaller number, whatever an older checkpoint says. */
int shear_catalog_sync(shear_catalog *c, int64_t rows, shear_error *err) {
    int status = 0;
    TRY(sf_output_sync(&c->out, err));
    if (c->kept >= rows)
        return SHEAR_OK;
    fits_update_key_lng(c->out.fits, SF_KEPT_ROWS, rows, NULL, &status);
    TRY(sf_catalog_check(c, status, err));
    c->kept = rows;
    return sf_output_sync(&c->out, err);
}

void shear_catalog_suspend(shear_catalog *c) {
    if (c != NULL) {
        sf_output_suspend(&c->out);
        shear_catalog_abort(c);
    }
}

int shear_catalog_discard(const char *path, shear_error *err) {
    return sf_output_discard_kept(path, err);
}
