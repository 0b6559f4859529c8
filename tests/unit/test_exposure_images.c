/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which HDUs are an exposure's chips, what belongs to them, and what their headers say. */
#include "exposure_fixture.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define END ((const char *)NULL)

enum { NX = 12, NY = 9, N = NX * NY };

static const char *image(void) {
    return fixture_path("image.fits");
}

static const char *other(void) {
    return fixture_path("other.fits");
}

/* Write a file of images with these EXTNAMEs; all pixels of the k-th one are first + k. */
static void write_images(const char *path, const char *const *names, double first,
                         int compression) {
    fitsfile *f = fixture_create(path);
    double pixels[N];
    for (int k = 0; names[k] != NULL; k++) {
        const fixture_image one = {.name = names[k],
                                   .bitpix = 16,
                                   .naxis = 2,
                                   .axes = {NX, NY, 1},
                                   .compression = compression};
        for (int i = 0; i < N; i++)
            pixels[i] = first + k;
        fixture_append(f, &one, pixels);
    }
    fixture_close(f);
}

/* Write a keyword with a text (number NULL) or number into an HDU. */
static void put_text(const char *path, int hdu, const char *key, const char *text) {
    fitsfile *f = NULL;
    int status = 0;
    fits_open_diskfile(&f, path, READWRITE, &status);
    fits_movabs_hdu(f, hdu + 1, NULL, &status);
    fits_update_key_str(f, key, text, NULL, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
}

static void put_number(const char *path, int hdu, const char *key, int number) {
    fitsfile *f = NULL;
    int status = 0;
    fits_open_diskfile(&f, path, READWRITE, &status);
    fits_movabs_hdu(f, hdu + 1, NULL, &status);
    fits_update_key_lng(f, key, number, NULL, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
}

/* ---- chips ---- */

static void chips_by_name(void **state) {
    (void)state;
    static const char *const names[] = {"N1", "S2", "N3", NULL};
    static const char *const shuffled[] = {"n3", "N1", "S2", NULL};
    for (int compression = 0; compression <= RICE_1; compression += RICE_1) {
        write_images(image(), names, 100.0, compression);
        write_images(other(), shuffled, 1.0, compression);
        const shear_input input = exposure_input(image(), NULL, NULL, other());
        exposure_images *e = exposure_open(&input);
        assert_int_equal(exposure_images_chips(e), 3);
        static const int expected[] = {2, 3, 1};
        for (int i = 0; i < 3; i++) {
            chip_arrays a = exposure_read(e, i, NULL, 0);
            assert_string_equal(exposure_images_name(e, i), names[i]);
            assert_int_equal(exposure_images_hdu(e, i, SHEAR_PART_IMAGE), i + 1);
            assert_int_equal(exposure_images_hdu(e, i, SHEAR_PART_SEGMENTATION), expected[i]);
            assert_int_equal(exposure_images_hdu(e, i, SHEAR_PART_MASK), -1);
            assert_true(a.nx == NX && a.ny == NY && a.value[N - 1] == 100.0 + i);
            assert_int_equal(a.owner[N - 1], expected[i]);
            chip_arrays_free(&a);
        }
        exposure_images_close(e);
    }
}

static void chips_by_order(void **state) {
    (void)state;
    static const char *const names[] = {"A", "B", NULL};
    static const char *const others[] = {"", "", NULL};
    static const char *const same[] = {"A", "A", NULL};
    write_images(other(), others, 1.0, 0);
    for (int k = 0; k < 3; k++) {
        write_images(image(), k == 0 ? names : k == 1 ? others : same, 100.0, 0);
        shear_input input = exposure_input(image(), NULL, NULL, other());
        exposure_images *e = exposure_open(&input);
        assert_int_equal(exposure_images_chips(e), 2);
        for (int i = 0; i < 2; i++)
            assert_int_equal(exposure_images_hdu(e, i, SHEAR_PART_SEGMENTATION), i + 1);
        exposure_images_close(e);
        input.parts[SHEAR_PART_IMAGE].hdu = 2; /* the place among all images of the file counts */
        e = exposure_open(&input);
        assert_int_equal(exposure_images_chips(e), 1);
        assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_SEGMENTATION), 2);
        exposure_images_close(e);
    }
}

