/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mock field files: what the reader finds in them is what the mock has; every layout; errors leave
 * nothing behind. */
#include "shear/field.h"
#include "test_mock_fixture.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct place {
    char dir[64];
    char file[96];
};

static int set_up(void **state) {
    struct place *p = calloc(1, sizeof *p);
    if (p == NULL)
        return -1;
    const char *tmp = getenv("TMPDIR");
    snprintf(p->dir, sizeof p->dir, "%.40s/mock-XXXXXX", tmp != NULL ? tmp : "/tmp");
    if (mkdtemp(p->dir) == NULL) {
        free(p);
        return -1;
    }
    snprintf(p->file, sizeof p->file, "%s/m.fits", p->dir);
    *state = p;
    return 0;
}

static int tear_down(void **state) {
    struct place *p = *state;
    unlink(p->file);
    int code = rmdir(p->dir); /* fails where something was left behind */
    free(p);
    return code;
}

static int files_in(const char *dir) {
    int n = 0;
    DIR *d = opendir(dir);
    assert_non_null(d);
    while (readdir(d) != NULL)
        n++;
    closedir(d);
    return n - 2; /* . and .. */
}

static void write_good(const shear_mock *m, const char *path, int threads) {
    shear_mock_write_options o = {.threads = threads, .overwrite = true};
    shear_error err = {0};
    if (shear_mock_write(m, path, &o, &err) != 0)
        fail_msg("%s", err.message);
}

/* The PSF that the reader gives for stamp i. */
static const double *psf_of_stamp(const shear_block *b, int i, size_t samples) {
    return b->stamps.psf + (size_t)b->stamps.psf_index[i] * samples;
}

static void check_block(const shear_mock *m, const shear_field_info *info, const shear_block *b,
                        int n, double tolerance) {
    size_t pixels = (size_t)info->geometry.nx * (size_t)info->geometry.ny;
    size_t samples = (size_t)info->geometry.psf_nx * (size_t)info->geometry.psf_ny;
    double *galaxy, *noise, *psf = doubles(samples);
    make_stamps(m, 0, n, 0, &galaxy, &noise);
    for (size_t k = 0; k < (size_t)n * pixels; k++) {
        assert_close(b->galaxy[k], galaxy[k], tolerance * 100.0);
        assert_close(b->noise[k], noise[k], tolerance * 100.0);
    }
    for (int i = 0; i < n; i++) {
        double x, y;
        shear_mock_centre(m, i, &x, &y);
        assert_int_equal(b->id[i], i);
        assert_true(b->x[i] == x && b->y[i] == y);
        if (info->psf_layout != SHEAR_PSF_ONE) {
            shear_mock_psf_image(m, shear_mock_psf_of(m, i), psf);
            for (size_t k = 0; k < samples; k++)
                assert_close(psf_of_stamp(b, i, samples)[k], psf[k], tolerance);
        }
    }
    free(galaxy);
    free(noise);
    free(psf);
}

/* Read `path` back whole and hold it against the mock. */
static void check_file(const shear_mock *m, const char *path) {
    const shear_mock_info *made = shear_mock_get_info(m);
    const shear_mock_spec *s = shear_mock_get_spec(m);
    shear_error err = {0};
    shear_field *field = NULL;
    shear_block *block = NULL;
    if (shear_field_open(&field, path, &err) != 0)
        fail_msg("%s", err.message);
    const shear_field_info *info = shear_field_get_info(field);
    int n = (int)info->n_stamps;
    assert_int_equal(info->n_stamps, made->n_stamps);
    assert_int_equal(info->n_psf, made->n_psf);
    assert_int_equal(info->psf_layout, made->psf_layout);
    assert_int_equal(info->layout, s->layout);
    assert_int_equal(info->bitpix, s->bitpix);
    assert_memory_equal(&info->geometry, &made->geometry, sizeof info->geometry);
    assert_true(info->has_truth && info->sim_g1 == s->g1 && info->sim_g2 == s->g2);
    assert_string_equal(info->name, s->field[0] ? s->field : "m");
    assert_int_equal((info->columns & SHEAR_COL_R_GAL) != 0, s->write_r_gal);
    assert_int_equal(shear_block_new(&block, info, n, &err), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, n, block, &err), SHEAR_OK);
    check_block(m, info, block, n, s->bitpix == -32 ? 1e-7 : 1e-15);
    for (int i = 0; s->write_r_gal && i < n; i++)
        assert_true(block->r_gal[i] == s->r_gal_px);
    shear_block_free(block);
    shear_field_close(field);
}

#define TINY "size", "24x20", "r-gal", "4", "points", "30", "r-psf", "1", "stamps", "11"

