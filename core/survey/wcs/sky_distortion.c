/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_distortion.h"

#include <math.h>

/* With parity taken off, J = (a, b; c, d) = scale R S^-1 is a polar decomposition, and
 * S^-1 = (1 - g1, -g2; -g2, 1 + g1)/sqrt(1 - |g|^2) is the root of J^T J/scale^2, which for 2 x 2
 * matrices is (J^T J/scale^2 + 1) over its trace's root. */
sky_distortion sky_distortion_of(const double j[4]) {
    const double det = j[0] * j[3] - j[1] * j[2];
    const bool mirrored = det < 0.0;
    const double a = mirrored ? -j[0] : j[0], b = mirrored ? -j[1] : j[1], c = j[2], d = j[3];
    const double trace = (a + d) * (a + d) + (c - b) * (c - b);
    return (sky_distortion){.g1 = (b * b + d * d - a * a - c * c) / trace,
                            .g2 = -2.0 * (a * b + c * d) / trace,
                            .scale = sqrt(fabs(det)),
                            .rotation = atan2(c - b, a + d),
                            .mirrored = mirrored};
}
