/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear-chips IMAGE WEIGHT MASK SEGMENTATION SOURCES PSF SELECT: times of the stages of `shearctl
 * measure` on an exposure, each by itself, in microseconds of processor time of one thread, a line
 * each; for bench/survey. "floor" reads the pixels of the images by pread, and swaps their bytes.
 */
#include "timer.h"

#include "base/cleanup.h"
#include "fits/header/file.h"
#include "measure/internal.h"
#include "shear/run.h"
#include "shear/settings.h"
#include "survey/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { BLOCK = 16, READ_BYTES = 1 << 20 };

typedef struct bench {
    shear_input input;
    shear_field *field;
    shear_plan *plan;
    shear_workspace *ws;
    shear_block *block;
    shear_row rows[BLOCK];
    double start, cut, psf, pairs;
} bench;

static void must(int code, const shear_error *err) {
    if (code != SHEAR_OK) {
        fprintf(stderr, "shear-chips: %s\n", err->message);
        exit(1);
    }
}

static void say(const char *stage, double us) {
    printf("%s %.0f\n", stage, us);
}

/* Say how long it took since the last call. */
static void lap(bench *b, const char *stage) {
    say(stage, timer_processor_us() - b->start);
    b->start = timer_processor_us();
}

/* Swap the bytes of n words; return a sum, so that they are made. */
static uint32_t swap(const unsigned char *bytes, size_t n, int width) {
    uint32_t sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += width == 2 ? __builtin_bswap16(((const uint16_t *)(const void *)bytes)[i])
                          : __builtin_bswap32(((const uint32_t *)(const void *)bytes)[i]);
    }
    return sum;
}

static uint32_t read_hdu(const sf_file *f, const sf_hdu *hdu, unsigned char *buffer) {
    const int width = hdu->bitpix == 16 ? 2 : 4;
    uint32_t sum = 0;
    for (int64_t at = 0; at < hdu->data_bytes; at += READ_BYTES) {
        const int64_t left = hdu->data_bytes - at;
        const size_t n = left < READ_BYTES ? (size_t)left : READ_BYTES;
        if (pread(f->source.fd, buffer, n, hdu->data_offset + at) != (ssize_t)n)
            exit(1);
        sum += swap(buffer, n / (size_t)width, width);
    }
    return sum;
}

static void read_alone(const shear_input *input) {
    shear_error err;
    unsigned char *buffer = aligned_alloc(64, READ_BYTES);
    uint32_t sum = 0;
    for (int part = SHEAR_PART_IMAGE; part <= SHEAR_PART_SEGMENTATION && buffer != NULL; part++) {
        sf_file f;
        must(sf_file_open(&f, input->parts[part].path, -1, &err), &err);
        for (int i = 0; i < f.count; i++)
            sum += read_hdu(&f, &f.hdus[i], buffer);
        sf_file_close(&f);
    }
    free(buffer);
    if (sum == 0) /* so that no compiler leaves the reading out */
        fputs("all pixels are 0\n", stderr);
}

/* Have all pixels of a chip read, and let them go. */
static void read_pixels(const exposure *e, int chip) {
    shear_error err;
    chip_pixels *pixels = NULL;
    int nx;
    int ny;
    exposure_images_size(e->images, chip, &nx, &ny);
    must(chip_pixels_open(&pixels, e->images, chip, NULL, 0, &err), &err);
    uint8_t *column = malloc((size_t)ny);
    const pixel_box box = {.nx = 1, .ny = ny, .defect = column};
    must(chip_pixels_read(pixels, &box, &err), &err);
    chip_pixels_close(pixels);
    free(column);
}

/* Cut and measure a block of stamps, and choose their PSFs alone. */
static void measure_block(bench *b, int64_t first, int count) {
    shear_error err;
    const double start = timer_processor_us();
    must(shear_field_read(b->field, first, count, b->block, &err), &err);
    const double cut = timer_processor_us();
    for (int i = 0; i < count; i++) {
        stamp_pair s = measure_pair_at(b->plan, b->ws, &b->block->stamps, i);
        uint32_t flags = 0;
        if (b->block->dropped[i] == 0)
            pair_transfer_choose(&s, &flags);
    }
    const double chosen = timer_processor_us();
    must(shear_measure_range(b->plan, b->ws, &b->block->stamps, 0, count, b->rows, &err), &err);
    b->cut += cut - start;
    b->psf += chosen - cut;
    b->pairs += timer_processor_us() - chosen;
}

static void measure(bench *b) {
    shear_error err;
    const shear_field_info *info = shear_field_get_info(b->field);
    must(shear_block_new(&b->block, info, BLOCK, &err), &err);
    must(shear_workspace_new(&b->ws, b->plan, &err), &err);
    for (int64_t first = 0; first < info->n_stamps; first += BLOCK) {
        const int64_t left = info->n_stamps - first;
        measure_block(b, first, left < BLOCK ? (int)left : BLOCK);
    }
    say("cutting", b->cut);
    say("PSFs", b->psf);
    say("pairs", b->pairs);
    shear_workspace_free(b->ws);
    shear_block_free(b->block);
}

static void run(bench *b) {
    shear_error err;
    shear_settings settings;
    char checksum[SHEAR_CHECKSUM_SIZE];
    shear_settings_init(&settings);
    b->start = timer_processor_us();
    must(shear_field_open_input(&b->field, &b->input, NULL, &err), &err);
    exposure *e = exposure_of(b->field);
    lap(b, "opening");
    must(shear_input_checksum(&b->input, NULL, &e->base.info, checksum, &err), &err);
    lap(b, "identity");
    read_alone(&b->input);
    lap(b, "floor");
    for (int i = 0; i < e->n_chips; i++)
        read_pixels(e, i);
    lap(b, "pixels");
    must(exposure_hold(e, 0, &err), &err);
    lap(b, "pixels and survey");
    must(shear_plan_for_field(&b->plan, &settings, b->field, &err), &err);
    lap(b, "plan");
    measure(b);
    b->start = timer_processor_us();
    shear_plan_free(b->plan);
    shear_field_close(b->field);
    lap(b, "closing");
}

int main(int argc, char **argv) {
    static const enum shear_part parts[] = {SHEAR_PART_IMAGE,   SHEAR_PART_WEIGHT,
                                            SHEAR_PART_MASK,    SHEAR_PART_SEGMENTATION,
                                            SHEAR_PART_CATALOG, SHEAR_PART_PSF};
    enum { PARTS = sizeof parts / sizeof parts[0] };
    bench b = {.input.exposure = {.origin = 1}};
    if (argc != PARTS + 2) {
        fprintf(stderr, "usage: shear-chips IMAGE WEIGHT MASK SEGMENTATION SOURCES PSF SELECT\n");
        return 2;
    }
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        b.input.parts[i].hdu = -1;
    for (int i = 0; i < PARTS; i++)
        b.input.parts[parts[i]].path = argv[i + 1];
    b.input.exposure.select = argv[PARTS + 1];
    run(&b);
    return 0;
}
