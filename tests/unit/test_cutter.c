/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stamp pairs cut out of a chip: planes, masks, fills, flags. */
#include "chip_fixture.h"
#include "test.h"

#include "shear/stamp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 400, STAMP = 32, N = STAMP * STAMP };
static const double R_GAL = 4.0; /* with R_PSF 1.5: light within 7.9 px */

static void test_a_plane_is_subtracted(void **state) {
    (void)state;
    chip_pixels *flat = chip_new(SIDE, SIDE, 2.0, 1);
    chip_pixels *tilted = chip_new(SIDE, SIDE, 2.0, 1);
    for (int i = 0; i < SIDE * SIDE; i++)
        tilted->value[i] += 100.0 + 0.01 * (i % SIDE) - 0.02 * (double)(i / SIDE);
    const cutter_options options = chip_options(flat);
    cut_fixture a;
    cut_fixture b;
    cut_init(&a, flat, NULL, &options);
    cut_init(&b, tilted, NULL, &options);
    for (int i = 0; i < 20; i++) {
        assert_int_equal(cut_at(&a, 60.3 + 10 * i, 200.0, R_GAL, i), 0);
        assert_int_equal(cut_at(&b, 60.3 + 10 * i, 200.0, R_GAL, i), 0);
        assert_int_equal(a.pair.noise_x[0], b.pair.noise_x[0]);
        for (int k = 0; k < N; k++) {
            assert_true(fabs(a.pair.galaxy[k] - b.pair.galaxy[k]) < 1e-9);
            assert_true(fabs(a.pair.noise[k] - b.pair.noise[k]) < 1e-9);
        }
        assert_true(fabs(b.pair.sigma - 2.0) < 0.1);
    }
    cut_deinit(&a);
    cut_deinit(&b);
    chip_free(flat);
    chip_free(tilted);
}

static void test_the_nearest_pixel_is_in_the_middle(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 2);
    cutter_options options = chip_options(c);
    for (options.stamp = 32; options.stamp <= 33; options.stamp++) {
        cut_fixture f;
        cut_init(&f, c, NULL, &options);
        const double offsets[] = {-0.5, 0.0, 0.49};
        for (int i = 0; i < 3; i++) {
            assert_int_equal(cut_at(&f, 100 + offsets[i], 150 + offsets[i], R_GAL, 1), 0);
            assert_int_equal(f.pair.x, 100 - options.stamp / 2);
            assert_int_equal(f.pair.y, 150 - options.stamp / 2);
        }
        cut_deinit(&f);
    }
    chip_free(c);
}

/* What is masked in either stamp is replaced in both, and nothing else. */
static void test_the_union_is_filled_in_both(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 2.0, 3);
    const cutter_options options = chip_options(c);
    cut_fixture plain;
    cut_init(&plain, c, NULL, &options);
    assert_int_equal(cut_at(&plain, 200, 200, R_GAL, 5), 0);
    assert_true(plain.pair.filled == 0.0);
    const int dx = plain.pair.noise_x[0] - plain.pair.x;
    const int dy = plain.pair.noise_y[0] - plain.pair.y;
    chip_damage(c, 185, 190, 1, 3, PIXEL_BAD);           /* the galaxy's */
    chip_damage(c, 214 + dx, 200 + dy, 2, 2, PIXEL_BAD); /* its noise stamp's */
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 200, 200, R_GAL, 5), 0);
    assert_int_equal(f.pair.noise_x[0], plain.pair.noise_x[0]);
    int changed = 0;
    for (int i = 0; i < N; i++) {
        const int x = i % STAMP + f.pair.x;
        const int y = i / STAMP + f.pair.y;
        const bool masked =
            (x == 185 && y >= 190 && y < 193) || (x >= 214 && x < 216 && y >= 200 && y < 202);
        changed += masked;
        assert_int_equal(fabs(f.pair.galaxy[i] - plain.pair.galaxy[i]) > 1e-9, masked);
        assert_int_equal(fabs(f.pair.noise[i] - plain.pair.noise[i]) > 1e-9, masked);
        assert_true(fabs(f.pair.galaxy[i]) < 15.0 && fabs(f.pair.noise[i]) < 15.0);
    }
    assert_int_equal(changed, 7);
    assert_true(f.pair.filled == 7.0 / N);
    cut_deinit(&plain);
    cut_deinit(&f);
    chip_free(c);
}