/* fpack's own EXTNAME is none, and may be followed by the image's. */
static void packers_name(void **state) {
    (void)state;
    static const char *const names[] = {"COMPRESSED_IMAGE", NULL};
    write_images(image(), names, 5.0, RICE_1);
    const shear_input input = exposure_input(image(), NULL, NULL, NULL);
    exposure_images *e = exposure_open(&input);
    assert_string_equal(exposure_images_name(e, 0), "");
    exposure_images_close(e);
    fixture_patch(image(), "COMPRESSED_IMAGE", "OTHER", "'N15'");
    size_t size = 0;
    unsigned char *bytes = fixture_load(image(), &size);
    unsigned char *card = memmem(bytes, size, "OTHER   = 'N15'", 15);
    assert_non_null(card);
    memcpy(card, "EXTNAME ", 8);
    fixture_save(image(), bytes, size);
    free(bytes);
    e = exposure_open(&input);
    assert_string_equal(exposure_images_name(e, 0), "N15");
    exposure_images_close(e);
    fixture_patch(image(), "COMPRESSED_IMAGE", "EXTNAME", "'CHIP'");
    exposure_expect(&input, SHEAR_E_FORMAT, "EXTNAME is given twice", END);
}

static void chosen_hdus(void **state) {
    (void)state;
    static const char *const names[] = {"SCI", "WHT", "DQ", NULL};
    write_images(image(), names, 3.0, 0);
    shear_input input = exposure_input(image(), image(), image(), NULL);
    exposure_images *e = exposure_open(&input); /* EXTNAME says what they are */
    assert_int_equal(exposure_images_chips(e), 1);
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_WEIGHT), 2);
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_MASK), 3);
    exposure_images_close(e);
    input.parts[SHEAR_PART_MASK].extname = "wht";
    input.parts[SHEAR_PART_WEIGHT].hdu = 3;
    e = exposure_open(&input);
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_WEIGHT), 3);
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_MASK), 2);
    struct {
        int64_t hdu;
        const char *word;
    } wrong[] = {{0, "HDU 0 is no 2-D image"}, {4, "no HDU number 4"}, {1, "the same HDU"}};
    for (int i = 0; i < 3; i++) {
        input.parts[SHEAR_PART_WEIGHT].hdu = wrong[i].hdu;
        exposure_expect(&input, SHEAR_E_FORMAT, "image.fits", wrong[i].word, END);
    }
    exposure_images_close(e);
}

/* ---- threads ---- */

static const exposure_images *common;

/* Read a chip 20 times; its pixels are 100 + chip. */
static void *read_chip(void *number) {
    const int chip = *(const int *)number;
    for (int i = 0; i < 20; i++) {
        double value = NAN;
        int32_t owner = -1;
        const pixel_box box = {i % NX, i % NY, 1, 1, &value, NULL, NULL, &owner};
        chip_pixels *c = NULL;
        if (chip_pixels_open(&c, common, chip, NULL, 0, NULL) != SHEAR_OK ||
            chip_pixels_read(c, &box, NULL) != SHEAR_OK || value != 100.0 + chip ||
            owner != 1 + chip) {
            return number;
        }
        chip_pixels_close(c);
    }
    return NULL;
}

