/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/aliases.h"

#include <math.h>

enum { RINGS = 400, ANGLES = 48, FARTHEST = 3 }; /* aliases up to this many periods away */

/* half-light radius of an exponential disk of scale 1 */
static const double half_light_disk = 1.67834;

double disk_power(double k, const void *half_light_px) {
    const double scale = *(const double *)half_light_px / half_light_disk;
    return pow(1.0 + k * k * scale * scale, -3.0);
}

/* Return the power of the aliases at a mode, divided by |W|^2 there. */
static double aliased_power(double kx, double ky, const double sigma_px[2], power_function *power,
                            const void *context) {
    const double period = 2.0 * M_PI;
    const double x2 = sigma_px[0] * sigma_px[0];
    const double y2 = sigma_px[1] * sigma_px[1];
    double sum = 0.0;
    for (int j = -FARTHEST; j <= FARTHEST; j++) {
        for (int i = -FARTHEST; i <= FARTHEST; i++) {
            const double x = kx + period * i;
            const double y = ky + period * j;
            const double fall = x2 * (x * x - kx * kx) + y2 * (y * y - ky * ky);
            sum += i != 0 || j != 0 ? power(hypot(x, y), context) * exp(-fall) : 0.0;
        }
    }
    return sum;
}

double aliases_share(double beta_px, const double sigma_px[2], power_function *power,
                     const void *context) {
    double own = 0.0;
    double aliases = 0.0;
    for (int ring = 0; ring < RINGS; ring++) {
        const double k = M_PI * (ring + 0.5) / RINGS;
        const double weight = k * k * k * exp(-beta_px * beta_px * k * k);
        own += weight * power(k, context);
        for (int i = 0; i < ANGLES; i++) {
            const double angle = 2.0 * M_PI * (i + 0.5) / ANGLES;
            aliases += weight / ANGLES *
                       aliased_power(k * cos(angle), k * sin(angle), sigma_px, power, context);
        }
    }
    return aliases / own;
}
