/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Result catalogs: rows are read back as written, and the header has the settings and the result.
 */
#include "catalog_fixture.h"
#include "fits_fixture.h"

#include "shear/catalog.h"
#include "shear/version.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { N = CATALOG_ROWS };

/* Chunks from the last to the first. */
static void write_rows(shear_catalog *c, const shear_field_info *info) {
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_block_new(&b, info, 4, &err), SHEAR_OK);
    for (int64_t first = 8; first >= 0; first -= 4) {
        shear_row rows[4];
        const int count = first == 8 ? N - 8 : 4;
        for (int k = 0; k < count; k++) {
            rows[k] = catalog_row(first + k);
            double *const doubles[] = {b->x, b->y, b->ra, b->dec};
            for (int i = 0; i < 4; i++) {
                if (doubles[i] != NULL)
                    doubles[i][k] = fixture_column(1u << i, first + k);
            }
            if (b->id != NULL)
                b->id[k] = (first + k) * 5000000000;
        }
        if (shear_catalog_write(c, first, count, rows, b, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
    }
    shear_block_free(b);
}

static void write_catalog(const char *path, unsigned columns, const shear_result *result) {
    const shear_field_info info = catalog_info(N, columns);
    shear_catalog *c = NULL;
    shear_error err = {0};
    if (shear_catalog_create(&c, path, &info, true, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    write_rows(c, &info);
    if (shear_catalog_finish(c, catalog_plan, result, "dir/in put.fits", "0123456789abcdef",
                             &err) != SHEAR_OK) {
        fail_msg("%s", err.message);
    }
}

static bool same(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static void check_row(const shear_row *a, int64_t i) {
    const shear_row b = catalog_row(i);
    assert_true(same(a->n1, b.n1) && same(a->n2, b.n2) && same(a->d, b.d));
    assert_true(same(a->u, b.u) && same(a->v, b.v) && same(a->weight, b.weight));
    assert_true(same(a->m20, b.m20) && same(a->m02, b.m02) && same(a->m11, b.m11));
    assert_true(same(a->m4, b.m4) && same(a->flux, b.flux));
    assert_true(isfinite(b.snr) ? same(a->snr, b.snr) : !isfinite(a->snr));
    assert_int_equal(a->flags, b.flags);
    assert_true(isnan(a->flux_removed) && isnan(a->border_mean));
    assert_true(isnan(a->border_var) && isnan(a->border_var_noise));
}

static void round_trips(void **state) {
    (void)state;
    static const unsigned columns[] = {
        0, SHEAR_COL_ID, SHEAR_COL_X | SHEAR_COL_Y | SHEAR_COL_WEIGHT,
        SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_Y | SHEAR_COL_RA | SHEAR_COL_DEC};
    const shear_result wanted = catalog_result(N);
    for (int i = 0; i < 4; i++) {
        const char *path = fixture_path("round.fits");
        write_catalog(path, columns[i], &wanted);
        shear_catalog_table *t = NULL;
        shear_error err = {0};
        if (shear_catalog_read(&t, path, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
        assert_int_equal(t->n, N);
        for (int64_t k = 0; k < N; k++)
            check_row(&t->rows[k], k);
        assert_string_equal(t->field, "field one");
        assert_true(t->has_truth && same(t->sim_g1, 0.1) && same(t->sim_g2, -0.02));
        assert_true(same(t->beta_px, shear_plan_get_info(catalog_plan)->beta_px));
        assert_true(same(t->r_psf_px, shear_plan_get_info(catalog_plan)->r_psf_px));
        const shear_result *r = &t->result;
        assert_true(r->valid && same(r->g1, wanted.g1) && same(r->g2, wanted.g2));
        assert_true(same(r->g1_err, wanted.g1_err) && same(r->g2_err, wanted.g2_err));
        assert_true(same(r->cov12, wanted.cov12) && r->jackknife == 0);
        assert_int_equal(r->n_stamps, N);
        assert_int_equal(r->n_used, 8);
        assert_int_equal(r->n_flagged, 3);
        assert_memory_equal(r->flagged, wanted.flagged, sizeof r->flagged);
        shear_catalog_table_free(t);
    }
}

static fitsfile *open_table(const char *path) {
    fitsfile *f = NULL;
    int status = 0;
    int type = 0;
    fits_open_diskfile(&f, path, READONLY, &status);
    fits_movnam_hdu(f, BINARY_TBL, "SHEAR", 0, &status);
    fits_get_hdu_type(f, &type, &status);
    assert_int_equal(status, 0);
    assert_int_equal(type, BINARY_TBL);
    return f;
}

/* Ids are kept to the last bit, signed and unsigned. */
static void ids_are_kept(void **state) {
    (void)state;
    static const int64_t ids[3] = {9007199254740993, -1, INT64_MIN + 1};
    const char *path = fixture_path("ids.fits");
    for (int is_unsigned = 0; is_unsigned < 2; is_unsigned++) {
        shear_field_info info = catalog_info(3, SHEAR_COL_ID);
        const shear_row rows[3] = {catalog_row(0), catalog_row(1), catalog_row(2)};
        const shear_result result = catalog_result(3);
        shear_catalog *c = NULL;
        shear_block *b = NULL;
        info.id_unsigned = is_unsigned != 0;
        assert_int_equal(shear_block_new(&b, &info, 3, NULL), SHEAR_OK);
        memcpy(b->id, ids, sizeof ids);
        assert_int_equal(shear_catalog_create(&c, path, &info, true, NULL), SHEAR_OK);
        assert_int_equal(shear_catalog_write(c, 0, 3, rows, b, NULL), SHEAR_OK);
        assert_int_equal(shear_catalog_finish(c, catalog_plan, &result, "in", "0", NULL), SHEAR_OK);
        shear_block_free(b);
        uint64_t found[3] = {0};
        int status = 0;
        int any = 0;
        fitsfile *f = open_table(path);
        fits_read_col(f, is_unsigned != 0 ? TULONGLONG : TLONGLONG, 1, 1, 1, 3, NULL, found, &any,
                      &status);
        fits_close_file(f, &status);
        assert_int_equal(status, 0);
        assert_memory_equal(found, ids, sizeof ids);
    }
}

static void a_field_without_result(void **state) {
    (void)state;
    shear_result r = catalog_result(N);
    r.valid = false;
    r.g1 = r.g2 = r.g1_err = r.g2_err = r.cov12 = NAN;
    r.jackknife = 25;
    const char *path = fixture_path("invalid.fits");
    write_catalog(path, 0, &r);
    shear_catalog_table *t = NULL;
    assert_int_equal(shear_catalog_read(&t, path, NULL), SHEAR_OK);
    assert_false(t->result.valid);
    assert_true(isnan(t->result.g1) && isnan(t->result.g2) && isnan(t->result.cov12));
    assert_true(isnan(t->result.g1_err) && isnan(t->result.g2_err));
    assert_int_equal(t->result.jackknife, 25);
    shear_catalog_table_free(t);
    size_t size = 0;
    unsigned char *bytes = fixture_load(path, &size);
    assert_null(memmem(bytes, size, "NAN", 3)); /* which no header may say */
    free(bytes);
}

static void expect_keyword(fitsfile *f, const char *key, const char *wanted) {
    char value[FLEN_VALUE] = "";
    int status = 0;
    fits_read_key(f, TSTRING, key, value, NULL, &status);
    if (status != 0 || strcmp(value, wanted) != 0)
        fail_msg("keyword %s is '%s', not '%s'", key, value, wanted);
}

/* Every setting, as the text that sets it. */
static void the_header_holds_all_settings(void **state) {
    (void)state;
    const shear_result result = catalog_result(N);
    const char *path = fixture_path("header.fits");
    write_catalog(path, 0, &result);
    fitsfile *f = open_table(path);
    expect_keyword(f, "VERSION", shear_version());
    expect_keyword(f, "INPUT", "dir/in put.fits");
    expect_keyword(f, "INCHKSUM", "0123456789abcdef");
    expect_keyword(f, "RINTERP", "none");
    expect_keyword(f, "RFILTER", "none");
    expect_keyword(f, "ERRMETH", "delta");
    expect_keyword(f, "TTYPE1", "N1");
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    shear_settings back;
    shear_settings_init(&back);
    for (size_t i = 0; i < n; i++) {
        char value[FLEN_VALUE] = "";
        int status = 0;
        shear_error err = {0};
        fits_read_key(f, TSTRING, table[i].keyword, value, NULL, &status);
        assert_int_equal(status, 0);
        if (table[i].type == SHEAR_T_BOOL)
            strcpy(value, value[0] == 'T' ? "true" : "false");
        if (shear_settings_set(&back, table[i].name, value, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
        char was[64];
        char is[64];
        shear_settings_format(shear_plan_get_settings(catalog_plan), &table[i], was, sizeof was);
        shear_settings_format(&back, &table[i], is, sizeof is);
        assert_string_equal(was, is);
    }
    static const char *const flags[SHEAR_N_FLAGS] = {
        "NF_GAL",   "NF_NOISE", "NF_MASK",  "NF_EMPTY", "NF_PSF",  "NF_WGHT",
        "NF_RGAL",  "NF_OVER",  "NF_ARTEF", "NF_NARTE", "NF_EDGE", "NF_HOLE",
        "NF_SATUR", "NF_NEIGH", "NF_NONOI", "NF_NOPOS"};
    for (int i = 0; i < SHEAR_N_FLAGS; i++) {
        int found = 0;
        int is = 0;
        char comment[FLEN_COMMENT];
        fits_read_key(f, TINT, flags[i], &is, comment, &found);
        assert_int_equal(found, 0);
        assert_int_equal(is, i + 1);
        assert_string_equal(comment, shear_flag_name(i));
    }
    int status = 0;
    fits_close_file(f, &status);
}

/* No keyword of ours is given twice, so that settings never hide results. */
static void keywords_are_unique(void **state) {
    (void)state;
    const shear_result result = catalog_result(N);
    const char *path = fixture_path("unique.fits");
    write_catalog(path, 0, &result);
    fitsfile *f = open_table(path);
    int n = 0;
    int status = 0;
    fits_get_hdrspace(f, &n, NULL, &status);
    char keys[400][FLEN_KEYWORD];
    assert_in_range(n, 1, 400);
    for (int i = 0; i < n; i++) {
        char value[FLEN_VALUE];
        fits_read_keyn(f, i + 1, keys[i], value, NULL, &status);
        const bool may_repeat = keys[i][0] == '\0' || strcmp(keys[i], "COMMENT") == 0;
        for (int k = 0; k < i && !may_repeat; k++)
            assert_string_not_equal(keys[i], keys[k]);
    }
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
}

static void equal_results_make_equal_files(void **state) {
    (void)state;
    const shear_result result = catalog_result(N);
    char sums[2][SHEAR_CHECKSUM_SIZE];
    for (int i = 0; i < 2; i++) {
        const char *path = fixture_path(i == 0 ? "a.fits" : "b.fits");
        write_catalog(path, SHEAR_COL_ID, &result);
        assert_int_equal(shear_file_checksum(path, sums[i], NULL), SHEAR_OK);
    }
    assert_string_equal(sums[0], sums[1]);
}

static void outputs_that_cannot_be(void **state) {
    (void)state;
    const shear_field_info info = catalog_info(N, 0);
    shear_catalog *c = (shear_catalog *)1;
    shear_error err = {0};
    assert_int_equal(shear_catalog_create(&c, fixture_path("no/such.fits"), &info, true, &err),
                     SHEAR_E_IO);
    assert_null(c);
    assert_non_null(strstr(err.message, "no/such.fits"));
    fixture_save(fixture_path("there.fits"), "x", 1);
    assert_int_equal(shear_catalog_create(&c, fixture_path("there.fits"), &info, false, &err),
                     SHEAR_E_EXISTS);
    shear_catalog_abort(NULL);
}

static void incomplete_catalogs_do_not_appear(void **state) {
    (void)state;
    const shear_field_info info = catalog_info(N, 0);
    const shear_result result = catalog_result(N);
    const shear_row row = catalog_row(0);
    const char *path = fixture_path("incomplete.fits");
    const int before = fixture_count_files();
    shear_catalog *c = NULL;
    shear_error err = {0};
    shear_block *b = NULL;
    assert_int_equal(shear_block_new(&b, &info, 1, &err), SHEAR_OK);
    assert_int_equal(shear_catalog_create(&c, path, &info, false, &err), SHEAR_OK);
    assert_int_equal(shear_catalog_write(c, N, 1, &row, b, &err), SHEAR_E_INTERNAL);
    assert_int_equal(shear_catalog_write(c, -1, 1, &row, b, &err), SHEAR_E_INTERNAL);
    assert_int_equal(shear_catalog_write(c, 0, 1, &row, b, &err), SHEAR_OK);
    assert_int_equal(shear_catalog_finish(c, catalog_plan, &result, "in", "sum", &err),
                     SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "row 1"));
    assert_int_equal(shear_catalog_create(&c, path, &info, false, &err), SHEAR_OK);
    shear_catalog_abort(c);
    assert_int_equal(fixture_count_files(), before);
    shear_block_free(b);
}

static void expect_unreadable(const char *path, int code, const char *word) {
    shear_catalog_table *t = (shear_catalog_table *)1;
    shear_error err = {0};
    assert_int_equal(shear_catalog_read(&t, path, &err), code);
    assert_null(t);
    if (strstr(err.message, word) == NULL || strstr(err.message, path) == NULL)
        fail_msg("no '%s' and '%s' in: %s", word, path, err.message);
}

static void catalogs_that_cannot_be_read(void **state) {
    (void)state;
    static const struct {
        const char *key, *value, *word;
    } cases[] = {{"TTYPE1", "'OTHER'", "no column N1"},
                 {"TTYPE3", "'OTHER'", "no column D"},
                 {"TFORM1", "'8A'", "column N1"},
                 {"G1", "'much'", "G1"},
                 {"NUSED", "-3", "NUSED"},
                 {"NF_PSF", "0.5", "NF_PSF"},
                 {"FIELD", "'tab\there'", "FIELD"},
                 {"EXTNAME", "'OTHER'", "no HDU SHEAR"},
                 {"NAXIS2", "100000000", "end at"}};
    const shear_result result = catalog_result(N);
    const char *path = fixture_path("bad.fits");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_catalog(path, 0, &result);
        fixture_patch(path, "SHEAR", cases[i].key, cases[i].value);
        expect_unreadable(path, SHEAR_E_FORMAT, cases[i].word);
    }
    expect_unreadable(fixture_path("absent.fits"), SHEAR_E_IO, "No such file");
    fixture_write_good(path);
    expect_unreadable(path, SHEAR_E_FORMAT, "no HDU SHEAR");
    shear_catalog_table_free(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trips),
        cmocka_unit_test(ids_are_kept),
        cmocka_unit_test(a_field_without_result),
        cmocka_unit_test(the_header_holds_all_settings),
        cmocka_unit_test(keywords_are_unique),
        cmocka_unit_test(equal_results_make_equal_files),
        cmocka_unit_test(outputs_that_cannot_be),
        cmocka_unit_test(incomplete_catalogs_do_not_appear),
        cmocka_unit_test(catalogs_that_cannot_be_read),
    };
    return cmocka_run_group_tests(tests, catalog_setup, catalog_teardown);
}