/* ---- flags ---- */

/* A chip with a galaxy at its middle, whose owner is 1, and what may be wrong with it. */
typedef struct fault {
    double r_psf, r_gal, isophote; /* the isophote's radius; 0: none */
    int distance;                  /* of one pixel, along x ... */
    unsigned defect;               /* ... that is a defect ... */
    int32_t owner;                 /* ... or belongs to an object */
    uint32_t flags;
} fault;

static const fault faults[] = {
    /* R = 4 + 2.6 * 1.5 = 7.9 */
    {1.5, 4.0, 0.0, 7, PIXEL_BAD, 0, SHEAR_FLAG_HOLE},
    {1.5, 4.0, 0.0, 8, PIXEL_BAD, 0, 0},
    {1.5, 4.0, 0.0, 7, PIXEL_SATURATED, 0, SHEAR_FLAG_SATURATED},
    {1.5, 4.0, 0.0, 8, PIXEL_SATURATED, 0, 0},
    {1.5, 4.0, 0.0, 7, PIXEL_SATURATED | PIXEL_BAD, 0, SHEAR_FLAG_SATURATED},
    /* its isophote reaches farther */
    {1.5, 4.0, 10.0, 10, PIXEL_BAD, 0, SHEAR_FLAG_HOLE},
    {1.5, 4.0, 10.0, 11, PIXEL_BAD, 0, 0},
    /* others: within R + 3 = 10.9, or R + 2 R_PSF, or within 3 px of the isophote */
    {1.5, 4.0, 0.0, 10, 0, 2, SHEAR_FLAG_NEIGHBOUR},
    {1.5, 4.0, 0.0, 11, 0, 2, 0},
    {3.0, 4.0, 0.0, 17, 0, 2, SHEAR_FLAG_NEIGHBOUR},
    {3.0, 4.0, 0.0, 18, 0, 2, 0},
    {1.5, 4.0, 10.0, 13, 0, 2, SHEAR_FLAG_NEIGHBOUR},
    {1.5, 4.0, 10.0, 14, 0, 2, 0},
    {1.5, 4.0, 10.0, 12, 0, 1, 0}, /* a pixel of its own */
    /* an unknown radius: the isophote, or 2.6 R_PSF = 3.9 */
    {1.5, NAN, 5.0, 5, PIXEL_BAD, 0, SHEAR_FLAG_HOLE},
    {1.5, NAN, 5.0, 6, PIXEL_BAD, 0, 0},
    {1.5, NAN, 0.0, 3, PIXEL_BAD, 0, SHEAR_FLAG_HOLE},
    {1.5, NAN, 0.0, 4, PIXEL_BAD, 0, 0},
    {1.5, -1.0, 0.0, 4, PIXEL_BAD, 0, 0},
    {NAN, 4.0, 0.0, 4, PIXEL_BAD, 0, SHEAR_FLAG_HOLE},
    {NAN, 4.0, 0.0, 5, PIXEL_BAD, 0, 0},
    /* all of the stamp is light, not all of the frame */
    {1.5, 1e300, 0.0, 15, PIXEL_BAD, 0, SHEAR_FLAG_HOLE},
    {1.5, INFINITY, 0.0, 16, PIXEL_BAD, 0, 0},
};