static void test_layouts(void **state) {
    struct place *p = *state;
    static const char *const layouts[] = {"cube", "mosaic"};
    static const char *const types[] = {"-32", "-64"};
    for (int k = 0; k < 4; k++) {
        const char *layout = layouts[k % 2];
        const char *type = types[k / 2];
        shear_mock *one = MOCK(TINY, "layout", layout, "bitpix", type, "oversamp", "3", "field",
                               "Some field", "white", "1");
        shear_mock *ids = MOCK(TINY, "layout", layout, "bitpix", type, "psf-ids", "3", "psf", "b");
        shear_mock *each =
            MOCK(TINY, "layout", layout, "bitpix", type, "psf-per-stamp", "yes", "no-r-gal", "yes");
        shear_mock *all[] = {one, ids, each};
        for (int i = 0; i < 3; i++) {
            write_good(all[i], p->file, 2);
            check_file(all[i], p->file);
            shear_mock_free(all[i]);
        }
    }
    assert_int_equal(files_in(p->dir), 1);
}

static char *read_all(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    assert_int_equal(fseek(f, 0, SEEK_END), 0);
    *size = (size_t)ftell(f);
    rewind(f);
    char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, f), *size);
    bytes[*size] = '\0';
    fclose(f);
    return bytes;
}

/* No date, no thread, no order of work in the file; 40 stamps of 256 px are three chunks and more.
 */
static void test_same_bytes(void **state) {
    struct place *p = *state;
    size_t n1, n2;
    shear_mock *m = MOCK("size", "256", "stamps", "40", "points", "20", "white", "1");
    write_good(m, p->file, 1);
    char *first = read_all(p->file, &n1);
    write_good(m, p->file, 3);
    check_file(m, p->file); /* every chunk is in its place */
    char *second = read_all(p->file, &n2);
    assert_int_equal(n1, n2);
    assert_true(memcmp(first, second, n1) == 0);
    free(first);
    free(second);
    shear_mock_free(m);
}

static void test_history(void **state) {
    struct place *p = *state;
    shear_mock *m = MOCK(TINY, "photons", "12.5", "seed", "77");
    size_t size, n;
    write_good(m, p->file, 1);
    char *bytes = read_all(p->file, &size);
    for (size_t i = 0; i < size; i++) {
        bytes[i] = bytes[i] ? bytes[i] : ' '; /* one string */
    }
    const shear_mock_option *table = shear_mock_options(&n);
    for (size_t i = 0; i < n; i++) {
        char value[96], line[160];
        shear_mock_format(shear_mock_get_spec(m), &table[i], value, sizeof value);
        snprintf(line, sizeof line, "HISTORY mock %s = %s", table[i].name, value);
        if (strstr(bytes, line) == NULL)
            fail_msg("no card \"%s\"", line);
    }
    free(bytes);
    shear_mock_free(m);
}

static void test_existing_file(void **state) {
    struct place *p = *state;
    shear_mock *m = MOCK(TINY);
    shear_error err = {0};
    assert_int_equal(shear_mock_write(m, p->file, NULL, &err), SHEAR_OK);
    assert_int_equal(shear_mock_write(m, p->file, NULL, &err), SHEAR_E_EXISTS);
    check_file(m, p->file); /* untouched */
    shear_mock_free(m);
}

static void test_unwritable(void **state) {
    struct place *p = *state;
    char path[160];
    shear_mock *m = MOCK(TINY);
    shear_error err = {0};
    snprintf(path, sizeof path, "%s/none/m.fits", p->dir);
    assert_int_equal(shear_mock_write(m, path, NULL, &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "none"));
    assert_int_equal(files_in(p->dir), 0);
    shear_mock_free(m);
}

struct calls {
    int n, stop_at;
    int64_t done, total;
};

static int count_calls(void *context, int64_t done, int64_t total) {
    struct calls *c = context;
    assert_true(done > c->done); /* it only grows */
    c->n++;
    c->done = done;
    c->total = total;
    return c->n == c->stop_at;
}

static void test_progress_and_cancel(void **state) {
    struct place *p = *state;
    shear_mock *m = MOCK("size", "256", "stamps", "40", "points", "20");
    shear_error err = {0};
    struct calls calls = {0};
    shear_mock_write_options o = {.threads = 2, .progress = count_calls, .context = &calls};
    assert_int_equal(shear_mock_write(m, p->file, &o, &err), SHEAR_OK);
    assert_true(calls.n > 1 && calls.done == 40 && calls.total == 40);
    assert_int_equal(unlink(p->file), 0);
    calls = (struct calls){.stop_at = 2};
    assert_int_equal(shear_mock_write(m, p->file, &o, &err), SHEAR_E_CANCELLED);
    assert_int_equal(calls.n, 2);
    assert_int_equal(files_in(p->dir), 0);
    shear_mock_free(m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_layouts, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_same_bytes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_history, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_existing_file, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_unwritable, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_progress_and_cancel, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
