/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How field files get their names: complete, under the right name, or not at all. */
#include "fits_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void expect_create(const char *path, const shear_field_spec *spec, int code,
                          const char *word) {
    shear_field_writer *w = (shear_field_writer *)1;
    shear_error err = {0};
    const int before = fixture_count_files();
    assert_int_equal(shear_field_create(&w, path, spec, &err), code);
    assert_null(w);
    if (strstr(err.message, word) == NULL || strstr(err.message, path) == NULL)
        fail_msg("no '%s' and '%s' in: %s", word, path, err.message);
    assert_int_equal(fixture_count_files(), before);
}

static void outputs_that_cannot_be(void **state) {
    (void)state;
    shear_field_spec s = fixture_spec();
    fixture_save(fixture_path("sum"), "x", 1);
    assert_int_equal(mkdir(fixture_path("dir.fits"), 0700), 0);
    assert_int_equal(mkfifo(fixture_path("fifo.fits"), 0600), 0);
    expect_create(fixture_path("no/such/file.fits"), &s, SHEAR_E_IO, "No such file");
    expect_create(fixture_path("sum/below-a-file.fits"), &s, SHEAR_E_IO, "Not a directory");
    expect_create(fixture_path("dir.fits"), &s, SHEAR_E_IO, "a directory");
    expect_create(fixture_path("dir.fits/"), &s, SHEAR_E_IO, "a directory");
    expect_create(fixture_path("fifo.fits"), &s, SHEAR_E_IO, "not a regular file");
    expect_create("/dev/null", &s, SHEAR_E_IO, "not a regular file");
    expect_create("", &s, SHEAR_E_IO, "an empty name");
    fixture_write_good(fixture_path("there.fits"));
    s.overwrite = false;
    expect_create(fixture_path("there.fits"), &s, SHEAR_E_EXISTS, "exists");
    assert_int_equal(symlink("nowhere", fixture_path("dangling.fits")), 0);
    expect_create(fixture_path("dangling.fits"), &s, SHEAR_E_EXISTS, "exists");
}

static void specs_that_cannot_be(void **state) {
    (void)state;
    const char *path = fixture_path("spec.fits");
    shear_field_spec s[20];
    for (int i = 0; i < 20; i++)
        s[i] = fixture_spec();
    s[0].geometry.nx = 7;
    s[1].geometry.ny = 1025;
    s[2].geometry.psf_nx = 2;
    s[3].geometry.psf_ny = 4097;
    s[4].geometry.psf_oversample = 0;
    s[5].geometry.psf_oversample = 65;
    s[6].n_stamps = 0;
    s[7].n_psf = 0;
    s[8].n_psf = 5;
    s[9].layout = 2;
    s[10].mosaic_columns = 11;
    s[11].mosaic_columns = -1;
    s[12].bitpix = 16;
    s[13].name = "";
    s[14].name = "tab\t";
    s[15].pixscale = 0.0;
    s[16].pixscale = INFINITY;
    s[17].has_truth = true;
    s[17].sim_g1 = 1.0;
    s[18].has_truth = true;
    s[18].sim_g2 = NAN;
    s[19].n_stamps = INT64_C(1) << 40;
    for (int i = 0; i < 20; i++)
        expect_create(path, &s[i], SHEAR_E_SETTING, "");
}

static shear_field_writer *begin(const char *path, bool overwrite) {
    shear_field_spec s = fixture_spec();
    shear_field_writer *w = NULL;
    s.overwrite = overwrite;
    s.n_stamps = 2;
    assert_int_equal(shear_field_create(&w, path, &s, NULL), SHEAR_OK);
    return w;
}

static void complete(shear_field_writer *w) {
    static const double pixels[2 * 12 * 10];
    assert_int_equal(shear_field_write(w, 0, 2, pixels, pixels, NULL, NULL), SHEAR_OK);
    assert_int_equal(shear_field_write_psf(w, 0, pixels, NULL), SHEAR_OK);
}

/* A file appears under its name when it is finished, and not before. */
static void files_appear_at_once(void **state) {
    (void)state;
    const char *path = fixture_path("atomic.fits");
    const int before = fixture_count_files();
    shear_field_writer *w = begin(path, false);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(fixture_count_files(), before + 1); /* the temporary one */
    shear_field_abort(w);
    assert_int_equal(fixture_count_files(), before);
    shear_field_abort(NULL);

    w = begin(path, false);
    complete(w);
    fixture_save(path, "taken", 5); /* by someone else, meanwhile */
    shear_error err = {0};
    assert_int_equal(shear_field_finish(w, &err), SHEAR_E_EXISTS);
    size_t size = 0;
    free(fixture_load(path, &size));
    assert_int_equal(size, 5);
    assert_int_equal(fixture_count_files(), before + 1);

    w = begin(path, true);
    complete(w);
    free(fixture_load(path, &size));
    assert_int_equal(size, 5);
    assert_int_equal(shear_field_finish(w, &err), SHEAR_OK);
    assert_int_equal(fixture_count_files(), before + 1);
    shear_field *field = NULL;
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    shear_field_close(field);
}

static void incomplete_files_do_not_appear(void **state) {
    (void)state;
    static const double pixels[2 * 12 * 10];
    const char *path = fixture_path("incomplete.fits");
    const int before = fixture_count_files();
    shear_error err = {0};
    shear_field_writer *w = begin(path, true);
    assert_int_equal(shear_field_write_psf(w, 0, pixels, NULL), SHEAR_OK);
    assert_int_equal(shear_field_write(w, 0, 1, pixels, pixels, NULL, NULL), SHEAR_OK);
    assert_int_equal(shear_field_finish(w, &err), SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "stamp 1"));
    w = begin(path, true);
    assert_int_equal(shear_field_write(w, 0, 2, pixels, pixels, NULL, NULL), SHEAR_OK);
    assert_int_equal(shear_field_finish(w, &err), SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "PSF image 0"));
    w = begin(path, true);
    assert_int_equal(shear_field_write(w, 1, 2, pixels, pixels, NULL, &err), SHEAR_E_INTERNAL);
    assert_int_equal(shear_field_write(w, -1, 1, pixels, pixels, NULL, &err), SHEAR_E_INTERNAL);
    assert_int_equal(shear_field_write_psf(w, 1, pixels, &err), SHEAR_E_INTERNAL);
    shear_field_abort(w);
    shear_field_spec s = fixture_spec();
    s.columns = SHEAR_COL_X;
    assert_int_equal(shear_field_create(&w, path, &s, &err), SHEAR_OK);
    assert_int_equal(shear_field_write(w, 0, 1, pixels, pixels, NULL, &err), SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "column X"));
    shear_field_abort(w);
    assert_int_equal(fixture_count_files(), before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outputs_that_cannot_be),
        cmocka_unit_test(specs_that_cannot_be),
        cmocka_unit_test(files_appear_at_once),
        cmocka_unit_test(incomplete_files_do_not_appear),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
