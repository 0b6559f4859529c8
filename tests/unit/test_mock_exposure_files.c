/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mock exposures as files, read by CFITSIO: pixels, noise, defects, truth, and what changes
 * between two exposures of one seed. */
#include "remove_tree.h"
#include "shear_mocks/exposure.h"
#include "test_mock_fixture.h"

#include <dirent.h>
#include <fitsio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIDE = 256, PIXELS = SIDE * SIDE };

static char directory[32];
static const char *const endings[] = {"", ".weight", ".mask", ".truth"};

static const char *path_of(const char *name, const char *ending) {
    static char path[4][96];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s%s.fits", directory, name, ending);
    return path[next];
}

static int set_up(void **state) {
    (void)state;
    strcpy(directory, "/tmp/mock-exposure-XXXXXX");
    return mkdtemp(directory) == NULL;
}

static int tear_down(void **state) {
    (void)state;
    remove_tree(directory);
    return 0;
}

static shear_mock_exposure small_exposure(void) {
    shear_mock_exposure e;
    shear_mock_exposure_init(&e);
    e.chips_x = 2;
    e.nx = e.ny = SIDE;
    e.galaxies = 40.0;
    e.stars = 10.0;
    return e;
}

static shear_mock_exposure_counts write_exposure(const shear_mock_exposure *e, const char *name,
                                                 int threads) {
    shear_error err = {0};
    shear_mock_exposure_counts n = {0};
    const shear_mock_write_options o = {.threads = threads};
    if (shear_mock_exposure_write(e, path_of(name, ""), &o, &n, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    return n;
}

/* The pixels of a chip, from 1; free them. */
static double *read_chip(const char *name, const char *ending, int chip) {
    fitsfile *f = NULL;
    int status = 0, any = 0;
    char extname[FLEN_VALUE], expected[16];
    double *out = doubles(PIXELS);
    fits_open_diskfile(&f, path_of(name, ending), READONLY, &status);
    fits_movabs_hdu(f, chip + 1, NULL, &status);
    fits_read_key(f, TSTRING, "EXTNAME", extname, NULL, &status);
    fits_read_img(f, TDOUBLE, 1, PIXELS, NULL, out, &any, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
    snprintf(expected, sizeof expected, "CHIP%d", chip);
    assert_string_equal(extname, expected);
    return out;
}

static double *read_column(const char *name, const char *column, long *n) {
    fitsfile *f = NULL;
    int status = 0, number = 0;
    char text[FLEN_VALUE];
    fits_open_diskfile(&f, path_of(name, ".truth"), READONLY, &status);
    fits_movnam_hdu(f, BINARY_TBL, (char *)(uintptr_t) "TRUTH", 0, &status);
    fits_get_num_rows(f, n, &status);
    double *out = doubles((size_t)*n + 1);
    snprintf(text, sizeof text, "%s", column);
    fits_get_colnum(f, CASESEN, text, &number, &status);
    fits_read_col(f, TDOUBLE, number, 1, 1, *n, NULL, out, NULL, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
    return out;
}

static void test_weight_and_mask_say_the_same(void **state) {
    (void)state;
    shear_mock_exposure e = small_exposure();
    e.star_flux_max = 5e6;
    e.saturation = 20000.0;
    const shear_mock_exposure_counts n = write_exposure(&e, "a", 2);
    int64_t bad = 0, saturated = 0, bits = 0;
    for (int chip = 1; chip <= 2; chip++) {
        double *image = read_chip("a", "", chip);
        double *weight = read_chip("a", ".weight", chip);
        double *mask = read_chip("a", ".mask", chip);
        for (int i = 0; i < PIXELS; i++) {
            const int m = (int)mask[i];
            bits |= m;
            bad += m != 0;
            saturated += (m & 4) != 0;
            assert_true((m != 0) == (weight[i] == 0.0));
            assert_true(image[i] <= e.saturation && ((m & 4) != 0) == (image[i] == e.saturation));
            if (m == 0)
                assert_close(1.0 / weight[i], 400.0 / 2.5 + 4.0, 1e-4);
        }
        free(image);
        free(weight);
        free(mask);
    }
    assert_int_equal(bits, 7);
    assert_int_equal(bad, n.bad_pixels);
    assert_int_equal(saturated, n.saturated_pixels);
}

/* Mean, variance, and correlation with the next pixel along x and along y. */
static void noise_of(const double *image, double out[4]) {
    memset(out, 0, 4 * sizeof *out);
    out[0] = mean_of(image, PIXELS);
    for (int y = 0; y + 1 < SIDE; y++) {
        for (int x = 0; x + 1 < SIDE; x++) {
            const double *p = image + y * SIDE + x;
            out[1] += (p[0] - out[0]) * (p[0] - out[0]);
            out[2] += (p[0] - out[0]) * (p[1] - out[0]);
            out[3] += (p[0] - out[0]) * (p[SIDE] - out[0]);
        }
    }
    out[2] /= out[1];
    out[3] /= out[1];
    out[1] /= (SIDE - 1) * (SIDE - 1);
}

static void test_noise(void **state) {
    (void)state;
    shear_mock_exposure e = small_exposure();
    e.galaxies = e.stars = 0.0;
    e.bad_columns = e.cosmic_rays = 0;
    for (int i = 0; i < 2; i++) {
        double noise[4];
        const char *name = i == 0 ? "b" : "c";
        e.correlation = i == 0 ? 0.0 : 0.3;
        const shear_mock_exposure_counts n = write_exposure(&e, name, 1);
        assert_int_equal(n.galaxies + n.stars + n.bad_pixels, 0);
        double *image = read_chip(name, "", 2);
        noise_of(image, noise);
        assert_close(noise[0], 400.0, 0.3);
        assert_close(noise[1], 164.0, 5.0);
        assert_close(noise[2], e.correlation, 0.02);
        assert_close(noise[3], e.correlation, 0.02);
        free(image);
    }
}

/* Bytes of two files. */
static bool same_files(const char *a, const char *b) {
    FILE *f = fopen(a, "re"), *g = fopen(b, "re");
    assert_true(f != NULL && g != NULL);
    bool same = true;
    for (int c = 0; same && c != EOF;) {
        c = getc(f);
        same = c == getc(g);
    }
    fclose(f);
    fclose(g);
    return same;
}

static void test_threads_do_not_matter(void **state) {
    (void)state;
    shear_mock_exposure e = small_exposure();
    e.correlation = 0.2;
    e.source_noise = true;
    write_exposure(&e, "d", 1);
    write_exposure(&e, "e", 3);
    for (int i = 0; i < 4; i++)
        assert_true(same_files(path_of("d", endings[i]), path_of("e", endings[i])));
}

/* The same places, fluxes and noise at -g; only galaxies differ. */
static void test_the_opposite_shear_changes_galaxies_only(void **state) {
    (void)state;
    static const char *const columns[] = {"X", "Y", "RA", "DEC", "FLUX", "R_HALF", "E1", "PSF_E2"};
    shear_mock_exposure e = small_exposure();
    e.galaxies = 3.0;
    e.g1 = -e.g1;
    e.g2 = -e.g2;
    write_exposure(&e, "f", 2);
    e.g1 = -e.g1;
    e.g2 = -e.g2;
    unlink(path_of("d", ""));
    for (int i = 1; i < 4; i++)
        unlink(path_of("d", endings[i]));
    write_exposure(&e, "d", 2);
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
        long n = 0, m = 0;
        double *a = read_column("d", columns[i], &n);
        double *b = read_column("f", columns[i], &m);
        assert_int_equal(n, m);
        assert_memory_equal(a, b, (size_t)n * sizeof *a);
        free(a);
        free(b);
    }
    double *plus = read_chip("d", "", 1);
    double *minus = read_chip("f", "", 1);
    int differ = 0;
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        differ += fabs(plus[i] - minus[i]) > 0.01;
        sum += plus[i] - minus[i];
    }
    assert_true(differ > 50 && differ < PIXELS / 4);
    assert_close(sum, 0.0, 20.0);
    free(plus);
    free(minus);
}

static void test_errors_leave_nothing(void **state) {
    (void)state;
    shear_error err = {0};
    const shear_mock_exposure e = small_exposure();
    const char *path = path_of("b", ""); /* of another test */
    assert_int_equal(shear_mock_exposure_write(&e, path, NULL, NULL, &err), SHEAR_E_EXISTS);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(shear_mock_exposure_write(&e, path, NULL, NULL, &err), SHEAR_E_EXISTS);
    assert_non_null(strstr(err.message, "b.weight.fits"));
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(shear_mock_exposure_write(&e, "/nonexistent/e.fits", NULL, NULL, &err),
                     SHEAR_E_IO);
    DIR *d = opendir(directory);
    assert_non_null(d);
    for (const struct dirent *entry = readdir(d); entry != NULL; entry = readdir(d))
        assert_null(strstr(entry->d_name, ".part"));
    closedir(d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weight_and_mask_say_the_same),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_threads_do_not_matter),
        cmocka_unit_test(test_the_opposite_shear_changes_galaxies_only),
        cmocka_unit_test(test_errors_leave_nothing),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
