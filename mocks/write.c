/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writing a mock field to a file, in chunks, with several threads. */
#include "base/arena.h"
#include "base/cleanup.h"
#include "shear/version.h"
#include "shear_mocks/mock.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

/* Bytes of a chunk, galaxy and noise stamps: large enough to make parallel regions efficient, small
 * enough for any machine. */
enum { CHUNK_BYTES = 16 << 20, HISTORY_LINE = 128, MAX_HISTORY = 64 };

/* One chunk of stamps and their rows of the catalog. */
typedef struct chunk {
    void *memory; /* owned; of all that follow */
    int capacity;
    double *galaxy;        /* [capacity][ny][nx] */
    double *noise;         /* [capacity][noise_stamps][ny][nx] */
    double *psf;           /* [psf_ny][psf_nx] */
    double *x, *y, *r_gal; /* [capacity], as the rest */
    int64_t *id;
    int32_t *psf_id;
} chunk;

static int chunk_capacity(const shear_mock_info *info, int noise_stamps, int threads) {
    int64_t pair_bytes = (int64_t)info->geometry.nx * info->geometry.ny * (1 + noise_stamps) *
                         (int64_t)sizeof(double);
    int64_t n = CHUNK_BYTES / pair_bytes;
    int64_t least = threads > 0 ? threads : omp_get_max_threads();
    n = n > least ? n : least;
    return (int)(n < info->n_stamps ? n : info->n_stamps);
}

static void chunk_deinit(const chunk *c) {
    free(c->memory);
}

static void place(chunk *c, const shear_mock *m, arena *a) {
    const shear_geometry *g = &shear_mock_get_info(m)->geometry;
    const size_t n = (size_t)c->capacity;
    const size_t pixels = n * (size_t)g->nx * (size_t)g->ny;
    c->galaxy = arena_doubles(a, pixels);
    c->noise = arena_doubles(a, pixels * (size_t)shear_mock_get_spec(m)->noise_stamps);
    c->psf = arena_doubles(a, (size_t)g->psf_nx * (size_t)g->psf_ny);
    c->x = arena_doubles(a, n);
    c->y = arena_doubles(a, n);
    c->r_gal = arena_doubles(a, n);
    c->id = arena_take(a, n * sizeof *c->id);
    c->psf_id = arena_take(a, n * sizeof *c->psf_id);
}

static int chunk_init(chunk *c, const shear_mock *m, int threads, shear_error *err) {
    const shear_mock_info *info = shear_mock_get_info(m);
    const int noise_stamps = shear_mock_get_spec(m)->noise_stamps;
    arena a = {0};
    *c = (chunk){.capacity = chunk_capacity(info, noise_stamps, threads)};
    place(c, m, &a);
    c->memory = arena_allocate(&a);
    if (c->memory == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d mock stamps of %dx%d px",
                          c->capacity, info->geometry.nx, info->geometry.ny);
    }
    place(c, m, &a);
    return SHEAR_OK;
}

/* ---- HISTORY ---- */
typedef struct history {
    char text[MAX_HISTORY][HISTORY_LINE];
    const char *lines[MAX_HISTORY]; /* NULL-terminated */
} history;

static void history_init(history *h, const shear_mock_spec *spec) {
    size_t n;
    const shear_mock_option *options = shear_mock_options(&n);
    *h = (history){.lines = {h->text[0]}};
    assert(n + 1 < MAX_HISTORY);
    snprintf(h->text[0], HISTORY_LINE, "shear_mocks %s, after Zhang (2010) section 4.1",
             SHEAR_VERSION_STRING);
    for (size_t i = 0; i < n; i++) {
        char value[96];
        shear_mock_format(spec, &options[i], value, sizeof value);
        snprintf(h->text[i + 1], HISTORY_LINE, "mock %s = %s", options[i].name, value);
        h->lines[i + 1] = h->text[i + 1];
    }
}