static void test_what_is_in_the_light(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        const fault *t = &faults[i];
        chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 4);
        if (t->isophote > 0.0)
            chip_own(c, 200, 200, t->isophote, 1);
        if (t->owner != 0)
            chip_own(c, 200 + t->distance, 200, 0.0, t->owner);
        if (t->defect != 0)
            chip_damage(c, 200 + t->distance, 200, 1, 1, t->defect);
        cutter_options options = chip_options(c);
        options.r_psf_px = t->r_psf;
        cut_fixture f;
        cut_init(&f, c, NULL, &options);
        const uint32_t flags = cut_at(&f, 200, 200, t->r_gal, 1);
        if (flags != t->flags)
            fail_msg("fault %zu: flags %#x", i, flags);
        for (int k = 0; k < N && flags != 0; k++)
            assert_true(f.pair.galaxy[k] == 0.0 && f.pair.noise[k] == 0.0);
        assert_true(flags == 0 || f.pair.filled == 0.0);
        cut_deinit(&f);
        chip_free(c);
    }
}

static void test_several_flags(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 4);
    chip_damage(c, 201, 200, 1, 1, PIXEL_BAD);
    chip_damage(c, 202, 200, 1, 1, PIXEL_SATURATED);
    chip_own(c, 195, 200, 1, 9);
    const cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 200, 200, R_GAL, 1),
                     SHEAR_FLAG_HOLE | SHEAR_FLAG_SATURATED | SHEAR_FLAG_NEIGHBOUR);
    /* whose pixels they are can be told */
    const cutter_source source = {.x = 200, .y = 200, .r_gal = R_GAL, .owner = 9};
    assert_int_equal(cutter_cut(f.cutter, &source, &f.pair, NULL), SHEAR_OK);
    assert_int_equal(f.pair.flags, SHEAR_FLAG_HOLE | SHEAR_FLAG_SATURATED);
    cut_deinit(&f);
    chip_free(c);
}

static void test_edge_and_position(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, 300, 1.0, 4);
    const cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    /* the box is 24 px before the position, and 24 px from it on */
    assert_int_equal(cut_at(&f, 23.5, 150, R_GAL, 1), 0);
    assert_int_equal(cut_at(&f, 23.49, 150, R_GAL, 1), SHEAR_FLAG_EDGE);
    assert_int_equal(cut_at(&f, SIDE - 24 + 0.49, 150, R_GAL, 1), 0);
    assert_int_equal(cut_at(&f, SIDE - 24 + 0.5, 150, R_GAL, 1), SHEAR_FLAG_EDGE);
    assert_int_equal(cut_at(&f, 200, 24, R_GAL, 1), 0);
    assert_int_equal(cut_at(&f, 200, 23, R_GAL, 1), SHEAR_FLAG_EDGE);
    assert_int_equal(cut_at(&f, 200, 276, R_GAL, 1), 0);
    assert_int_equal(cut_at(&f, 200, 277, R_GAL, 1), SHEAR_FLAG_EDGE);
    assert_int_equal(cut_at(&f, -0.5, 299.4, R_GAL, 1), SHEAR_FLAG_EDGE);
    const double nowhere[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, -0.51, SIDE - 0.5, 3e9};
    for (size_t i = 0; i < sizeof nowhere / sizeof *nowhere; i++) {
        assert_int_equal(cut_at(&f, nowhere[i], 150, R_GAL, 1), SHEAR_FLAG_NO_POSITION);
        assert_int_equal(cut_at(&f, 150, nowhere[i], R_GAL, 1), SHEAR_FLAG_NO_POSITION);
    }
    assert_true(isnan(f.pair.sigma));
    cut_deinit(&f);
    chip_free(c);
}