static void chips_in_threads(void **state) {
    (void)state;
    static const char *const names[] = {"A", "B", "C", "D", NULL};
    enum { THREADS = 4 };
    pthread_t threads[THREADS];
    int numbers[THREADS];
    write_images(image(), names, 100.0, RICE_1);
    write_images(other(), names, 1.0, RICE_1);
    const shear_input input = exposure_input(image(), NULL, NULL, other());
    exposure_images *e = exposure_open(&input);
    common = e;
    for (int i = 0; i < THREADS; i++) {
        numbers[i] = i;
        assert_int_equal(pthread_create(&threads[i], NULL, read_chip, &numbers[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        void *failed = NULL;
        pthread_join(threads[i], &failed);
        assert_null(failed);
    }
    exposure_images_close(e);
}

static void mismatches(void **state) {
    (void)state;
    static const char *const names[] = {"A", "B", "C", NULL};
    static const char *const two[] = {"X", "Y", NULL};
    static const char *const overlap[] = {"A", "B", "D", NULL};
    const double pixels[N] = {0.0};
    write_images(image(), names, 0.0, 0);
    const shear_input input = exposure_input(image(), other(), NULL, NULL);
    write_images(other(), two, 0.0, 0);
    exposure_expect(&input, SHEAR_E_FORMAT, "other.fits", "2 2-D images", "3 chips", END);
    write_images(other(), overlap, 0.0, 0);
    exposure_expect(&input, SHEAR_E_FORMAT, "other.fits", "not for C (HDU 3", END);
    exposure_write(image(), "A", 16, NX, NY, pixels);
    exposure_write(other(), "A", 16, NY, NX, pixels);
    exposure_expect(&input, SHEAR_E_FORMAT, "other.fits", "HDU A", "weight has 9 x 12", "12 x 9",
                    END);
    const fixture_image cube = {.name = "A", .bitpix = 16, .naxis = 3, .axes = {NX, 3, 3}};
    fitsfile *f = fixture_create(other());
    fixture_append(f, &cube, pixels);
    fixture_close(f);
    exposure_expect(&input, SHEAR_E_FORMAT, "other.fits", "be the weight", END);
    const fixture_image tall = {.name = "A", .bitpix = 8, .naxis = 2, .axes = {1, 2000001, 1}};
    double *column = calloc(2000001, sizeof *column);
    f = fixture_create(other());
    fixture_append(f, &tall, column);
    fixture_close(f);
    free(column);
    exposure_expect(&input, SHEAR_E_FORMAT, "other.fits", "1 x 2000001 pixels", END);
    f = fixture_create(other());
    fixture_append(f, &cube, pixels);
    fixture_close(f);
    const shear_input cubes = exposure_input(other(), NULL, NULL, NULL);
    exposure_expect(&cubes, SHEAR_E_FORMAT, "other.fits", "be the image", END);
    const shear_input missing = exposure_input(fixture_path("none.fits"), NULL, NULL, NULL);
    exposure_expect(&missing, SHEAR_E_IO, "none.fits", END);
}

/* ---- LSST ---- */

static void lsst_layers(void **state) {
    (void)state;
    static const char *const names[] = {"", "", "", NULL};
    write_images(image(), names, 4.0, 0);
    put_text(image(), 1, "EXTTYPE", "IMAGE");
    put_text(image(), 2, "EXTTYPE", "MASK");
    put_text(image(), 3, "EXTTYPE", "VARIANCE");
    put_number(image(), 2, "MP_BAD", 1);
    shear_input input = exposure_input(image(), NULL, NULL, NULL);
    exposure_images *e = exposure_open(&input);
    assert_int_equal(exposure_images_chips(e), 1);
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_MASK), 2);
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_WEIGHT), 3);
    chip_arrays a = exposure_read(e, 0, NULL, 0);
    assert_true(a.value[0] == 4.0 && a.sigma[0] == sqrtf(6.0F));
    assert_int_equal(a.defect[0], 0); /* the mask is 5: bits 0 and 2 */
    chip_arrays_free(&a);
    exposure_images_close(e);
    write_images(other(), (const char *const[]){"W", NULL}, 0.25, 0);
    input = exposure_input(image(), other(), NULL, NULL);
    e = exposure_open(&input); /* what is given goes before */
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_WEIGHT), 1);
    assert_int_equal(exposure_images_hdu(e, 0, SHEAR_PART_MASK), 2);
    assert_int_equal(exposure_images_bytes(e), 10 * 2880); /* headers and data of 3 + 1 images */
    exposure_images_close(e);
}

/* ---- headers ---- */

static bool has_card(const exposure_images *e, const char *begin) {
    int64_t count = 0;
    int found = 0;
    const char *header = exposure_images_header(e, 0, &count);
    for (int64_t i = 0; i < count; i++)
        found += strncmp(header + 80 * i, begin, strlen(begin)) == 0 ? 1 : 0;
    assert_true(found <= 1);
    return found == 1;
}

static void inherited_header(void **state) {
    (void)state;
    static const char *const names[] = {"A", NULL};
    write_images(image(), names, 0.0, 0);
    put_number(image(), 0, "GAIN", 2);
    put_number(image(), 0, "EXPTIME", 90);
    put_number(image(), 0, "PV1_5", 1);
    put_text(image(), 0, "CTYPE1", "RA---TPV");
    put_number(image(), 0, "SATURATE", 1000);
    put_number(image(), 1, "GAIN", 3);
    const shear_input input = exposure_input(image(), NULL, NULL, NULL);
    exposure_images *e = exposure_open(&input);
    assert_true(has_card(e, "GAIN    =                    3"));
    assert_true(has_card(e, "EXPTIME =                   90"));
    assert_true(has_card(e, "PV1_5   =") && has_card(e, "CTYPE1  =") && has_card(e, "SATURATE="));
    assert_true(has_card(e, "NAXIS1  =") && !has_card(e, "SIMPLE") && !has_card(e, "END "));
    exposure_images_close(e);
    put_text(image(), 1, "CTYPE1", "RA---TAN");
    e = exposure_open(&input);
    assert_true(has_card(e, "CTYPE1  = 'RA---TAN'") && !has_card(e, "PV1_5"));
    assert_true(has_card(e, "EXPTIME ="));
    exposure_images_close(e);
    fixture_patch(image(), "A", "INHERIT", "F");
    e = exposure_open(&input);
    assert_true(!has_card(e, "EXPTIME") && !has_card(e, "SATURATE"));
    exposure_images_close(e);
}

/* ---- real files ---- */

typedef struct shared_exposure {
    const char *image, *weight, *mask;
    int nx, ny;
    const char *name;
} shared_exposure;