/* ---- the file ---- */
static unsigned columns_of(const shear_mock *m) {
    unsigned columns = SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_Y;
    if (shear_mock_get_spec(m)->write_r_gal)
        columns |= SHEAR_COL_R_GAL;
    if (shear_mock_get_info(m)->psf_layout == SHEAR_PSF_BY_ID)
        columns |= SHEAR_COL_PSF_ID;
    return columns;
}

static int create(shear_field_writer **w, const shear_mock *m, const char *path, bool overwrite,
                  shear_error *err) {
    const shear_mock_spec *s = shear_mock_get_spec(m);
    const shear_mock_info *info = shear_mock_get_info(m);
    history h;
    history_init(&h, s);
    shear_field_spec field = {.name = s->field[0] ? s->field : NULL,
                              .pixscale = NAN,
                              .has_truth = true,
                              .sim_g1 = s->g1,
                              .sim_g2 = s->g2,
                              .geometry = info->geometry,
                              .n_stamps = info->n_stamps,
                              .n_psf = info->n_psf,
                              .noise_planes = s->noise_stamps,
                              .layout = s->layout,
                              .columns = columns_of(m),
                              .bitpix = s->bitpix,
                              .overwrite = overwrite,
                              .history = h.lines};
    return shear_field_create(w, path, &field, err);
}

static int write_psfs(shear_field_writer *w, const shear_mock *m, double *image, shear_error *err) {
    for (int64_t i = 0; i < shear_mock_get_info(m)->n_psf; i++) {
        shear_mock_psf_image(m, i, image);
        TRY(shear_field_write_psf(w, i, image, err));
    }
    return SHEAR_OK;
}

static int write_chunk(shear_field_writer *w, const shear_mock *m, chunk *c, int64_t first,
                       int count, int threads, shear_error *err) {
    unsigned columns = columns_of(m);
    TRY(shear_mock_stamps(m, first, count, threads, c->galaxy, c->noise, err));
    for (int i = 0; i < count; i++) {
        c->id[i] = first + i;
        shear_mock_centre(m, first + i, &c->x[i], &c->y[i]);
        c->r_gal[i] = shear_mock_get_spec(m)->r_gal_px;
        c->psf_id[i] = (int32_t)shear_mock_psf_of(m, first + i);
    }
    shear_catalog_columns rows = {.id = c->id,
                                  .x = c->x,
                                  .y = c->y,
                                  .r_gal = columns & SHEAR_COL_R_GAL ? c->r_gal : NULL,
                                  .psf_id = columns & SHEAR_COL_PSF_ID ? c->psf_id : NULL};
    return shear_field_write(w, first, count, c->galaxy, c->noise, &rows, err);
}

static int write_stamps(shear_field_writer *w, const shear_mock *m, chunk *c,
                        const shear_mock_write_options *o, shear_error *err) {
    int64_t n = shear_mock_get_info(m)->n_stamps;
    for (int64_t first = 0; first < n; first += c->capacity) {
        int count = (int)(n - first < c->capacity ? n - first : c->capacity);
        TRY(write_chunk(w, m, c, first, count, o->threads, err));
        if (o->progress != NULL && o->progress(o->context, first + count, n) != 0) {
            return shear_fail(err, SHEAR_E_CANCELLED, NULL,
                              "stopped after %lld of %lld mock stamps", (long long)first + count,
                              (long long)n);
        }
    }
    return SHEAR_OK;
}

CLEANUP_DEFINE(shear_field_writer, shear_field_abort)

int shear_mock_write(const shear_mock *m, const char *path, const shear_mock_write_options *options,
                     shear_error *err) {
    static const shear_mock_write_options defaults = {0};
    const shear_mock_write_options *o = options != NULL ? options : &defaults;
    CLEANUP(shear_field_writer_release) shear_field_writer *w = NULL;
    CLEANUP(chunk_deinit) chunk c = {0};
    TRY(chunk_init(&c, m, o->threads, err));
    TRY(create(&w, m, path, o->overwrite, err));
    TRY(write_psfs(w, m, c.psf, err));
    TRY(write_stamps(w, m, &c, o, err));
    return shear_field_finish(CLEANUP_TAKE(w), err);
}
