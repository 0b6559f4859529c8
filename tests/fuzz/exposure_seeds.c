/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exposures as LSST writes them, with a segmentation, in all compressions. */
#include "seeds.h"

#include "fits_fixture.h"
#include "survey/pixels/chip_pixels.h"

#include <stdio.h>
#include <stdlib.h>

enum { NX = 30, NY = 20, N = NX * NY, COMPRESSIONS = 6 };

static const int bitpix[FUZZ_SEEDS / COMPRESSIONS] = {16, 32, -32};
static const struct {
    const char *name;
    int code;
} compressions[COMPRESSIONS] = {{"plain", 0},      {"rice", RICE_1}, {"gzip1", GZIP_1},
                                {"gzip2", GZIP_2}, {"plio", PLIO_1}, {"hcompress", HCOMPRESS_1}};

const char *fuzz_seed_name(int i) {
    return compressions[i % COMPRESSIONS].name;
}

/* Append an image that is `type`, with a few more keywords. */
static void append(fitsfile *f, int i, const char *type, int layer) {
    const bool of_floats = layer == 2;
    double pixels[N];
    const fixture_image image = {.name = layer == 3 ? "SEG" : "",
                                 .bitpix = of_floats ? -32 : bitpix[i / COMPRESSIONS],
                                 .naxis = 2,
                                 .axes = {NX, NY, 1},
                                 .compression = compressions[i % COMPRESSIONS].code,
                                 .tile = {NX, i % 2 == 0 ? 4 : NY, 1},
                                 .lossy = true};
    for (int k = 0; k < N; k++)
        pixels[k] = layer == 0 ? 100 + k % 37 : k / 50 % (layer + 2);
    fixture_image written = image;
    if (image.bitpix < 0 && image.compression == PLIO_1)
        written.compression = RICE_1; /* PLIO packs integers only */
    fixture_append(f, &written, pixels);
    int status = 0;
    fits_write_key_str(f, "EXTTYPE", type, NULL, &status);
    fits_write_key_lng(f, layer == 0 ? "SATURATE" : "MP_BAD", layer == 0 ? 130 : 1, NULL, &status);
    fits_write_key_lng(f, "HIERARCH MP_NO_DATA", 2, NULL, &status);
    fits_write_key_lng(f, "MP_SAT", 0, NULL, &status);
    assert_int_equal(status, 0);
}

fuzz_bytes fuzz_seed(int i) {
    static const char *const types[] = {"IMAGE", "MASK", "VARIANCE", "SEG"};
    const char *path = fixture_path("seed.fits");
    fitsfile *f = fixture_create(path);
    for (int layer = 0; layer < 4; layer++)
        append(f, i, types[layer], layer);
    fixture_close(f);
    fuzz_bytes b = {0};
    b.data = fixture_load(path, &b.size);
    return b;
}

bool fuzz_seed_is_good(const char *path) {
    shear_input input = shear_input_of_file(NULL);
    exposure_images *e = NULL;
    chip_pixels *c = NULL;
    double value = 0.0;
    const pixel_box box = {NX - 1, NY - 1, 1, 1, &value, NULL, NULL, NULL};
    shear_error err = {0};
    input.parts[SHEAR_PART_IMAGE].path = path;
    const bool good = exposure_images_open(&e, &input, NULL, &err) == SHEAR_OK &&
                      exposure_images_hdu(e, 0, SHEAR_PART_MASK) == 2 &&
                      chip_pixels_open(&c, e, 0, NULL, 0, &err) == SHEAR_OK &&
                      chip_pixels_read(c, &box, &err) == SHEAR_OK;
    if (!good)
        fprintf(stderr, "fuzz_exposure: %s\n", err.message);
    chip_pixels_close(c);
    exposure_images_close(e);
    return good;
}
