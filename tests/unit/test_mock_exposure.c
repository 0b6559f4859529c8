/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mock exposures: coordinates, objects and their light, against closed forms. */
#include "exposure/detector.h"
#include "exposure/drawer.h"
#include "test_mock_fixture.h"

#include <gsl/gsl_math.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = M_PI / 180.0;

/* The defaults with "name value" pairs, ended by NULL. */
static shear_mock_exposure exposure_with(const char *const *settings) {
    shear_mock_exposure e;
    shear_error err = {0};
    shear_mock_exposure_init(&e);
    for (; settings[0] != NULL; settings += 2) {
        if (shear_mock_exposure_set(&e, settings[0], settings[1], &err) != 0)
            fail_msg("%s", err.message);
    }
    if (shear_mock_exposure_check(&e, &err) != 0)
        fail_msg("%s", err.message);
    return e;
}
#define EXPOSURE(...) exposure_with((const char *const[]){__VA_ARGS__, NULL})

static shear_mock_exposure hard_exposure(void) {
    return EXPOSURE("chips", "3x2", "chip-size", "900x700", "rotation", "37", "mirrored", "yes",
                    "distortion", "0.05", "skew", "0.02,-0.01", "pointing", "359.9,71");
}

/* ---- coordinates ---- */
/* The sky at (dx, dy), by the textbook: TPV, and the gnomonic projection's inverse in angles. */
static void textbook(const shear_mock_exposure *e, const focal_plane *f, double dx, double dy,
                     double *ra, double *dec) {
    const double x = f->cd[0] * dx + f->cd[1] * dy;
    const double y = f->cd[2] * dx + f->cd[3] * dy;
    const double k = f->k;
    const double xi = ((1 + e->skew1) * x + e->skew2 * y + k * (x * x * x + x * y * y)) * degree;
    const double eta = ((1 - e->skew1) * y + e->skew2 * x + k * (y * y * y + y * x * x)) * degree;
    const double rho = hypot(xi, eta);
    const double c = atan(rho);
    const double dec0 = e->dec_deg * degree;
    const double sine = rho > 0.0 ? eta / rho * sin(c) : 0.0;
    *dec = asin(cos(c) * sin(dec0) + sine * cos(dec0)) / degree;
    *ra = e->ra_deg + atan2(xi, cos(dec0) - eta * sin(dec0)) / degree;
    *ra = fmod(*ra + 360.0, 360.0);
}

static void test_places_on_the_sky(void **state) {
    (void)state;
    const shear_mock_exposure e = hard_exposure();
    const focal_plane f = focal_plane_make(&e);
    for (int i = 0; i < 200; i++) {
        double ra, dec;
        const double dx = f.half_x * sin(i * 1.7);
        const double dy = f.half_y * sin(i * 2.3 + 1.0);
        const sky_place place = focal_plane_sky(&f, dx, dy);
        textbook(&e, &f, dx, dy, &ra, &dec);
        assert_close(place.ra, ra, 1e-10);
        assert_close(place.dec, dec, 1e-10);
    }
}

/* Offsets (West, North), arcsec, of (ra, dec) in the tangent plane at `at`. */
static void tangent(const sky_place *at, const sky_place *p, double *u, double *v) {
    const double dec0 = at->dec * degree;
    const double dec = p->dec * degree;
    const double a = (p->ra - at->ra) * degree;
    const double d = sin(dec0) * sin(dec) + cos(dec0) * cos(dec) * cos(a);
    *u = -cos(dec) * sin(a) / d / degree * 3600.0;
    *v = (cos(dec0) * sin(dec) - sin(dec0) * cos(dec) * cos(a)) / d / degree * 3600.0;
}