/* 30 % of the frame are enough for its plane. */
static void test_a_hidden_frame(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 4);
        const cutter_options options = chip_options(c);
        /* all but the uppermost 8 rows of the box, whose first pixel is (176, 176) */
        const int boxes[3][4] = {{176, 176, 48, 8}, {176, 184, 8, 32}, {216, 184, 8, 32}};
        for (int i = 0; i < 3; i++) {
            const int *b = boxes[i];
            if (kind == 0)
                chip_damage(c, b[0], b[1], b[2], b[3], PIXEL_BAD);
            for (int k = 0; k < b[2] * b[3] && kind == 1; k++)
                chip_own(c, b[0] + k % b[2], b[1] + (double)(k / b[2]), 0.0, 7);
        }
        for (int x = 173; kind == 1 && x < 227; x++) /* what grows into the rest is cut away */
            chip_own(c, x, 216, 0.0, 0);
        cut_fixture f;
        cut_init(&f, c, NULL, &options);
        const uint32_t flags = cut_at(&f, 200, 200, R_GAL, 1);
        assert_int_equal(flags, kind == 0 ? 0 : SHEAR_FLAG_NEIGHBOUR);
        cut_deinit(&f);
        chip_damage(c, 190, 220, 1, 1, PIXEL_BAD);
        cut_init(&f, c, NULL, &options);
        assert_int_equal(cut_at(&f, 200, 200, R_GAL, 1),
                         kind == 0 ? SHEAR_FLAG_HOLE : SHEAR_FLAG_NEIGHBOUR);
        cut_deinit(&f);
        chip_free(c);
    }
}

static void test_no_noise(void **state) {
    (void)state;
    chip_pixels *c = chip_new(96, 96, 1.0, 4);
    cutter_options options = chip_options(c);
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 48, 48, R_GAL, 1), SHEAR_FLAG_NO_NOISE);
    cut_deinit(&f);
    chip_free(c);
    /* two boxes fit beside the stamp: at x = 44 and 48 */
    c = chip_new(96, 48, 1.0, 4);
    for (int k = 1; k <= 3; k++) {
        options = chip_options(c);
        options.noise_stamps = k;
        cut_init(&f, c, NULL, &options);
        assert_int_equal(cut_at(&f, 24 + 4, 24, R_GAL, 1), k == 3 ? SHEAR_FLAG_NO_NOISE : 0);
        cut_deinit(&f);
    }
    chip_free(c);
    /* nothing is sky, or nothing at all is good */
    c = chip_new(SIDE, SIDE, 1.0, 4);
    for (int i = 0; i < SIDE * SIDE; i++)
        c->owner[i] = 1;
    options = chip_options(c);
    options.noise = SHEAR_NOISE_WHITE;
    cut_init(&f, c, NULL, &options);
    assert_true((cut_at(&f, 200, 200, R_GAL, 1) & SHEAR_FLAG_NEIGHBOUR) != 0);
    cut_deinit(&f);
    chip_damage(c, 0, 0, SIDE, SIDE, PIXEL_BAD);
    cut_init(&f, c, NULL, &options);
    assert_true((cut_at(&f, 200, 200, R_GAL, 1) & SHEAR_FLAG_HOLE) != 0);
    cut_deinit(&f);
    chip_free(c);
}

/* ---- random numbers ---- */

typedef struct copy {
    double galaxy[N], noise[N];
    int noise_x, noise_y;
} copy;

static copy copy_of(const cut_fixture *f) {
    copy p = {.noise_x = f->pair.noise_x[0], .noise_y = f->pair.noise_y[0]};
    memcpy(p.galaxy, f->pair.galaxy, sizeof p.galaxy);
    memcpy(p.noise, f->pair.noise, sizeof p.noise);
    return p;
}

/* Bytes are compared: no padding is in a copy of doubles and two ints. */
static void assert_same(const copy *a, const copy *b, bool same) {
    assert_int_equal(memcmp(a, b, sizeof *a) == 0, same);
}

static void test_numbers_depend_on_chip_source_and_pixel_only(void **state) {
    (void)state;
    enum { SOURCES = 12 };
    static copy first[SOURCES];
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 5);
    for (int i = 0; i < SIDE; i += 17)
        chip_damage(c, 0, i, SIDE, 1, PIXEL_BAD);
    cutter_options options = chip_options(c);
    options.noise = SHEAR_NOISE_WHITE;
    options.r_psf_px = 0.5;
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    for (int i = 0; i < SOURCES; i++) {
        assert_int_equal(cut_at(&f, 100 + 10 * i, 17 * 9 + 9, 1.0, i), 0);
        assert_true(f.pair.filled > 0.05);
        first[i] = copy_of(&f);
    }
    for (int i = SOURCES - 1; i >= 0; i--) {
        assert_int_equal(cut_at(&f, 100 + 10 * i, 17 * 9 + 9, 1.0, i), 0);
        const copy again = copy_of(&f);
        assert_same(&first[i], &again, true);
        assert_int_equal(cut_at(&f, 100 + 10 * i, 17 * 9 + 9, 1.0, i + ((int64_t)1 << 40)), 0);
        const copy other = copy_of(&f);
        assert_same(&first[i], &other, false);
    }
    cut_deinit(&f);
    options.chip++;
    cut_init(&f, c, NULL, &options);
    assert_int_equal(cut_at(&f, 100, 17 * 9 + 9, 1.0, 0), 0);
    const copy on_another = copy_of(&f);
    assert_same(&first[0], &on_another, false);
    cut_deinit(&f);
    chip_free(c);
}

