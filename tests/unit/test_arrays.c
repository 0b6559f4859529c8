/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear_measure_arrays: the same to the last bit as a field file of the same numbers, measured by
 * the library and by shearctl (SHEARCTL), whatever the arrays' type and layout. */
#include "batch.h"
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/arrays.h"
#include "shear/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { N = 200, PLANES = 3, FEW = 7 };
static const shear_geometry geometry = {
    .nx = 34, .ny = 32, .psf_nx = 17, .psf_ny = 15, .psf_oversample = 1};

/* How the same numbers lie in memory. */
typedef struct layout {
    enum shear_pixel_type type;
    ptrdiff_t
        gap; /* pixels between rows and between images; < 0: rows from the last to the first */
} layout;

/* A field: its numbers, and how they are measured. */
typedef struct field_case {
    const char *settings[4][2];
    enum shear_psf_layout psfs;
    int planes;
    bool columns; /* weight, r_gal, mask */
} field_case;

static const field_case cases[] = {
    {.planes = 1},
    {.planes = PLANES, .columns = true, .settings = {{"estimator", "pdf-sym"}}},
    {.planes = 1, .psfs = SHEAR_PSF_PER_STAMP, .settings = {{"filter", "none"}}},
    {.planes = 1,
     .psfs = SHEAR_PSF_BY_ID,
     .columns = true,
     .settings = {{"interpolation", "spline"}, {"oversample", "2"}}},
    {.planes = 2, .psfs = SHEAR_PSF_BY_ID, .settings = {{"estimator", "pdf-sym-cross"}}},
};
static const layout layouts[] = {
    {SHEAR_PIXEL_DOUBLE, 0}, {SHEAR_PIXEL_DOUBLE, 5},  {SHEAR_PIXEL_DOUBLE, -1},
    {SHEAR_PIXEL_FLOAT, 0},  {SHEAR_PIXEL_FLOAT, 3},   {SHEAR_PIXEL_INT32, 0},
    {SHEAR_PIXEL_INT16, 1},  {SHEAR_PIXEL_UINT16, -2}, {SHEAR_PIXEL_UINT8, 0}};
enum { N_CASES = sizeof cases / sizeof cases[0], N_LAYOUTS = sizeof layouts / sizeof layouts[0] };

/* Integers that every type holds. */
static void round_all(double *pixels, size_t n, double scale) {
    for (size_t i = 0; i < n; i++)
        pixels[i] = floor(scale * pixels[i]);
}

/* Round noise beneath an elliptical galaxy of a random direction, sheared a little. */
static void draw_pair(double *galaxy, double *noise, uint64_t *seed) {
    const double angle = 6.283185307179586 * uniform(seed);
    const double size = 6.0 + 4.0 * uniform(seed);
    const double e = 0.3 * uniform(seed);
    const gaussian g = {.amplitude = 80.0 + 90.0 * uniform(seed),
                        .xx = size * (1.02 + e * cos(angle)),
                        .yy = size * (1.0 - e * cos(angle)),
                        .xy = size * e * sin(angle),
                        .x0 = 0.5 * geometry.nx - 1.0 + uniform(seed),
                        .y0 = 0.5 * geometry.ny - 1.0 + uniform(seed)};
    gaussian_draw(&g, geometry.nx, geometry.ny, 1, galaxy);
    for (int i = 0; i < geometry.nx * geometry.ny; i++) {
        galaxy[i] += 4.0 * uniform(seed);
        noise[i] = 4.0 * uniform(seed);
    }
}

/* The numbers of all fields, as doubles without gaps. */
typedef struct numbers {
    batch b;
    double *noise; /* [N][PLANES][ny][nx] */
    int32_t psf_id[N];
} numbers;

static numbers all;