static void test_jacobians(void **state) {
    (void)state;
    const shear_mock_exposure e = hard_exposure();
    const focal_plane f = focal_plane_make(&e);
    for (int i = 0; i < 50; i++) {
        const double dx = f.half_x * sin(i * 1.7);
        const double dy = f.half_y * sin(i * 2.3 + 1.0);
        const sky_place at = focal_plane_sky(&f, dx, dy);
        for (int axis = 0; axis < 2; axis++) {
            double u[2], v[2];
            for (int side = 0; side < 2; side++) {
                const double h = side == 0 ? -0.5 : 0.5;
                const sky_place near =
                    focal_plane_sky(&f, dx + (axis == 0 ? h : 0.0), dy + (axis == 1 ? h : 0.0));
                tangent(&at, &near, &u[side], &v[side]);
            }
            assert_close(at.j[axis], u[1] - u[0], 1e-7);
            assert_close(at.j[2 + axis], v[1] - v[0], 1e-7);
        }
    }
}

/* At rotation 0, x is to the West and y to the North; turning by 90 degrees, x to the North. */
static void test_orientation(void **state) {
    (void)state;
    static const struct {
        const char *rotation, *mirrored;
        double j[4];
    } cases[] = {{"0", "no", {1, 0, 0, 1}},
                 {"90", "no", {0, -1, 1, 0}},
                 {"0", "yes", {-1, 0, 0, 1}},
                 {"90", "yes", {0, -1, -1, 0}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const shear_mock_exposure e = EXPOSURE("rotation", cases[i].rotation, "mirrored",
                                               cases[i].mirrored, "pixel-scale", "1");
        const focal_plane f = focal_plane_make(&e);
        const sky_place p = focal_plane_sky(&f, 0.0, 0.0);
        for (int k = 0; k < 4; k++)
            assert_close(p.j[k], cases[i].j[k], 1e-12);
    }
}

/* The shear of the field's distortion at a corner is what was asked for. */
static void test_distortion_at_the_corner(void **state) {
    (void)state;
    const shear_mock_exposure e = EXPOSURE("distortion", "0.04", "chip-size", "1000");
    const focal_plane f = focal_plane_make(&e);
    const sky_place p = focal_plane_sky(&f, f.half_x, f.half_y);
    const double across = 0.5 * (p.j[1] + p.j[2]);
    const double mean = 0.5 * (p.j[0] + p.j[3]);
    assert_close(across / mean, 0.04, 1e-5);
}

/* ---- light ---- */
/* The stamp's pixels, and the object's place in them. */
typedef struct drawing {
    drawer d;
    double x, y;
} drawing;

static double pixel(const drawing *g, int x, int y) {
    return g->d.modes[2 * ((ptrdiff_t)y * g->d.n + x)];
}

static void draw(drawing *g, const light *l, double x, double y, double threshold) {
    assert_true(drawer_init(&g->d));
    drawer_place(&g->d, l, x, y, threshold);
    drawer_draw(&g->d, l, x, y, threshold);
    g->x = x - g->d.x;
    g->y = y - g->d.y;
}

/* The integral of a Moffat profile of unit flux over the pixel whose centre is (x, y), by Gauss's
 * rule of five points in each quarter. */
static double moffat_pixel(double beta, const psf_place *psf, double x, double y) {
    static const double node[] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                  0.9061798459386640};
    static const double weight[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                    0.4786286704993665, 0.2369268850561891};
    const double alpha = 0.5 * psf->fwhm / sqrt(pow(2.0, 1.0 / beta) - 1.0);
    const double det = 1.0 - psf->e1 * psf->e1 - psf->e2 * psf->e2;
    double sum = 0.0;
    for (int i = 0; i < 20; i++) {
        const double px = x + 0.25 * (i % 4 < 2 ? -1 : 1) + 0.25 * node[i / 4];
        for (int k = 0; k < 5; k++) {
            const double py = y + (i % 2 == 0 ? -0.25 : 0.25) + 0.25 * node[k];
            const double u = ((1 - psf->e1) * px - psf->e2 * py) / sqrt(det) / alpha;
            const double v = (-psf->e2 * px + (1 + psf->e1) * py) / sqrt(det) / alpha;
            sum += weight[i / 4] * weight[k] * pow(1.0 + u * u + v * v, -beta);
        }
    }
    return sum / 16.0 * (beta - 1.0) / (M_PI * alpha * alpha);
}

