/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear-plain FILE: a lower bound for the time of a whole file, for bench/files: read all pixels of
 * GALAXY and NOISE by CFITSIO as double, a block of stamps at a time, and do two plain FFTW
 * transforms per pair. */
#include "floor.h"

#include <fitsio.h>
#include <stdio.h>
#include <stdlib.h>

enum { BLOCK = 16 };

typedef struct cube {
    fitsfile *file;
    long side[3];
} cube;

static void must(int status) {
    if (status != 0) {
        fits_report_error(stderr, status);
        exit(1);
    }
}

static cube cube_open(const char *path, const char *name) {
    cube c = {0};
    int status = 0;
    char extension[9];
    snprintf(extension, sizeof extension, "%s", name);
    fits_open_diskfile(&c.file, path, READONLY, &status);
    fits_movnam_hdu(c.file, IMAGE_HDU, extension, 0, &status);
    fits_get_img_size(c.file, 3, c.side, &status);
    must(status);
    return c;
}

static void cube_read(const cube *c, long first, long count, double *out) {
    int status = 0;
    int any = 0;
    double null = 0.0;
    long at[3] = {1, 1, first + 1};
    fits_read_pix(c->file, TDOUBLE, at, c->side[0] * c->side[1] * count, &null, out, &any, &status);
    must(status);
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: shear-plain FILE\n");
        return 2;
    }
    const cube galaxy = cube_open(argv[1], "GALAXY");
    const cube noise = cube_open(argv[1], "NOISE");
    const size_t pixels = (size_t)(galaxy.side[0] * galaxy.side[1]);
    double *block = aligned_alloc(64, 2 * BLOCK * pixels * sizeof *block);
    floor_transform *f = floor_new((int)galaxy.side[0], (int)galaxy.side[1]);
    if (block == NULL || f == NULL) {
        fprintf(stderr, "shear-plain: out of memory\n");
        return 1;
    }
    for (long first = 0; first < galaxy.side[2]; first += BLOCK) {
        const long left = galaxy.side[2] - first;
        const long count = left < BLOCK ? left : BLOCK;
        cube_read(&galaxy, first, count, block);
        cube_read(&noise, first, count, block + BLOCK * pixels);
        for (long i = 0; i < count; i++)
            floor_run_on(f, block + (size_t)i * pixels, block + (size_t)(BLOCK + i) * pixels);
    }
    free(block);
    floor_free(f);
    return 0;
}