/* Return the path, also of a file that is not given; set *absent if there is no such file. */
static const char *shared(const char *name, bool *absent) {
    char path[200];
    if (name == NULL)
        return NULL;
    snprintf(path, sizeof path, "%s%s", strncmp(name, "sim", 3) == 0 ? "run/" : "exposures/", name);
    const char *found = exposure_shared(path);
    *absent = *absent || found == NULL;
    return found;
}

/* Read an HDU with CFITSIO itself; NULL if there is no file. */
static double *read_directly(const char *path, int64_t hdu, long n) {
    fitsfile *f = NULL;
    int status = 0;
    int any = 0;
    double null = NAN;
    double *pixels = malloc((size_t)n * sizeof *pixels);
    fits_open_diskfile(&f, path, READONLY, &status);
    fits_movabs_hdu(f, (int)hdu + 1, NULL, &status);
    fits_read_img(f, TDOUBLE, 1, n, &null, pixels, &any, &status);
    fits_close_file(f, &status);
    assert_int_equal(status, 0);
    return pixels;
}

/* Compare the only chip with what CFITSIO reads; masks are of the kind `any`. */
static int compare_directly(const exposure_images *e, const char *const paths[3],
                            const chip_arrays *a) {
    static const enum shear_part parts[] = {SHEAR_PART_IMAGE, SHEAR_PART_WEIGHT, SHEAR_PART_MASK};
    const long n = (long)a->nx * a->ny;
    double *read[3] = {NULL};
    int bad = 0;
    for (int k = 0; k < 3; k++) {
        if (paths[k] != NULL)
            read[k] = read_directly(paths[k], exposure_images_hdu(e, 0, parts[k]), n);
    }
    for (long i = 0; i < n; i++) {
        const bool defect = isnan(read[0][i]) || (read[1] != NULL && !(read[1][i] > 0.0)) ||
                            (read[2] != NULL && read[2][i] != 0.0);
        assert_memory_equal(&a->value[i], &read[0][i], sizeof(double));
        assert_int_equal((a->defect[i] & PIXEL_BAD) != 0, defect);
        assert_true(read[1] == NULL || !(read[1][i] > 0.0) ||
                    a->sigma[i] == (float)(1.0 / sqrt(read[1][i])));
        bad += defect ? 1 : 0;
    }
    for (int k = 0; k < 3; k++)
        free(read[k]);
    return bad;
}

static void shared_exposures(void **state) {
    (void)state;
    static const shared_exposure all[] = {
        {"c4d_170916_045042_ooi_r_ls9.N15.fits", "c4d_170916_045042_oow_r_ls9.N15.fits",
         "c4d_170916_045042_ood_r_ls9.N15.fits", 101, 100, "N15"},
        {"k4m_160319_075112_ooi_zd_ls9.CCD3.fits", "k4m_160319_075112_oow_zd_ls9.CCD3.fits",
         "k4m_160319_075112_ood_zd_ls9.CCD3.fits", 204, 208, "CCD3"},
        {"ksb_160203_115029_ooi_r_v1-ccd2.fits", "ksb_160203_115029_oow_r_v1-ccd2.fits",
         "ksb_160203_115029_ood_r_v1-ccd2.fits", 60, 60, NULL},
        {"sim_sci_int16.fits.fz", "sim_wht.fits.gz", "sim_flg.fits.gz", 1536, 1536, "SCI"},
        {"ntt_emmi_galaxies.fits", "ntt_emmi_galaxies.weight.fits", NULL, 1024, 1024, ""},
    };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        bool absent = false;
        const char *paths[] = {shared(all[i].image, &absent), shared(all[i].weight, &absent),
                               shared(all[i].mask, &absent)};
        if (absent)
            skip();
        const shear_input input = exposure_input(paths[0], paths[1], paths[2], NULL);
        exposure_images *e = exposure_open(&input);
        assert_int_equal(exposure_images_chips(e), 1);
        chip_arrays a = exposure_read(e, 0, NULL, 0);
        assert_int_equal(a.nx, all[i].nx);
        assert_int_equal(a.ny, all[i].ny);
        if (all[i].name != NULL)
            assert_string_equal(exposure_images_name(e, 0), all[i].name);
        const int bad = compare_directly(e, paths, &a);
        print_message("%s: %d of %d bad\n", all[i].image, bad, a.nx * a.ny);
        chip_arrays_free(&a);
        exposure_images_close(e);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chips_by_name),    cmocka_unit_test(chips_by_order),
        cmocka_unit_test(packers_name),     cmocka_unit_test(chosen_hdus),
        cmocka_unit_test(mismatches),       cmocka_unit_test(chips_in_threads),
        cmocka_unit_test(lsst_layers),      cmocka_unit_test(inherited_header),
        cmocka_unit_test(shared_exposures),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