/* The fill has the local sigma, and no two numbers of it are the same. */
static void test_the_fill(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 3.0, 6);
    for (int i = 4; i < SIDE; i += 25)
        chip_damage(c, 0, i, SIDE, 4, PIXEL_BAD);
    cutter_options options = chip_options(c);
    options.noise = SHEAR_NOISE_WHITE;
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    double sum = 0.0;
    double squares = 0.0;
    double cross = 0.0;
    int n = 0;
    for (int i = 0; i < 200; i++) {
        assert_int_equal(cut_at(&f, 200, 4 + 25 * 7 + 14, R_GAL, i), 0);
        for (int k = 0; k < N; k++) {
            if (c->defect[(k / STAMP + f.pair.y) * SIDE] != 0) {
                sum += f.pair.galaxy[k];
                squares += f.pair.galaxy[k] * f.pair.galaxy[k];
                cross += f.pair.galaxy[k] * f.pair.noise[k];
                n++;
            }
        }
    }
    assert_true(n > 20000);
    const double sigma2 = f.pair.sigma * f.pair.sigma;
    assert_true(fabs(f.pair.sigma - 3.0) < 0.1);
    assert_true(fabs(sum / n) < 4.0 * 3.0 / sqrt(n));
    assert_true(fabs(squares / n / sigma2 - 1.0) < 4.0 * sqrt(2.0 / n));
    assert_true(fabs(cross / n / sigma2) < 4.0 / sqrt(n));
    cut_deinit(&f);
    chip_free(c);
}

/* ---- errors ---- */

static void test_errors_of_reading(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 7);
    const cutter_options options = chip_options(c);
    shear_error err = {0};
    int n = 0;
    for (bool done = false; !done; n++) {
        cutter *made = NULL;
        c->reads = n;
        const int code = cutter_new(&made, c, NULL, &options, &err);
        done = code == SHEAR_OK;
        assert_true(done || (code == SHEAR_E_IO && made == NULL));
        cutter_free(made);
    }
    assert_true(n > 4);
    c->reads = -1;
    cut_fixture f;
    cut_init(&f, c, NULL, &options);
    const cutter_source source = {.x = 200, .y = 200, .r_gal = R_GAL};
    for (n = 0; n < 3; n++) {
        c->reads = n;
        assert_int_equal(cutter_cut(f.cutter, &source, &f.pair, &err), SHEAR_E_IO);
    }
    c->reads = -1;
    assert_int_equal(cut_at(&f, 200, 200, R_GAL, 0), 0);
    cut_deinit(&f);
    chip_free(c);
}

static long allocations; /* until one fails; negative: none does */
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    return allocations >= 0 && allocations-- == 0 ? NULL : __real_aligned_alloc(alignment, size);
}

static void test_out_of_memory(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 7);
    const cutter_options options = chip_options(c);
    shear_error err = {0};
    int n = 0;
    for (bool done = false; !done; n++) {
        cutter *made = NULL;
        allocations = n;
        const int code = cutter_new(&made, c, NULL, &options, &err);
        allocations = -1;
        done = code == SHEAR_OK;
        assert_true(done || (code == SHEAR_E_NOMEM && made == NULL));
        cutter_free(made);
    }
    assert_int_equal(n, 4);
    chip_free(c);
}