static int setup(void **state) {
    (void)state;
    const size_t pixels = (size_t)geometry.nx * (size_t)geometry.ny;
    batch_init(&all.b, N, &geometry, 1.6, 7);
    const size_t samples = (size_t)geometry.psf_nx * (size_t)geometry.psf_ny;
    uint64_t seed = 3;
    for (size_t i = 0; i < N; i++) {
        const double r = 1.5 + 0.1 * uniform(&seed);
        const gaussian psf = {1.0, r * r, r * r, 0.0, 8.0, 7.0};
        gaussian_draw(&psf, geometry.psf_nx, geometry.psf_ny, 1, all.b.psf + i * samples);
        draw_pair(all.b.galaxy + i * pixels, all.b.noise + i * pixels, &seed);
    }
    round_all(all.b.galaxy, N * pixels, 1.0);
    round_all(all.b.noise, N * pixels, 1.0);
    round_all(all.b.psf, N * samples, 250.0);
    all.noise = calloc(N * PLANES * pixels, sizeof *all.noise);
    assert_non_null(all.noise);
    for (size_t i = 0; i < N * PLANES; i++)
        memcpy(all.noise + i * pixels, all.b.noise + i * 5 % N * pixels, pixels * sizeof(double));
    for (int i = 0; i < N; i++) {
        all.psf_id[i] = i % 11 == 3 ? -1 : i / 4 % FEW;
        all.b.mask[i] = i % 13 == 5;
    }
    return 0;
}

static int teardown(void **state) {
    (void)state;
    batch_deinit(&all.b);
    free(all.noise);
    return 0;
}

static void settings_of(const field_case *c, shear_settings *settings) {
    shear_settings_init(settings);
    for (int i = 0; i < 4 && c->settings[i][0] != NULL; i++) {
        assert_int_equal(shear_settings_set(settings, c->settings[i][0], c->settings[i][1], NULL),
                         SHEAR_OK);
    }
}

static int psfs_of(const field_case *c) {
    return c->psfs == SHEAR_PSF_ONE ? 1 : c->psfs == SHEAR_PSF_BY_ID ? FEW : N;
}

/* ---- the field file ---- */

static void write_file(const char *path, const field_case *c) {
    const unsigned columns =
        (c->columns ? SHEAR_COL_WEIGHT | SHEAR_COL_R_GAL | SHEAR_COL_FLAGS : 0u) |
        (c->psfs == SHEAR_PSF_BY_ID ? SHEAR_COL_PSF_ID : 0u);
    const shear_field_spec spec = {.name = "arrays",
                                   .pixscale = NAN,
                                   .geometry = geometry,
                                   .n_stamps = N,
                                   .n_psf = psfs_of(c),
                                   .noise_planes = c->planes,
                                   .columns = columns,
                                   .bitpix = -64,
                                   .overwrite = true};
    const shear_catalog_columns rows = {.weight = c->columns ? all.b.weight : NULL,
                                        .r_gal = c->columns ? all.b.r_gal : NULL,
                                        .flags = c->columns ? all.b.mask : NULL,
                                        .psf_id = c->psfs == SHEAR_PSF_BY_ID ? all.psf_id : NULL};
    const size_t samples = (size_t)geometry.psf_nx * (size_t)geometry.psf_ny;
    shear_field_writer *w = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_create(&w, path, &spec, &err), SHEAR_OK);
    assert_int_equal(shear_field_write(w, 0, N, all.b.galaxy, all.noise, &rows, &err), SHEAR_OK);
    for (int i = 0; i < spec.n_psf; i++) {
        assert_int_equal(shear_field_write_psf(w, i, all.b.psf + (size_t)i * samples, &err),
                         SHEAR_OK);
    }
    assert_int_equal(shear_field_finish(w, &err), SHEAR_OK);
}

/* ---- the arrays ---- */

static void put(void *at, enum shear_pixel_type type, double value) {
    switch (type) {
    case SHEAR_PIXEL_DOUBLE:
        *(double *)at = value;
        break;
    case SHEAR_PIXEL_FLOAT:
        *(float *)at = (float)value;
        break;
    case SHEAR_PIXEL_INT32:
        *(int32_t *)at = (int32_t)value;
        break;
    case SHEAR_PIXEL_INT16:
        *(int16_t *)at = (int16_t)value;
        break;
    case SHEAR_PIXEL_UINT16:
        *(uint16_t *)at = (uint16_t)value;
        break;
    case SHEAR_PIXEL_UINT8:
        *(uint8_t *)at = (uint8_t)value;
        break;
    }
}