static void test_stars_are_integrals_over_pixels(void **state) {
    (void)state;
    static const char *const names[] = {"2.5", "3.5", "4.5"};
    static const double betas[] = {2.5, 3.5, 4.5};
    const psf_place psf = {.fwhm = 3.5, .e1 = 0.1, .e2 = -0.05};
    for (int i = 0; i < 3; i++) {
        const shear_mock_exposure e = EXPOSURE("moffat", names[i]);
        const scene_object star = {.flux = 1.0, .is_star = true};
        const light l = light_of(&e, &star, &psf);
        drawing g;
        draw(&g, &l, 100.3, 57.8, 1e-12);
        for (int y = g.d.n / 2 - 15; y < g.d.n / 2 + 15; y++) {
            for (int x = g.d.n / 2 - 15; x < g.d.n / 2 + 15; x++) {
                /* beta 2.5 and 512 pixels: what comes in from the other side */
                assert_close(pixel(&g, x, y), moffat_pixel(betas[i], &psf, x - g.x, y - g.y),
                             i == 0 ? 2e-7 : 2e-8);
            }
        }
        drawer_deinit(&g.d);
    }
}

static void moments(const drawing *g, double *flux, double c[3]) {
    double sum = 0.0, mx = 0.0, my = 0.0;
    memset(c, 0, 3 * sizeof *c);
    for (int y = 0; y < g->d.n; y++) {
        for (int x = 0; x < g->d.n; x++) {
            const double f = pixel(g, x, y), dx = x - g->x, dy = y - g->y;
            sum += f;
            mx += f * dx;
            my += f * dy;
            c[0] += f * dx * dx;
            c[1] += f * dx * dy;
            c[2] += f * dy * dy;
        }
    }
    assert_close(mx / sum, 0.0, 1e-6);
    assert_close(my / sum, 0.0, 1e-6);
    for (int k = 0; k < 3; k++)
        c[k] /= sum;
    *flux = sum;
}

/* Set out = A C A', symmetric matrices as (xx, xy, yy), A by rows. */
static void map_moments(const double a[4], const double c[3], double out[3]) {
    out[0] = a[0] * a[0] * c[0] + 2 * a[0] * a[1] * c[1] + a[1] * a[1] * c[2];
    out[1] = a[0] * a[2] * c[0] + (a[0] * a[3] + a[1] * a[2]) * c[1] + a[1] * a[3] * c[2];
    out[2] = a[2] * a[2] * c[0] + 2 * a[2] * a[3] * c[1] + a[3] * a[3] * c[2];
}

/* Moments of the drawn galaxy, taken to the sky, are those of the sheared disk, the PSF and the
 * pixel added: in closed form 3 r_d^2 for a round disk, alpha^2 / (2 (beta - 2)), 1/12. */
