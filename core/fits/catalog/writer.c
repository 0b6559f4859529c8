/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Write result catalogs row by row. */
#include "base/array.h"

#include "base/cleanup.h"
#include "fits/carry/carry_rows.h"
#include "fits/catalog/internal.h"
#include "fits/catalog/keywords.h"
#include "fits/schema/field_columns.h"
#include "fits/schema/result_columns.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CARRIED_CARDS = 7 }; /* of a carried column, at most */

static const char *unit_of(const sf_member *m, enum shear_frame frame) {
    return frame != SHEAR_FRAME_PIXEL && strcmp(m->unit, SF_PER_AREA) == 0 ? SF_PER_AREA_OF_SKY
                                                                           : m->unit;
}

void sf_catalog_layout(sf_layout *l, const shear_field_info *info) {
    sf_layout_add_columns(l, info->columns & SF_CATALOG_COPIED, 0);
    for (int i = 0; i < SF_CATALOG_MEMBERS; i++) {
        const sf_member *m = &sf_catalog_members[i];
        sf_layout_add(l, m->name, m->form, unit_of(m, info->frame), m->comment);
    }
    sf_layout_add_carried(l, info->carried, info->n_carried);
}

int sf_catalog_check(const shear_catalog *c, int status, shear_error *err) {
    return sf_check_status(err, (sf_place){c->out.name, SF_CATALOG_HDU}, status,
                           "cannot be written");
}

/* Create the table in the empty file c->out. */
static int create_table(shear_catalog *c, const shear_field_info *info, const char *kept_for,
                        shear_error *err) {
    fitsfile *f = c->out.fits;
    int status = 0;
    sf_layout l = {0};
    sf_catalog_layout(&l, info);
    fits_create_img(f, BYTE_IMG, 0, NULL, &status);
    fits_create_tbl(f, BINARY_TBL, c->n, l.n, l.names, l.forms, l.units, SF_CATALOG_HDU, &status);
    for (int i = 0; i < l.n; i++) {
        char key[FLEN_KEYWORD];
        snprintf(key, sizeof key, "TCOMM%d", i + 1);
        fits_write_key_str(f, key, l.comments[i], NULL, &status);
    }
    if (c->id_unsigned) { /* ID is the first column */
        fits_write_record(f, "TZERO1  =  9223372036854775808 / unsigned numbers of 64 bits",
                          &status);
    }
    carry_write_keys(f, info->carried, info->n_carried, l.n - info->n_carried + 1, &status);
    sf_catalog_write_field(f, info, &status);
    if (kept_for != NULL) {
        fits_write_key_str(f, SF_KEPT_FOR, kept_for, "unfinished: the input's checksum", &status);
        fits_write_key_lng(f, SF_KEPT_ROWS, 0, "unfinished: rows that are on disk", &status);
    }
    fits_set_hdrsize(f, SF_CATALOG_CARDS + CARRIED_CARDS * info->n_carried, &status);
    return sf_catalog_check(c, status, err);
}

int sf_catalog_new(shear_catalog **catalog, const char *path, const shear_field_info *info,
                   shear_error *err) {
    *catalog = NULL;
    CLEANUP(shear_catalog_release) shear_catalog *c = calloc(1, sizeof *c);
    if (c == NULL)
        return sf_fail_memory(err, (sf_place){path, NULL});
    c->out.directory = -1;
    c->n = info->n_stamps;
    c->columns = info->columns;
    c->carried_bytes = info->carried_bytes;
    c->id_unsigned = info->id_unsigned;
    if (!sf_bitset_init(&c->written, info->n_stamps))
        return sf_fail_memory(err, (sf_place){path, NULL});
    *catalog = CLEANUP_TAKE(c);
    return SHEAR_OK;
}

int sf_catalog_begin(shear_catalog **catalog, const char *path, const shear_field_info *info,
                     const char *kept_for, bool overwrite, shear_error *err) {
    CLEANUP(shear_catalog_release) shear_catalog *c = NULL;
    *catalog = NULL;
    TRY(sf_catalog_new(&c, path, info, err));
    TRY(kept_for != NULL ? sf_output_create_kept(&c->out, path, err)
                         : sf_output_create(&c->out, path, overwrite, err));
    TRY(create_table(c, info, kept_for, err));
    *catalog = CLEANUP_TAKE(c);
    return SHEAR_OK;
}

int shear_catalog_create(shear_catalog **catalog, const char *path, const shear_field_info *info,
                         bool overwrite, shear_error *err) {
    return sf_catalog_begin(catalog, path, info, NULL, overwrite, err);
}

