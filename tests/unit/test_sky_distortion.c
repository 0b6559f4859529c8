/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a Jacobian, against maps that are put together of known parts. */
#include "sky_fixture.h"
#include "survey/wcs/sky_distortion.h"

#include <math.h>
#include <stdlib.h>

static double between(double a, double b) {
    return a + (b - a) * (double)rand() / RAND_MAX;
}

/* J = scale P R(rotation) S^-1: the parts come back, for shears of any size. */
static void parts_come_back(void **state) {
    (void)state;
    srand(1);
    for (int i = 0; i < 2000; i++) {
        const double size = i % 2 == 0 ? 0.04 : 0.7, angle = between(0.0, 7.0);
        const double g1 = size * cos(angle), g2 = size * sin(angle);
        const double scale = exp(between(-5.0, 5.0)), turn = between(-3.1, 3.1);
        const double sign = i % 3 == 0 ? -1.0 : 1.0, root = sqrt(1.0 - g1 * g1 - g2 * g2);
        const double inverse[2][2] = {{(1.0 - g1) / root, -g2 / root},
                                      {-g2 / root, (1.0 + g1) / root}};
        const double rotation[2][2] = {{sign * cos(turn), -sign * sin(turn)},
                                       {sin(turn), cos(turn)}};
        double j[4] = {0};
        for (int row = 0; row < 2; row++) {
            for (int column = 0; column < 2; column++) {
                for (int k = 0; k < 2; k++)
                    j[2 * row + column] += scale * rotation[row][k] * inverse[k][column];
            }
        }
        const sky_distortion d = sky_distortion_of(j);
        assert_close(d.g1, g1, 1e-12);
        assert_close(d.g2, g2, 1e-12);
        assert_close(d.scale / scale, 1.0, 1e-12);
        assert_close(d.rotation, turn, 1e-12);
        assert_true(d.mirrored == (sign < 0.0));
    }
}

/* A circle on the sky is, in pixels, the ellipse that gravity of shear (g1, g2) would make of a
 * circle: longest at half the angle of (g1, g2), with axes as (1 + |g|) to (1 - |g|). */
static void circles_become_ellipses(void **state) {
    (void)state;
    srand(2);
    for (int i = 0; i < 200; i++) {
        double j[4];
        for (int k = 0; k < 4; k++)
            j[k] = between(-1.0, 1.0);
        const sky_distortion d = sky_distortion_of(j);
        const double g = hypot(d.g1, d.g2), axis = 0.5 * atan2(d.g2, d.g1);
        if (g > 0.95)
            continue;
        /* lengths on the sky of a pixel's length along the ellipse's axes */
        const double c = cos(axis), s = sin(axis);
        const double along = hypot(j[0] * c + j[1] * s, j[2] * c + j[3] * s);
        const double across = hypot(-j[0] * s + j[1] * c, -j[2] * s + j[3] * c);
        assert_close(across / along, (1.0 + g) / (1.0 - g), 1e-9 * across / along);
        assert_close(along * across, d.scale * d.scale, 1e-12);
    }
    /* pixels that are twice as high as wide, on the sky: objects are squeezed along y */
    const double tall[4] = {1.0, 0.0, 0.0, 2.0};
    assert_close(sky_distortion_of(tall).g1, 1.0 / 3.0, 1e-15);
}

/* Rotating the camera turns the pixel frame's shear with it, and a mirror changes the sign of g2.
 */
static void frames_turn(void **state) {
    (void)state;
    const double j[4] = {0.26, 0.004, -0.003, 0.27}, angle = 0.3, c = cos(angle), s = sin(angle);
    const double turned[4] = {j[0] * c + j[1] * s, j[1] * c - j[0] * s, j[2] * c + j[3] * s,
                              j[3] * c - j[2] * s};
    const double mirrored[4] = {-j[0], j[1], -j[2], j[3]};
    const sky_distortion d = sky_distortion_of(j), t = sky_distortion_of(turned),
                         m = sky_distortion_of(mirrored);
    assert_close(t.rotation, d.rotation + angle, 1e-12);
    assert_close(t.g1, d.g1 * cos(2.0 * angle) + d.g2 * sin(2.0 * angle), 1e-12);
    assert_close(t.g2, d.g2 * cos(2.0 * angle) - d.g1 * sin(2.0 * angle), 1e-12);
    assert_close(m.g1, d.g1, 1e-12);
    assert_close(m.g2, -d.g2, 1e-12);
    assert_true(m.mirrored && !d.mirrored);
}

static void zero_has_no_parts(void **state) {
    (void)state;
    const double zero[4] = {0.0, 0.0, 0.0, 0.0};
    const sky_distortion d = sky_distortion_of(zero);
    assert_true(isnan(d.g1) && isnan(d.g2) && d.scale == 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_come_back),
        cmocka_unit_test(circles_become_ellipses),
        cmocka_unit_test(frames_turn),
        cmocka_unit_test(zero_has_no_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