/* [n][planes][ny][nx] in another layout; *memory is to be freed. */
static shear_images lay_out(const double *in, int n, int planes, int nx, int ny, const layout *l,
                            void **memory) {
    static const ptrdiff_t sizes[] = {8, 4, 4, 2, 2, 1};
    const ptrdiff_t size = sizes[l->type];
    const ptrdiff_t gap = l->gap < 0 ? -l->gap : l->gap;
    shear_images m = {.type = l->type, .column = size, .row = (nx + gap) * size};
    m.plane = (ny + gap) * m.row;
    m.image = planes * m.plane + gap * size;
    char *bytes = malloc((size_t)(n * m.image));
    assert_non_null(bytes);
    memset(bytes, 0x7f, (size_t)(n * m.image));
    *memory = bytes;
    if (l->gap < 0) {
        bytes += (ny - 1) * m.row;
        m.row = -m.row;
    }
    m.pixels = bytes;
    for (int i = 0; i < n * planes; i++) {
        for (int y = 0; y < ny; y++) {
            for (int x = 0; x < nx; x++) {
                put(bytes + i / planes * m.image + i % planes * m.plane + y * m.row + x * m.column,
                    l->type, *in++);
            }
        }
    }
    if (l->gap == 0) { /* all strides may be left out then */
        m = (shear_images){.pixels = bytes, .type = l->type};
    }
    return m;
}

/* The planes that a field uses lie behind each other. */
static double *planes_of(const field_case *c) {
    const size_t stamp = (size_t)c->planes * (size_t)geometry.nx * (size_t)geometry.ny;
    double *noise = malloc(N * stamp * sizeof *noise);
    assert_non_null(noise);
    memcpy(noise, all.noise, N * stamp * sizeof *noise);
    return noise;
}

static int measure(const field_case *c, const layout *l, const shear_arrays_options *options,
                   shear_result *result, shear_error *err) {
    shear_settings settings;
    void *memory[3];
    double *noise = planes_of(c);
    settings_of(c, &settings);
    const shear_arrays arrays = {
        .n_stamps = N,
        .geometry = geometry,
        .noise_planes = c->planes,
        .n_psf = psfs_of(c),
        .galaxy = lay_out(all.b.galaxy, N, 1, geometry.nx, geometry.ny, l, &memory[0]),
        .noise = lay_out(noise, N, c->planes, geometry.nx, geometry.ny, l, &memory[1]),
        .psf = lay_out(all.b.psf, psfs_of(c), 1, geometry.psf_nx, geometry.psf_ny, l, &memory[2]),
        .psf_index = c->psfs == SHEAR_PSF_BY_ID ? all.psf_id : NULL,
        .weight = c->columns ? all.b.weight : NULL,
        .r_gal = c->columns ? all.b.r_gal : NULL,
        .mask = c->columns ? all.b.mask : NULL};
    const int code = shear_measure_arrays(result, &arrays, &settings, options, err);
    for (int i = 0; i < 3; i++)
        free(memory[i]);
    free(noise);
    return code;
}

/* ---- the comparison ---- */

