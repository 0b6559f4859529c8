/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flat tops: found where a ceiling makes them, and not where pixels are equal because they are
 * counts, or copies of each other. */
#include "gaussian.h"
#include "measure/photometry.h"
#include "measure/saturation.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 40, PIXELS = N * N };

static uint64_t seed = 3;

static double uniform(void) {
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(seed >> 11) + 0.5) * 0x1p-53;
}

static double normal(void) {
    const double r = sqrt(-2.0 * log(uniform()));
    return r * cos(2.0 * M_PI * uniform());
}

typedef struct scene {
    double galaxy[PIXELS], noise[PIXELS];
} scene;

/* An object of this peak over the sky, anywhere within the middle pixel. */
static void draw(scene *s, double peak, double size_px) {
    const double xx = size_px * size_px;
    const gaussian g = {
        peak, xx, 0.8 * xx, 0.1 * xx, N / 2 + uniform() - 0.5, N / 2 + uniform() - 0.5};
    gaussian_draw(&g, N, N, 1, s->galaxy);
    memset(s->noise, 0, sizeof s->noise);
}

/* White noise over a sky, and the source's photons where `gain` electrons make 1; rounded to whole
 * numbers where `counts`. */
static void add_noise(scene *s, double sky, double sigma, double gain, bool counts) {
    for (int i = 0; i < PIXELS; i++) {
        const double photons = gain > 0.0 ? fmax(0.0, s->galaxy[i]) / gain : 0.0;
        s->galaxy[i] += sky + sqrt(sigma * sigma + photons) * normal();
        s->noise[i] += sky + sigma * normal();
        s->galaxy[i] = counts ? floor(s->galaxy[i] + 0.5) : s->galaxy[i];
        s->noise[i] = counts ? floor(s->noise[i] + 0.5) : s->noise[i];
    }
}

static void clip(scene *s, double most) {
    for (int i = 0; i < PIXELS; i++)
        s->galaxy[i] = fmin(s->galaxy[i], most);
}

/* What is found, and that what is found was suspected. */
static artefact look(const scene *s) {
    double most[N / 8];
    const photometry ph = photometry_of(s->galaxy, s->noise, N, N, most);
    const artefact_pair pair = {
        .galaxy = s->galaxy, .noise = s->noise, .nx = N, .ny = N, .ph = &ph, .strip_most = most};
    const double sigma = artefact_sigma(&pair);
    const artefact found = saturation_find(&pair, sigma);
    const bool suspected = saturation_suspected(&pair, sigma);
    assert_false(found.in_noise);
    if (found.x >= 0 && suspected)
        assert_true(s->galaxy[found.y * N + found.x] == ph.galaxy_most);
    return suspected ? found : (artefact){.x = -1, .y = -1};
}

static int found_of(int n, double peak, double size, double ceiling, double sigma, double gain,
                    bool counts) {
    int found = 0;
    for (int i = 0; i < n; i++) {
        scene s;
        draw(&s, peak, size);
        add_noise(&s, 50.0 * sigma, sigma, gain, counts);
        const double most = 50.0 * sigma + ceiling * peak;
        clip(&s, counts ? floor(most) : most);
        found += look(&s).x >= 0;
    }
    return found;
}

/* Objects that lose their peak to a ceiling: at 60 % of it all that are not faint. */
static void test_flat_tops(void **state) {
    (void)state;
    static const double peaks[] = {8.0, 20.0, 50.0, 200.0, 1000.0};
    for (int i = 0; i < 5; i++) {
        assert_int_equal(found_of(100, peaks[i], 2.0, 0.6, 1.0, 0.0, false), 100);
        assert_int_equal(found_of(100, peaks[i], 3.5, 0.6, 1.0, 5.0, false), 100);
        assert_true(found_of(100, peaks[i], 3.5, 0.8, 1.0, 0.0, false) > 95);
        const int counts = found_of(100, 10.0 * peaks[i], 2.0, 0.6, 10.0, 10.0, true);
        assert_true(peaks[i] < 20.0 || counts > 95);
    }
}

/* Objects as they are: none in 20,000, of doubles and of counts with noise from a fifth of a count
 * to thirty, faint and bright, with and without the photons' own noise. */
static void test_no_false_alarms(void **state) {
    (void)state;
    static const double sigmas[] = {0.2, 0.5, 1.0, 2.0, 5.0, 30.0};
    static const double peaks[] = {0.5, 3.0, 8.0, 20.0, 100.0, 1000.0};
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 6; k++) {
            const double peak = peaks[k] * sigmas[i];
            for (int photons = 0; photons < 2; photons++) {
                assert_int_equal(found_of(150, peak, 1.5, INFINITY, sigmas[i], photons, true), 0);
                assert_int_equal(found_of(150, peak, 6.0, INFINITY, sigmas[i], photons, true), 0);
                assert_int_equal(found_of(40, peak, 3.0, INFINITY, sigmas[i], photons, false), 0);
            }
        }
    }
}

/* Each pixel of a coarser image is four here. */
static void test_copied_pixels(void **state) {
    (void)state;
    for (int i = 0; i < 100; i++) {
        scene s;
        draw(&s, 300.0, 3.0);
        add_noise(&s, 0.0, 1.0, 0.0, false);
        for (int y = 0; y < N; y++) {
            for (int x = 0; x < N; x++)
                s.galaxy[y * N + x] = s.galaxy[y / 2 * 2 * N + x / 2 * 2];
        }
        assert_int_equal(look(&s).x, -1);
    }
}

/* Four pixels about the centre of a symmetric image without noise; and noise stamps without. */
static void test_symmetric_and_quiet(void **state) {
    (void)state;
    scene s;
    const gaussian g = {100.0, 4.0, 4.0, 0.0, (N - 1) / 2.0, (N - 1) / 2.0};
    gaussian_draw(&g, N, N, 1, s.galaxy);
    for (int i = 0; i < PIXELS; i++)
        s.noise[i] = normal();
    assert_int_equal(look(&s).x, -1);
    draw(&s, 100.0, 3.0);
    add_noise(&s, 0.0, 1.0, 0.0, false);
    clip(&s, 60.0);
    assert_true(look(&s).x >= 0);
    memset(s.noise, 0, sizeof s.noise);
    assert_int_equal(look(&s).x, -1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flat_tops),
        cmocka_unit_test(test_no_false_alarms),
        cmocka_unit_test(test_copied_pixels),
        cmocka_unit_test(test_symmetric_and_quiet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
