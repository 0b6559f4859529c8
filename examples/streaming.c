/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure stamps block by block, as they arrive from a camera or a pipeline: create the plan once,
 * measure each block, and add its rows to the sums. Here the blocks are read from a field file. */
#include <shear.h>
#include <stdio.h>
#include <stdlib.h>

enum { STAMPS = 4 * SHEAR_BLOCK }; /* at a time: whole blocks of the sums */

typedef struct stream {
    shear_field *field;
    shear_plan *plan;
    shear_block *block;
    shear_field_sums *sums;
} stream;

static bool open_stream(stream *s, const char *path, shear_error *err) {
    shear_settings settings;
    shear_settings_init(&settings);
    return shear_field_open(&s->field, path, err) == SHEAR_OK &&
           shear_plan_for_field(&s->plan, &settings, s->field, err) == SHEAR_OK &&
           shear_block_new(&s->block, shear_field_get_info(s->field), STAMPS, err) == SHEAR_OK &&
           shear_field_sums_new(&s->sums, err) == SHEAR_OK;
}

static void close_stream(stream *s) {
    shear_field_sums_free(s->sums);
    shear_block_free(s->block);
    shear_plan_free(s->plan);
    shear_field_close(s->field);
}

/* Add rows in blocks of SHEAR_BLOCK stamps in the order of the stamps. The result is the same to
 * the last bit for any number of stamps at a time. */
static void add_rows(shear_field_sums *sums, const shear_row *rows, int count) {
    for (int i = 0; i < count; i += SHEAR_BLOCK) {
        shear_block_sums block;
        shear_block_sums_init(&block);
        for (int k = i; k < count && k < i + SHEAR_BLOCK; k++)
            shear_block_sums_add(&block, &rows[k]);
        shear_field_sums_add(sums, &block);
    }
}

static bool measure(stream *s, int64_t first, int count, shear_error *err) {
    shear_row rows[STAMPS];
    if (shear_field_read(s->field, first, count, s->block, err) != SHEAR_OK ||
        shear_measure_batch(s->plan, &s->block->stamps, 0, NULL, rows, err) != SHEAR_OK) {
        return false;
    }
    add_rows(s->sums, rows, count);
    return true;
}

static bool run(stream *s, const char *path, shear_result *result, shear_error *err) {
    if (!open_stream(s, path, err))
        return false;
    const int64_t n = shear_field_get_info(s->field)->n_stamps;
    for (int64_t first = 0; first < n; first += STAMPS) {
        if (!measure(s, first, n - first < STAMPS ? (int)(n - first) : STAMPS, err))
            return false;
    }
    shear_field_result(s->sums, result);
    return true;
}

int main(int argc, char **argv) {
    stream s = {0};
    shear_result result;
    shear_error err;
    if (argc != 2) {
        fprintf(stderr, "usage: streaming FIELD.fits\n");
        return EXIT_FAILURE;
    }
    const bool done = run(&s, argv[1], &result, &err);
    close_stream(&s);
    if (!done) {
        fprintf(stderr, "%s (%s)\n", err.message, err.advice);
        return EXIT_FAILURE;
    }
    printf("g1 = %+.17g +- %.2g\n", result.g1, result.g1_err);
    printf("g2 = %+.17g +- %.2g\n", result.g2, result.g2_err);
    return EXIT_SUCCESS;
}
