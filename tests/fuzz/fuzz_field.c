/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as a field file: opening and reading it must neither crash nor leak, whatever they are.
 *
 * With SHEAR_FUZZ this is a libFuzzer target; else standalone.c calls it for given files and for
 * mutants of good ones. */
#include "fuzz_field.h"

#include "cards.h"

#include "shear/field.h"

#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* Small files may honestly describe large images where they are compressed; those would only slow
 * the search down. */
enum { MAX_BLOCK_BYTES = 64 << 20 };

static void read_stamps(shear_field *field, const shear_field_info *info) {
    enum { CAPACITY = 3 };
    shear_block *block = NULL;
    if (shear_block_bytes(info, CAPACITY) > MAX_BLOCK_BYTES ||
        shear_block_new(&block, info, CAPACITY, NULL) != SHEAR_OK) {
        return;
    }
    const int64_t n = info->n_stamps;
    const int64_t places[] = {0, n / 2, n - CAPACITY};
    for (int i = 0; i < 3; i++) {
        const int64_t first = places[i] > 0 ? places[i] : 0;
        const int count = n - first < CAPACITY ? (int)(n - first) : CAPACITY;
        shear_error err = {0};
        (void)shear_field_read(field, first, count, block, &err);
    }
    shear_block_free(block);
}

static void read_psf(shear_field *field, const shear_field_info *info) {
    double *psf = malloc(shear_psf_bytes(info));
    if (psf != NULL) {
        (void)shear_field_read_psf(field, 0, psf, NULL);
        (void)shear_field_read_psf(field, info->n_psf - 1, psf, NULL);
    }
    free(psf);
}

static void read_all(shear_field *field) {
    const shear_field_info *info = shear_field_get_info(field);
    read_stamps(field, info);
    read_psf(field, info);
}

/* The same bytes as a field in parts, with HDUs that the bytes themselves choose. */
static void read_parts(int fd, const uint8_t *bytes, size_t size) {
    shear_field *field = NULL;
    shear_error err = {0};
    shear_input input = shear_input_of_file(NULL);
    const int fds[SHEAR_N_PARTS] = {fd, fd, fd, fd};
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        const int chosen = size > 0 ? bytes[(size - 1) / (size_t)(i + 1)] % 8 : 0;
        input.parts[i].path = i < SHEAR_PART_CATALOG || chosen < 4 ? "input.fits" : NULL;
        input.parts[i].hdu = chosen < 6 ? chosen : -1;
    }
    if (shear_field_open_input(&field, &input, fds, &err) == SHEAR_OK)
        read_all(field);
    shear_field_close(field);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const int fd = memfd_create("field", MFD_CLOEXEC);
    if (fd < 0)
        return 0;
    shear_field *field = NULL;
    shear_error err = {0};
    const bool written = write(fd, bytes, size) == (ssize_t)size;
    if (written && shear_field_open_fd(&field, fd, "input.fits", &err) == SHEAR_OK)
        read_all(field);
    shear_field_close(field);
    if (written)
        read_parts(fd, bytes, size);
    close(fd);
    return 0;
}