static void test_galaxies_have_the_sky_moments_of_a_sheared_disk(void **state) {
    (void)state;
    shear_mock_exposure e = hard_exposure();
    const focal_plane f = focal_plane_make(&e);
    e.moffat = SHEAR_MOCK_MOFFAT_45;
    const psf_place psf = {.fwhm = 3.0, .e1 = 0.08, .e2 = 0.03};
    scene_object o = {.flux = 1000.0, .r_half = 0.5, .e1 = 0.2, .e2 = -0.3};
    o.sky = focal_plane_sky(&f, 900.0, -500.0);
    const light l = light_of(&e, &o, &psf);
    drawing g;
    double flux, drawn[3], on_sky[3], expected[3], instrument[3];
    draw(&g, &l, 500.2, 400.9, 1e-12);
    moments(&g, &flux, drawn);
    assert_close(flux, 1000.0, 1e-6);

    const double alpha2 = psf.fwhm * psf.fwhm / 4.0 / (pow(2.0, 1.0 / 4.5) - 1.0);
    const double round[3] = {alpha2 / 5.0, 0.0, alpha2 / 5.0};
    const double n = sqrt(1.0 - psf.e1 * psf.e1 - psf.e2 * psf.e2);
    const double shape[4] = {(1 + psf.e1) / n, psf.e2 / n, psf.e2 / n, (1 - psf.e1) / n};
    map_moments(shape, round, instrument);
    instrument[0] += 1.0 / 12.0;
    instrument[2] += 1.0 / 12.0;
    for (int k = 0; k < 3; k++)
        drawn[k] -= instrument[k];
    map_moments(o.sky.j, drawn, on_sky);

    const double scale = o.r_half / 1.6783469900166605;
    const double disk[3] = {3 * scale * scale, 0.0, 3 * scale * scale};
    const double m = sqrt(1.0 - 0.04 - 0.09);
    const double own[4] = {1.2 / m, -0.3 / m, -0.3 / m, 0.8 / m};
    const double s = sqrt(1.0 - e.g1 * e.g1 - e.g2 * e.g2);
    const double lens[4] = {(1 + e.g1) / s, e.g2 / s, e.g2 / s, (1 - e.g1) / s};
    double unlensed[3];
    map_moments(own, disk, unlensed);
    map_moments(lens, unlensed, expected);
    for (int k = 0; k < 3; k++)
        assert_close(on_sky[k], expected[k], 3e-5 * expected[0]);
    drawer_deinit(&g.d);
}

/* A threshold leaves out what is below it; another place of the same object is the same light. */
static void test_small_stamps_miss_what_is_negligible(void **state) {
    (void)state;
    const shear_mock_exposure e = EXPOSURE("r-half", "0.5,0.6");
    const psf_place psf = {.fwhm = 4.0};
    const scene_object o = {.flux = 5000.0, .r_half = 0.5, .e1 = 0.1, .sky.j = {0.2, 0, 0, 0.2}};
    const light l = light_of(&e, &o, &psf);
    const double threshold = 0.1;
    drawing small, large;
    draw(&small, &l, 600.4, 600.1, threshold);
    draw(&large, &l, 600.4, 600.1, 1e-12);
    const int d = (large.d.n - small.d.n) / 2;
    assert_true(d > 0);
    for (int y = 0; y < small.d.n; y++) {
        for (int x = 0; x < small.d.n; x++)
            assert_close(pixel(&small, x, y), pixel(&large, x + d, y + d), threshold);
    }
    drawer_deinit(&small.d);
    drawer_deinit(&large.d);
}

static void test_what_is_beyond_the_image_is_left_out(void **state) {
    (void)state;
    enum { NX = 40, NY = 30 };
    const shear_mock_exposure e = EXPOSURE("fwhm", "3");
    const psf_place psf = {.fwhm = 3.0};
    const scene_object o = {.flux = 100.0, .is_star = true};
    const light l = light_of(&e, &o, &psf);
    double *image = doubles(NX * NY);
    drawing g;
    draw(&g, &l, 0.0, NY - 1.0, 1e-4);
    const image_band bands[] = {{image, NX, 0, 7}, {image, NX, 7, NY - 4}, {image, NX, NY - 4, NY}};
    assert_false(drawer_touches(&g.d, &(image_band){image, NX, 100, 120}));
    for (size_t i = 0; i < sizeof bands / sizeof *bands; i++)
        drawer_add(&g.d, &bands[i]);
    double sum = 0.0;
    for (int i = 0; i < NX * NY; i++)
        sum += image[i];
    assert_true(sum > 25.0 && sum < 45.0); /* a quarter, and half of the pixels on the edge */
    drawer_deinit(&g.d);
    free(image);
}