static void refuse(chip_pixels *c, const cutter_options *options, int code, const char *what) {
    shear_error err = {0};
    cutter *made = NULL;
    assert_int_equal(cutter_new(&made, c, NULL, options, &err), code);
    assert_null(made);
    if (strstr(err.message, what) == NULL)
        fail_msg("%s", err.message);
}

static void test_impossible_options(void **state) {
    (void)state;
    chip_pixels *c = chip_new(SIDE, SIDE, 1.0, 7);
    const cutter_options good = chip_options(c);
    cutter_options o = good;
    o.stamp = 1025;
    refuse(c, &o, SHEAR_E_SETTING, "1025 px");
    o.stamp = 0;
    refuse(c, &o, SHEAR_E_SETTING, "8 to 1024");
    o = good;
    o.noise_stamps = 65;
    refuse(c, &o, SHEAR_E_SETTING, "65 noise stamps");
    o = good;
    o.noise = SHEAR_NOISE_IMAGE;
    refuse(c, &o, SHEAR_E_SETTING, "image of noise");
    o = good;
    o.nx = o.ny = 199999;
    refuse(c, &o, SHEAR_E_FORMAT, "too large");
    o.nx = 10;
    o.ny = 200001;
    refuse(c, &o, SHEAR_E_FORMAT, "200000 px a side");
    chip_free(c);
}

/* Sizes from the smallest stamp to one that is larger than the chip, and numbers that overflow. */
static void test_extremes(void **state) {
    (void)state;
    const int sizes[] = {8, 9, 31, 100, 300, 1024};
    chip_pixels *c = chip_new(SIDE, 300, 1.0, 8);
    cutter_options options = chip_options(c);
    cut_fixture f;
    for (int i = 0; i < 6; i++) {
        options.stamp = sizes[i];
        options.r_psf_px = 0.5;
        cut_init(&f, c, NULL, &options);
        const uint32_t flags = cut_at(&f, 100, 150, 1.0, 1);
        assert_int_equal(flags, sizes[i] <= 100 ? 0 : SHEAR_FLAG_EDGE);
        cut_deinit(&f);
    }
    options = chip_options(c);
    for (int i = 0; i < SIDE * 300; i++)
        c->value[i] = i % 3 == 0 ? 1e300 : -1e308;
    cut_init(&f, c, NULL, &options);
    cut_at(&f, 200, 150, R_GAL, INT64_MIN);
    cut_deinit(&f);
    for (int i = 0; i < SIDE * 300; i++) {
        c->value[i] = 7.0;
        c->sigma[i] = i % 2 == 0 ? 1e-45F : 3e38F;
    }
    cut_init(&f, c, NULL, &options);
    cut_at(&f, 200, 150, R_GAL, INT64_MAX);
    cut_deinit(&f);
    chip_free(c);
    const int thin[][2] = {{1, 1}, {1, 500}, {500, 3}, {63, 65}};
    for (int i = 0; i < 4; i++) {
        c = chip_new(thin[i][0], thin[i][1], 1.0, 8);
        options = chip_options(c);
        cut_init(&f, c, NULL, &options);
        assert_true(cut_at(&f, 0, 0, R_GAL, 1) == SHEAR_FLAG_EDGE);
        cut_deinit(&f);
        chip_free(c);
    }
}

int main(void) {
    allocations = -1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_plane_is_subtracted),
        cmocka_unit_test(test_the_nearest_pixel_is_in_the_middle),
        cmocka_unit_test(test_the_union_is_filled_in_both),
        cmocka_unit_test(test_what_is_in_the_light),
        cmocka_unit_test(test_several_flags),
        cmocka_unit_test(test_edge_and_position),
        cmocka_unit_test(test_a_hidden_frame),
        cmocka_unit_test(test_no_noise),
        cmocka_unit_test(test_numbers_depend_on_chip_source_and_pixel_only),
        cmocka_unit_test(test_the_fill),
        cmocka_unit_test(test_errors_of_reading),
        cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_impossible_options),
        cmocka_unit_test(test_extremes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
