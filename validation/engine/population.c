/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/population.h"

#include <math.h>

static const double smallest = 2.0, largest = 4.5; /* half-light radii, px */
static const double scatter = 0.26, roundest_cut = 0.7;
static const double most_bulge = 0.5, bulge_ratio = 0.6;
/* half-light radius over scale of Spergel profiles of index 0.5 (exponential) and -0.6 */
static const double half_light_disk = 1.67834, half_light_bulge = 0.54771;

/* ---- dice ---- */

static uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static const uint64_t golden = UINT64_C(0x9E3779B97F4A7C15);

dice dice_begin(uint64_t seed, enum dice_purpose purpose, int64_t index) {
    uint64_t s = mix(seed + golden);
    s = mix(s ^ ((uint64_t)purpose * UINT64_C(0xD1B54A32D192ED03)));
    return (dice){.state = mix(s + (uint64_t)index * UINT64_C(0xA24BAED4963EE407))};
}

double dice_mixed(uint64_t z) {
    return (double)(mix(z) >> 11) / 9007199254740992.0;
}

double dice_uniform(dice *d) {
    d->state += golden;
    return dice_mixed(d->state);
}

void dice_normal(dice *d, int n, double *out) {
    for (int i = 0; i < n; i += 2) {
        double r = sqrt(-2.0 * log(1.0 - dice_uniform(d)));
        double a = 2.0 * M_PI * dice_uniform(d);
        out[i] = r * cos(a);
        if (i + 1 < n)
            out[i + 1] = r * sin(a);
    }
}

/* ---- galaxies ---- */

/* Traits of a galaxy: size and bulge fraction are drawn first, then shapes until one is round
 * enough. */
typedef struct traits {
    double radius, bulge, e[2];
} traits;

static traits traits_of(const population *p, int64_t stamp) {
    dice d = dice_begin(p->seed, DICE_GALAXY, stamp / p->copies);
    traits t = {.radius = smallest * pow(largest / smallest, dice_uniform(&d)),
                .bulge = most_bulge * dice_uniform(&d)};
    do {
        dice_normal(&d, 2, t.e);
        t.e[0] *= scatter;
        t.e[1] *= scatter;
    } while (hypot(t.e[0], t.e[1]) >= roundest_cut);
    return t;
}

double population_radius(const population *p, int64_t stamp) {
    return traits_of(p, stamp).radius;
}

light_galaxy population_bare(const population *p, int64_t stamp) {
    const traits t = traits_of(p, stamp);
    const double det = sqrt(1.0 - t.e[0] * t.e[0] - t.e[1] * t.e[1]);
    const double size = p->bulges ? 1.0 : bulge_ratio;
    return (light_galaxy){
        .bulge = p->bulges ? 1.0 : t.bulge,
        .disk_px = t.radius / half_light_disk,
        .bulge_px = size * t.radius / half_light_bulge,
        .map = {{(1.0 + t.e[0]) / det, t.e[1] / det}, {t.e[1] / det, (1.0 - t.e[0]) / det}}};
}

/* Set map = a map. */
static void multiply(const double a[2][2], double map[2][2]) {
    for (int j = 0; j < 2; j++) {
        double x = map[0][j];
        double y = map[1][j];
        map[0][j] = a[0][0] * x + a[0][1] * y;
        map[1][j] = a[1][0] * x + a[1][1] * y;
    }
}

static double angle_of(const population *p, int64_t stamp) {
    if (p->copies > 1)
        return M_PI * (double)(stamp % p->copies) / p->copies;
    dice d = dice_begin(p->seed, DICE_ROTATION, stamp);
    return M_PI * dice_uniform(&d);
}

light_galaxy population_galaxy(const population *p, int64_t stamp) {
    light_galaxy g = population_bare(p, stamp);
    const double angle = angle_of(p, stamp);
    const double rotation[2][2] = {{cos(angle), -sin(angle)}, {sin(angle), cos(angle)}};
    const double lens[2][2] = {{1.0 + p->shear[0], p->shear[1]}, {p->shear[1], 1.0 - p->shear[0]}};
    multiply(rotation, g.map);
    multiply(lens, g.map);
    return g;
}

void population_centre(const population *p, int64_t stamp, double *x, double *y) {
    dice d = dice_begin(p->seed, DICE_SHIFT, stamp);
    *x = dice_uniform(&d) - 0.5;
    *y = dice_uniform(&d) - 0.5;
}
