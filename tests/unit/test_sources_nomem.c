/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogs of sources while memory runs out, at every request in turn: an error that says so, never
 * other sources. */
#include "scarce.h"
#include "source_fixture.h"

#include <stdlib.h>
#include <string.h>

static int open_and_load(const char *path, const shear_exposure *e, int64_t *n, shear_error *err) {
    static const char *const contexts[] = {"MAG_AUTO"};
    source_catalog *c = NULL;
    source_list s = {0};
    const shear_input_part part = {.path = path, .hdu = -1};
    int code = source_catalog_open(&c, &part, -1, e, err);
    if (code == SHEAR_OK)
        code = source_catalog_load(c, source_catalog_tables(c) - 1, contexts, 1, NULL, &s, err);
    *n = s.n;
    source_list_deinit(&s);
    source_catalog_close(c);
    return code;
}

static void read_scarcely(const char *path, int64_t rows) {
    const shear_exposure e = {
        .origin = 1, .columns = "id=NUMBER", .select = "X_IMAGE > 0 && FLAGS < 4"};
    bool refused = true;
    for (long n = 1; refused; n++) {
        int64_t found = 0;
        shear_error err = {0};
        scarce_after(n, false);
        const int code = open_and_load(path, &e, &found, &err);
        refused = scarce_end();
        assert_int_equal(code, refused ? SHEAR_E_NOMEM : SHEAR_OK);
        assert_true(refused || found == rows);
        assert_true(n < 2000);
    }
}

static double chip_of(long i) {
    return (double)(i % 2 + 1);
}

static void write_tables(const char *path, const char *name, const char *head, bool merged) {
    static const char *const cards[] = {"EXTNAME = 'N15     '", "END", NULL};
    source_fixture_column columns[7];
    fitsfile *f = fixture_create(path);
    memcpy(columns, source_fixture_usual, sizeof source_fixture_usual);
    columns[5] = (source_fixture_column){"FLUX_RADIUS", "1E", NULL, chip_of};
    columns[6] = (source_fixture_column){"EXT_NUMBER", "1I", NULL, chip_of};
    for (int i = 0; i < 2; i++) {
        if (head != NULL)
            source_fixture_header(f, head, cards);
        if (!merged || i == 0)
            source_fixture_table(f, name, columns, merged ? 7 : 6, 10);
    }
    fixture_close(f);
}

static void test_tables(void **state) {
    (void)state;
    const char *path = fixture_path("scarce.cat");
    write_tables(path, "LDAC_OBJECTS", "LDAC_IMHEAD", false);
    read_scarcely(path, 10);
    write_tables(path, "CCD", NULL, false);
    read_scarcely(path, 10);
    write_tables(path, "OBJECTS", NULL, true);
    read_scarcely(path, 5);
}

static void test_text(void **state) {
    (void)state;
    const char *path = fixture_path("scarce.txt");
    const char *packed = fixture_path("scarce.txt.gz");
    source_fixture_text(path, "# 1 NUMBER\n# 2 X_IMAGE\n# 3 Y_IMAGE\n# 4 MAG_AUTO\n# 5 FLAGS\n"
                              "1 2 3 4.5 0\n2 3.5 4 5 6\n");
    read_scarcely(path, 2);
    fixture_gzip(path, packed);
    read_scarcely(packed, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tables),
        cmocka_unit_test(test_text),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