/* ---- scenes ---- */
static void test_fours_cancel(void **state) {
    (void)state;
    const shear_mock_exposure e = EXPOSURE("fours", "yes", "spacing", "64", "stars", "1");
    const focal_plane f = focal_plane_make(&e);
    scene s;
    assert_true(scene_init(&s, &e, &f, 0));
    double e1 = 0.0, e2 = 0.0, flux = 0.0;
    int64_t galaxies = 0;
    for (int64_t i = 0; i < s.n; i++) {
        const scene_object *o = &s.objects[i];
        if (o->is_star)
            continue;
        if (galaxies % 4 == 0)
            flux = o->flux;
        assert_true(flux == o->flux);
        e1 += o->e1;
        e2 += o->e2;
        if (++galaxies % 4 == 0) {
            assert_close(e1, 0.0, 1e-14);
            assert_close(e2, 0.0, 1e-14);
        }
    }
    assert_true(galaxies > 700 && s.n == 1024);
    scene_deinit(&s);
}

/* Distances between galaxies of one cell are sheared on the sky; stars stay. */
static void test_sheared_places(void **state) {
    (void)state;
    shear_mock_exposure e = EXPOSURE("chip-size", "400", "shear-places", "yes", "rotation", "20",
                                     "mirrored", "yes", "shear", "0.1,-0.05");
    const focal_plane f = focal_plane_make(&e);
    scene sheared, still;
    assert_true(scene_init(&sheared, &e, &f, 0));
    e.shear_places = false;
    assert_true(scene_init(&still, &e, &f, 0));
    const double scale = 1.0 / sqrt(1.0 - 0.01 - 0.0025);
    for (int64_t i = 1; i < still.n; i++) {
        double u, v, su, sv;
        const scene_object *a = &still.objects[i];
        const scene_object *b = &sheared.objects[i];
        if (a->is_star) {
            assert_true(a->x == b->x && a->y == b->y);
            continue;
        }
        tangent(&still.objects[0].sky, &a->sky, &u, &v);
        tangent(&sheared.objects[0].sky, &b->sky, &su, &sv);
        assert_close(su, scale * (1.1 * u - 0.05 * v), 2e-5 * (fabs(u) + fabs(v)));
        assert_close(sv, scale * (-0.05 * u + 0.9 * v), 2e-5 * (fabs(u) + fabs(v)));
    }
    scene_deinit(&sheared);
    scene_deinit(&still);
}

static void test_numbers_and_fluxes(void **state) {
    (void)state;
    const shear_mock_exposure e = EXPOSURE("galaxies", "30", "stars", "3", "flux-slope", "1.5");
    const focal_plane f = focal_plane_make(&e);
    scene s;
    assert_true(scene_init(&s, &e, &f, 0));
    const double area = pow(2048 * 0.263 / 60.0, 2);
    assert_int_equal(s.n, llround(30 * area) + llround(3 * area));
    double bright = 0.0, galaxies = 0.0;
    for (int64_t i = 0; i < s.n; i++) {
        const scene_object *o = &s.objects[i];
        assert_true(o->x >= 0.5 && o->x <= 2048.5 && o->y >= 0.5 && o->y <= 2048.5);
        galaxies += !o->is_star;
        bright += !o->is_star && o->flux > 4000.0;
    }
    /* (2^-1.5 - 25^-1.5) / (1 - 25^-1.5) */
    assert_close(bright / galaxies, 0.3486, 0.03);
    scene_deinit(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places_on_the_sky),
        cmocka_unit_test(test_jacobians),
        cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_distortion_at_the_corner),
        cmocka_unit_test(test_stars_are_integrals_over_pixels),
        cmocka_unit_test(test_galaxies_have_the_sky_moments_of_a_sheared_disk),
        cmocka_unit_test(test_small_stamps_miss_what_is_negligible),
        cmocka_unit_test(test_what_is_beyond_the_image_is_left_out),
        cmocka_unit_test(test_fours_cancel),
        cmocka_unit_test(test_sheared_places),
        cmocka_unit_test(test_numbers_and_fluxes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