/* Write ids in their stored form: CFITSIO would convert them through doubles if TZERO is not 0. */
static void write_ids(shear_catalog *c, int64_t first, int count, const int64_t *ids, int *status) {
    LONGLONG *stored = (LONGLONG *)(void *)c->values;
    const uint64_t sign = c->id_unsigned ? UINT64_C(1) << 63 : 0;
    for (int k = 0; k < count; k++)
        stored[k] = (LONGLONG)((uint64_t)ids[k] ^ sign);
    fits_set_tscale(c->out.fits, 1, 1.0, 0.0, status);
    fits_write_col(c->out.fits, TLONGLONG, 1, first + 1, 1, count, stored, status);
}

/* Write the columns copied from the field file, which come first. Return their number. */
static int write_copied(shear_catalog *c, int64_t first, int count, const shear_block *b,
                        int *status) {
    int column = 0;
    for (const sf_column_def *def = sf_column_defs; def < sf_column_defs + SF_COLUMNS; def++) {
        if ((c->columns & SF_CATALOG_COPIED & def->bit) == 0)
            continue;
        column++;
        if (def->bit == SHEAR_COL_ID) {
            write_ids(c, first, count, b->id, status);
        } else {
            fits_write_col(c->out.fits, TDOUBLE, column, first + 1, 1, count,
                           sf_column_array(b, def->in_block), status);
        }
    }
    return column;
}

static void write_member(shear_catalog *c, int64_t first, int count, const shear_row *rows,
                         const sf_member *m, int column, int *status) {
    const bool real = m->form[0] == 'D';
    int32_t *integers = (int32_t *)(void *)c->values;
    for (int k = 0; k < count; k++) {
        const char *member = (const char *)&rows[k] + m->offset;
        int32_t integer = 0;
        if (real) {
            memcpy(&c->values[k], member, sizeof(double));
        } else {
            memcpy(&integer, member, sizeof integer);
            integers[k] = integer + (int32_t)m->shift;
        }
    }
    fits_write_col(c->out.fits, real ? TDOUBLE : TINT, column, first + 1, 1, count, c->values,
                   status);
}

int shear_catalog_write(shear_catalog *c, int64_t first, int count, const shear_row *rows,
                        const shear_block *block, shear_error *err) {
    if (count < 1 || first < 0 || first > c->n - count) {
        return sf_fail(err, SHEAR_E_INTERNAL, (sf_place){c->out.name, SF_CATALOG_HDU}, NULL,
                       "%d rows from %lld on were written, but there are %lld", count,
                       (long long)first, (long long)c->n);
    }
    if (!ARRAY_RESERVE_EXACT(c->values, c->capacity, (size_t)count))
        return sf_fail_memory(err, (sf_place){c->out.name, NULL});
    int status = 0;
    int column = write_copied(c, first, count, block, &status);
    for (int i = 0; i < SF_CATALOG_MEMBERS; i++)
        write_member(c, first, count, rows, &sf_catalog_members[i], ++column, &status);
    if (c->carried_bytes > 0)
        carry_write_rows(c->out.fits, first, count, block->carried, c->carried_bytes, &status);
    TRY(sf_catalog_check(c, status, err));
    sf_bitset_add(&c->written, first, count);
    return SHEAR_OK;
}

static void remove_kept_keys(fitsfile *f) {
    int status = 0;
    fits_delete_key(f, SF_KEPT_FOR, &status);
    fits_delete_key(f, SF_KEPT_ROWS, &status);
    fits_clear_errmsg();
}

int shear_catalog_finish(shear_catalog *c, const shear_plan *plan, const shear_result *result,
                         const char *input_name, const char *checksum, shear_error *err) {
    CLEANUP(shear_catalog_release) shear_catalog *own = c;
    int status = 0;
    const int64_t gap = sf_bitset_first_gap(&own->written);
    if (gap >= 0) {
        return sf_fail(err, SHEAR_E_INTERNAL, (sf_place){own->out.name, SF_CATALOG_HDU}, NULL,
                       "row %lld was never written", (long long)gap);
    }
    remove_kept_keys(own->out.fits);
    sf_catalog_write_result(own->out.fits, plan, result, input_name, checksum, &status);
    TRY(sf_catalog_check(own, status, err));
    return sf_output_commit(&own->out, err);
}

void shear_catalog_abort(shear_catalog *c) {
    if (c == NULL)
        return;
    sf_output_discard(&c->out);
    sf_bitset_deinit(&c->written);
    free(c->values);
    free(c);
}