static bool same(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static void expect_same(const shear_result *a, const shear_result *b) {
    const double *x = &a->sum_weight;
    const double *y = &b->sum_weight;
    assert_true(same(a->g1, b->g1) && same(a->g2, b->g2));
    assert_true(same(a->g1_err, b->g1_err) && same(a->g2_err, b->g2_err));
    assert_true(same(a->cov12, b->cov12) && same(a->delta_g1_err, b->delta_g1_err));
    assert_int_equal(a->valid, b->valid);
    assert_int_equal(a->why, b->why);
    assert_int_equal(a->jackknife, b->jackknife);
    assert_int_equal(a->n_stamps, b->n_stamps);
    assert_int_equal(a->n_used, b->n_used);
    assert_int_equal(a->top_stamp, b->top_stamp);
    assert_memory_equal(a->flagged, b->flagged, sizeof a->flagged);
    for (size_t i = 0; i < 3; i++) { /* sum_weight, sum_d, signal */
        assert_true(same(x[i], y[i]));
    }
    assert_true(same(a->noise_level, b->noise_level) && same(a->noise_share, b->noise_share));
    assert_true(same(a->n_eff, b->n_eff) && same(a->mean_flux, b->mean_flux));
}

static void expect_same_row(const shear_row *a, const shear_row *b, int64_t i) {
    assert_int_equal(a->stamp, i);
    assert_int_equal(a->flags, b->flags);
    assert_true(same(a->n1, b->n1) && same(a->n2, b->n2) && same(a->d, b->d));
    assert_true(same(a->u, b->u) && same(a->v, b->v) && same(a->m4, b->m4));
    assert_true(same(a->m20, b->m20) && same(a->m02, b->m02) && same(a->m11, b->m11));
    assert_true(same(a->flux, b->flux) && same(a->weight, b->weight));
}

static void check_layouts(const field_case *c, const shear_result *wanted,
                          const shear_catalog_table *rows_wanted) {
    static shear_row rows[N];
    for (int k = 0; k < N_LAYOUTS; k++) {
        shear_result result;
        shear_error err = {0};
        memset(rows, 0, sizeof rows);
        const shear_arrays_options options = {.threads = 1 + k % 3, .rows = rows};
        if (measure(c, &layouts[k], &options, &result, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
        expect_same(&result, wanted);
        for (int64_t i = 0; i < N; i++)
            expect_same_row(&rows[i], &rows_wanted->rows[i], i);
    }
}

static double number_after(const char *text, const char *key) {
    const char *at = strstr(text, key);
    assert_non_null(at);
    return strtod(at + strlen(key), NULL);
}

/* What `shearctl measure` says of the file. */
static void check_program(const field_case *c, const char *path, const shear_result *result) {
    const char *program = getenv("SHEARCTL");
    char command[1024];
    static char text[65536];
    if (program == NULL)
        return;
    int n = snprintf(command, sizeof command, "%s measure --json --quiet", program);
    for (int i = 0; i < 4 && c->settings[i][0] != NULL; i++) {
        n += snprintf(command + n, sizeof command - (size_t)n, " --%s %s", c->settings[i][0],
                      c->settings[i][1]);
    }
    snprintf(command + n, sizeof command - (size_t)n, " %s", path);
    FILE *out = popen(command, "r");
    assert_non_null(out);
    text[fread(text, 1, sizeof text - 1, out)] = '\0';
    assert_int_equal(pclose(out), 0);
    assert_true(same(number_after(text, "\"g1\":"), result->g1));
    assert_true(same(number_after(text, "\"g2\":"), result->g2));
    assert_true(same(number_after(text, "\"g1_err\":"), result->g1_err));
    assert_true(same(number_after(text, "\"g2_err\":"), result->g2_err));
}

static void test_as_the_file(void **state) {
    (void)state;
    for (int k = 0; k < N_CASES; k++) {
        char path[] = "arrays-XXXXXX";
        char catalog[64];
        shear_settings settings;
        shear_run_report report;
        shear_field_sums *sums = NULL;
        shear_catalog_table *rows = NULL;
        shear_error err = {0};
        close(mkstemp(path));
        snprintf(catalog, sizeof catalog, "%s.shear.fits", path);
        write_file(path, &cases[k]);
        settings_of(&cases[k], &settings);
        assert_int_equal(shear_field_sums_new(&sums, &err), SHEAR_OK);
        const shear_run_options options = {.catalog_path = catalog};
        if (shear_run_file(path, &settings, &options, sums, NULL, &report, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
        assert_true(report.result.valid);
        assert_int_equal(shear_catalog_read(&rows, catalog, &err), SHEAR_OK);
        check_layouts(&cases[k], &report.result, rows);
        check_program(&cases[k], path, &report.result);
        shear_catalog_table_free(rows);
        shear_field_sums_free(sums);
        unlink(path);
        unlink(catalog);
    }
}

/* ---- what else may be asked for ---- */

static void test_sums_and_jackknife(void **state) {
    (void)state;
    shear_result once, twice, joined;
    shear_plan_info plan = {0};
    shear_field_sums *sums = NULL;
    assert_int_equal(shear_field_sums_new(&sums, NULL), SHEAR_OK);
    shear_arrays_options options = {.sums = sums, .plan = &plan};
    assert_int_equal(measure(&cases[0], &layouts[0], &options, &once, NULL), SHEAR_OK);
    assert_true(plan.beta_px > 0.0);
    shear_field_result(sums, &joined);
    expect_same(&joined, &once);
    options.jackknife = 5;
    assert_int_equal(measure(&cases[0], &layouts[3], &options, &twice, NULL), SHEAR_OK);
    assert_int_equal(twice.jackknife, 5);
    assert_true(twice.g1 == once.g1 && twice.g1_err != once.g1_err);
    assert_true(twice.delta_g1_err == once.g1_err);
    shear_field_result(sums, &joined);
    assert_int_equal(joined.n_stamps, 2 * N);
    options.jackknife = 1000; /* more than there are blocks */
    assert_int_equal(measure(&cases[0], &layouts[0], &options, &twice, NULL), SHEAR_E_SETTING);
    shear_field_result(sums, &joined);
    assert_int_equal(joined.n_stamps, 2 * N);
    shear_field_sums_free(sums);
}

static int stop_at_once(void *context, int64_t done, int64_t total) {
    *(int64_t *)context = total;
    return done > 0;
}

static void test_stopped(void **state) {
    (void)state;
    int64_t total = 0;
    shear_result result;
    const shear_arrays_options options = {
        .threads = 1, .progress = stop_at_once, .context = &total};
    assert_int_equal(measure(&cases[0], &layouts[0], &options, &result, NULL), SHEAR_E_CANCELLED);
    assert_int_equal(total, N);
}

/* One thing is wrong, each time another. */
static void spoil(shear_arrays *a, int how) {
    int *const sides[] = {&a->geometry.nx, &a->geometry.ny, &a->geometry.psf_nx,
                          &a->geometry.psf_ny};
    if (how < 8) {
        *sides[how / 2] = how % 2 == 0 ? 2 : 5000;
        return;
    }
    shear_images *const images[] = {&a->galaxy, &a->noise, &a->psf};
    switch (how) {
    case 8:
    case 9:
    case 10:
        images[how - 8]->pixels = NULL;
        break;
    case 11:
        a->n_stamps = 0;
        break;
    case 12:
        a->n_psf = 2; /* and nothing says whose is which */
        break;
    case 13:
        a->noise_planes = SHEAR_MAX_NOISE_PLANES + 1;
        break;
    case 14:
        a->geometry.psf_oversample = 0;
        break;
    case 15:
        a->n_psf = -1;
        break;
    default:
        memset(&a->noise.type, 0x55, sizeof a->noise.type);
        break;
    }
}

static void test_refused(void **state) {
    (void)state;
    const shear_arrays good = {.n_stamps = N,
                               .geometry = geometry,
                               .galaxy = {.pixels = all.b.galaxy},
                               .noise = {.pixels = all.b.noise},
                               .psf = {.pixels = all.b.psf}};
    shear_result result = {.n_stamps = -5};
    for (int how = 0; how <= 16; how++) {
        shear_arrays bad = good;
        shear_error err = {0};
        spoil(&bad, how);
        assert_int_equal(shear_measure_arrays(&result, &bad, NULL, NULL, &err), SHEAR_E_FORMAT);
        assert_int_equal(err.code, SHEAR_E_FORMAT);
        assert_true(strlen(err.message) > 10);
        assert_int_equal(result.n_stamps, -5);
    }
    assert_int_equal(shear_measure_arrays(&result, &good, NULL, NULL, NULL), SHEAR_OK);
    assert_int_equal(result.n_stamps, N);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_the_file),
        cmocka_unit_test(test_sums_and_jackknife),
        cmocka_unit_test(test_stopped),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
