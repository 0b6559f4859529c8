/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as all files of an exposure at once, images, catalog, PSF and .head, with options that
 * the bytes choose: opening it, planning, cutting and measuring must neither crash nor leak. Like
 * fuzz_field.c, a libFuzzer target or an ordinary test. */
#include "fuzz_field.h"

#include "cards.h"
#include "shear/run.h"
#include "survey/internal.h"

#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* Small files may honestly describe large images where they are compressed; those, and large PSFs,
 * would only slow the search down. */
enum { MAX_PIXELS = 1 << 22, MAX_SAMPLES = 1 << 14, MAX_STAMPS = 12, CAPACITY = 4 };

static bool is_small(shear_field *field) {
    const exposure *e = exposure_of(field);
    const shear_field_info *info = shear_field_get_info(field);
    int64_t pixels = 0;
    for (int i = 0; i < e->n_chips; i++) {
        int nx;
        int ny;
        exposure_images_size(e->images, i, &nx, &ny);
        pixels += (int64_t)nx * ny;
    }
    return pixels <= MAX_PIXELS && info->n_psf <= MAX_STAMPS &&
           (int64_t)info->geometry.psf_nx * info->geometry.psf_ny <= MAX_SAMPLES;
}

static void measure(const shear_plan *plan, const shear_block *b) {
    shear_workspace *ws = NULL;
    shear_row row;
    shear_error err = {0};
    if (shear_workspace_new(&ws, plan, &err) == SHEAR_OK) {
        for (int i = 0; i < b->stamps.count; i++)
            (void)shear_measure(plan, ws, &b->stamps, i, &row, &err);
    }
    shear_workspace_free(ws);
}

/* Read a few blocks, from the first stamps and the last, and measure them if there is a plan. */
static void read_blocks(shear_field *field, const shear_plan *plan) {
    const shear_field_info *info = shear_field_get_info(field);
    shear_block *b = NULL;
    shear_error err = {0};
    if (shear_block_new(&b, info, CAPACITY, &err) != SHEAR_OK)
        return;
    for (int64_t first = 0; first < info->n_stamps; first += CAPACITY) {
        const int64_t left = info->n_stamps - first;
        const int count = left < CAPACITY ? (int)left : CAPACITY;
        if (first >= MAX_STAMPS && left > CAPACITY)
            continue;
        if (shear_field_read_columns(field, first, count, b, &err) == SHEAR_OK &&
            shear_field_read(field, first, count, b, &err) == SHEAR_OK && plan != NULL) {
            measure(plan, b);
        }
    }
    shear_block_free(b);
}

static void read_field(shear_field *field) {
    shear_settings settings;
    shear_plan *plan = NULL;
    shear_error err = {0};
    const shear_psf_model *models = NULL;
    (void)shear_field_get_models(field, &models);
    if (!is_small(field))
        return;
    shear_settings_init(&settings);
    (void)shear_plan_for_field(&plan, &settings, field, &err);
    read_blocks(field, plan);
    shear_plan_free(plan);
}

static void open_and_read(int fd, const shear_input *input) {
    int fds[SHEAR_N_PARTS];
    shear_field *field = NULL;
    shear_error err = {0};
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        fds[i] = fd;
    if (shear_field_open_input(&field, input, fds, &err) == SHEAR_OK)
        read_field(field);
    shear_field_close(field);
}

/* Let the bytes themselves choose options, and more parts. */
static void choose(shear_input *input, const uint8_t *bytes, size_t size) {
    static const char *const columns[] = {NULL, "x=X_IMAGE,y=Y_IMAGE", "ra=RA,dec=DEC,a=MAG_AUTO",
                                          "x=MAG_AUTO,y=MAG_AUTO,r_gal=MAG_AUTO"};
    static const char *const selects[] = {NULL, "FLAGS >= 0", "NUMBER % 2 == 0"};
    static const int more[] = {SHEAR_PART_WEIGHT, SHEAR_PART_MASK, SHEAR_PART_SEGMENTATION,
                               SHEAR_PART_NOISE, SHEAR_PART_WCS};
    shear_exposure *e = &input->exposure;
    uint64_t state = size;
    for (size_t i = 0; i < size; i++)
        state = 31 * state + bytes[i];
    for (int i = 0; i < 5; i++) {
        if (fuzz_below(&state, 6) == 0)
            input->parts[more[i]] =
                (shear_input_part){"input.fits", NULL, (int)fuzz_below(&state, 6) - 1};
    }
    if (fuzz_below(&state, 3) == 0)
        input->parts[SHEAR_PART_IMAGE].extname = NULL;
    e->columns = columns[fuzz_below(&state, 4)];
    e->select = selects[fuzz_below(&state, 3)];
    e->origin = (int)fuzz_below(&state, 2);
    e->psf_kind = fuzz_below(&state, 2) == 0 ? (enum shear_psf_kind)fuzz_below(&state, 5)
                                             : SHEAR_PSF_KIND_AUTO;
    e->noise = (enum shear_noise_kind)fuzz_below(&state, 3);
    e->noise_stamps = e->noise == SHEAR_NOISE_IMAGE ? 1 : (int)fuzz_below(&state, 3);
    e->amplifiers = (shear_amplifiers){(int)fuzz_below(&state, 4), (int)fuzz_below(&state, 3)};
    e->frame = (int)fuzz_below(&state, 4);
    e->stamp = 8 + (int)fuzz_below(&state, 20);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static const int needed[] = {SHEAR_PART_IMAGE, SHEAR_PART_CATALOG, SHEAR_PART_PSF};
    const int fd = memfd_create("survey", MFD_CLOEXEC);
    if (fd < 0)
        return 0;
    if (write(fd, bytes, size) == (ssize_t)size) {
        shear_input input = shear_input_of_file(NULL);
        for (int i = 0; i < 3; i++)
            input.parts[needed[i]] = (shear_input_part){"input.fits", NULL, -1};
        input.parts[SHEAR_PART_IMAGE].extname = "SCI";
        input.exposure.origin = 1;
        input.exposure.stamp = 16;
        open_and_read(fd, &input);
        choose(&input, bytes, size);
        open_and_read(fd, &input);
    }
    close(fd);
    return 0;
}

#ifdef SHEAR_FUZZ
/* See source_fixture.c. */
const char *__lsan_default_suppressions(void) __attribute__((visibility("default")));
const char *__lsan_default_suppressions(void) {
    return "leak:ffiprs\n";
}
#endif
