/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as the images of an exposure: opening them and reading boxes of pixels must neither
 * crash nor leak, whatever they are. Like fuzz_field.c, a libFuzzer target or an ordinary test. */
#include "fuzz_field.h"

#include "cards.h"
#include "survey/pixels/chip_pixels.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Small files may honestly describe large images where they are compressed; those would only slow
 * the search down. */
enum { MAX_PIXELS = 1 << 24, MAX_CHIPS = 3, SHAPES = 6, SIDE = 24 };

/* Read boxes at corners of a chip, in its middle and beyond it. */
static void read_boxes(chip_pixels *c, int nx, int ny) {
    static double value[SIDE * SIDE];
    static float sigma[SIDE * SIDE];
    static uint8_t defect[SIDE * SIDE];
    static int32_t owner[SIDE * SIDE];
    const int places[][2] = {{-3, -4}, {nx / 2, ny / 2}, {nx - 5, ny - 6}, {nx, 0}};
    for (int i = 0; i < 4; i++) {
        const pixel_box box = {places[i][0], places[i][1], SIDE, SIDE, value, sigma, defect, owner};
        shear_error err = {0};
        (void)chip_pixels_read(c, &box, &err);
    }
}

static void read_chip(const exposure_images *e, int i, const uint8_t *bytes, size_t size) {
    object_shape shapes[SHAPES] = {{10.0, 5.0, 4.0, 2.0, 0.5, 1}};
    const size_t n = size < sizeof shapes ? size : sizeof shapes - sizeof shapes[0];
    int nx = 0;
    int ny = 0;
    chip_pixels *c = NULL;
    exposure_images_size(e, i, &nx, &ny);
    if ((int64_t)nx * ny > MAX_PIXELS)
        return;
    memcpy(shapes + 1, bytes + size / 2, n / 2);
    if (chip_pixels_open(&c, e, i, shapes, SHAPES, NULL) == SHEAR_OK)
        read_boxes(c, nx, ny);
    chip_pixels_close(c);
}

static void read_all(const exposure_images *e, const uint8_t *bytes, size_t size) {
    for (int i = 0; i < exposure_images_chips(e) && i < MAX_CHIPS; i++) {
        int64_t count = 0;
        (void)exposure_images_header(e, i, &count);
        (void)exposure_images_name(e, i);
        read_chip(e, i, bytes, size);
    }
}

static void open_and_read(int fd, const shear_input *input, const uint8_t *bytes, size_t size) {
    int fds[SHEAR_N_PARTS];
    exposure_images *e = NULL;
    shear_error err = {0};
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        fds[i] = fd;
    if (exposure_images_open(&e, input, fds, &err) == SHEAR_OK)
        read_all(e, bytes, size);
    exposure_images_close(e);
}

/* Let the bytes themselves choose the parts and options. */
static void choose(shear_input *input, const uint8_t *bytes, size_t size) {
    static const char *const rules[] = {NULL,      "any", "zero", "bits=5", "planes=BAD,SAT",
                                        "planes=X"};
    static const int parts[] = {SHEAR_PART_WEIGHT, SHEAR_PART_MASK, SHEAR_PART_SEGMENTATION};
    uint64_t state = size;
    for (size_t i = 0; i < size; i++)
        state = 31 * state + bytes[i];
    for (int i = 0; i < 3; i++) {
        const int hdu = (int)fuzz_below(&state, 8) - 1;
        if (fuzz_below(&state, 2) == 0)
            input->parts[parts[i]] = (shear_input_part){"input.fits", NULL, hdu};
    }
    input->exposure.mask_bad = rules[fuzz_below(&state, sizeof rules / sizeof rules[0])];
    input->exposure.weight_kind = (enum shear_weight_kind)fuzz_below(&state, 3);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const int fd = memfd_create("exposure", MFD_CLOEXEC);
    if (fd < 0)
        return 0;
    if (write(fd, bytes, size) == (ssize_t)size) {
        shear_input input = shear_input_of_file(NULL);
        input.parts[SHEAR_PART_IMAGE] = (shear_input_part){"input.fits", NULL, -1};
        open_and_read(fd, &input, bytes, size); /* with what the file says belongs to it */
        choose(&input, bytes, size);
        open_and_read(fd, &input, bytes, size);
    }
    close(fd);
    return 0;
}
