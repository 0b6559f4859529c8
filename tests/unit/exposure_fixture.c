/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exposure_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

shear_input exposure_input(const char *image, const char *weight, const char *mask,
                           const char *segmentation) {
    shear_input input = {.exposure.origin = 1};
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        input.parts[i].hdu = -1;
    input.parts[SHEAR_PART_IMAGE].path = image;
    input.parts[SHEAR_PART_WEIGHT].path = weight;
    input.parts[SHEAR_PART_MASK].path = mask;
    input.parts[SHEAR_PART_SEGMENTATION].path = segmentation;
    return input;
}

exposure_images *exposure_open(const shear_input *input) {
    exposure_images *e = NULL;
    shear_error err = {0};
    if (exposure_images_open(&e, input, NULL, &err) != SHEAR_OK)
        fail_msg("%s (%s)", err.message, err.advice);
    assert_non_null(e);
    return e;
}

void exposure_expect(const shear_input *input, int code, ...) {
    exposure_images *e = NULL;
    shear_error err = {0};
    assert_int_equal(exposure_images_open(&e, input, NULL, &err), code);
    assert_null(e);
    assert_int_equal(err.code, code);
    va_list words;
    va_start(words, code);
    for (const char *word = va_arg(words, const char *); word != NULL;
         word = va_arg(words, const char *)) {
        if (strstr(err.message, word) == NULL && strstr(err.advice, word) == NULL)
            fail_msg("no '%s' in: %s (%s)", word, err.message, err.advice);
    }
    va_end(words);
}

void exposure_write(const char *path, const char *name, int bitpix, int nx, int ny,
                    const double *pixels) {
    const fixture_image image = {
        .name = name != NULL ? name : "", .bitpix = bitpix, .naxis = 2, .axes = {nx, ny, 1}};
    fitsfile *f = NULL;
    int status = 0;
    if (name != NULL) {
        f = fixture_create(path);
    } else {
        remove(path);
        fits_create_diskfile(&f, path, &status);
        assert_int_equal(status, 0);
    }
    fixture_append(f, &image, pixels);
    fixture_close(f);
}

chip_arrays exposure_read(const exposure_images *e, int i, const object_shape *shapes, int64_t n) {
    chip_arrays a = {0};
    chip_pixels *c = NULL;
    shear_error err = {0};
    exposure_images_size(e, i, &a.nx, &a.ny);
    const size_t pixels = (size_t)a.nx * (size_t)a.ny;
    a.value = malloc(pixels * sizeof *a.value);
    a.sigma = malloc(pixels * sizeof *a.sigma);
    a.defect = malloc(pixels);
    a.owner = malloc(pixels * sizeof *a.owner);
    if (chip_pixels_open(&c, e, i, shapes, n, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    const pixel_box box = {0, 0, a.nx, a.ny, a.value, a.sigma, a.defect, a.owner};
    if (chip_pixels_read(c, &box, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    chip_pixels_close(c);
    return a;
}

void chip_arrays_free(chip_arrays *a) {
    free(a->value);
    free(a->sigma);
    free(a->defect);
    free(a->owner);
}

chip_arrays exposure_read_all(const shear_input *input) {
    exposure_images *e = exposure_open(input);
    assert_int_equal(exposure_images_chips(e), 1);
    const chip_arrays a = exposure_read(e, 0, NULL, 0);
    exposure_images_close(e);
    return a;
}

const char *exposure_shared(const char *name) {
    static char paths[8][600];
    static int next;
    char *path = paths[next];
    next = (next + 1) % 8;
    snprintf(path, sizeof paths[0], "%s/survey/%s", SHEAR_SHARED, name);
    return access(path, R_OK) == 0 ? path : NULL;
}
