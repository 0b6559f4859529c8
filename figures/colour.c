/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The palette and the colour maps. The maps are computed as paths through OKLab (Ottosson 2020),
 * whose lightness is close to perceptually uniform. */
#include "shear_figures/scale.h"

#include <math.h>

static double clamp01(double v) {
    return v > 0.0 ? fmin(v, 1.0) : 0.0; /* NaN becomes 0 */
}

static double srgb_from_linear(double v) {
    v = clamp01(v);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
}

static double cube(double v) {
    return v * v * v;
}

static shear_colour from_oklab(double lightness, double a, double b) {
    const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
    return (shear_colour){
        .r = srgb_from_linear(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
        .g = srgb_from_linear(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        .b = srgb_from_linear(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s),
        .a = 1.0};
}

/* Return the chroma along the path, inside the gamut of sRGB: it rises in the violet, then slowly
 * increases to the yellow. */
static double uniform_chroma(double t) {
    const double violet = (t - 0.17) / 0.09;
    const double late = clamp01(2.0 * t - 1.0);
    return 0.088 + 0.040 * exp(-violet * violet) + 0.055 * late * late * (3.0 - 2.0 * late);
}

shear_colour shear_map_colour(enum shear_map map, double t) {
    t = clamp01(t);
    if (map == SHEAR_MAP_GREY)
        return from_oklab(t, 0.0, 0.0);
    const double degree = acos(-1.0) / 180.0;
    const double hue = (305.0 - 200.0 * t) * degree;
    const double chroma = uniform_chroma(t);
    return from_oklab(0.17 + 0.78 * t, chroma * cos(hue), chroma * sin(hue));
}

shear_colour shear_map_not_finite(void) {
    return (shear_colour){
        0.90, 0.45, 0.60,
        1.0}; /* pink, which is in neither map, and differs from the negatives' blue */
}

shear_colour shear_map_negative(void) {
    return (shear_colour){0.15, 0.40, 0.95, 1.0};
}

shear_colour shear_palette(int i) {
    /* Colours after Okabe & Ito (2008). */
    static const shear_colour colours[SHEAR_N_HUES] = {
        [SHEAR_BLACK] = {0.10, 0.10, 0.10, 1.0},     [SHEAR_BLUE] = {0.00, 0.45, 0.70, 1.0},
        [SHEAR_VERMILION] = {0.84, 0.37, 0.00, 1.0}, [SHEAR_GREEN] = {0.00, 0.62, 0.45, 1.0},
        [SHEAR_PURPLE] = {0.80, 0.47, 0.65, 1.0},    [SHEAR_ORANGE] = {0.90, 0.62, 0.00, 1.0},
        [SHEAR_SKY] = {0.34, 0.71, 0.91, 1.0},       [SHEAR_GREY] = {0.55, 0.55, 0.55, 1.0}};
    const int wrapped = i % SHEAR_N_HUES;
    return colours[wrapped < 0 ? wrapped + SHEAR_N_HUES : wrapped];
}

shear_colour shear_palette_faint(int i, double opacity) {
    shear_colour colour = shear_palette(i);
    colour.a = clamp01(opacity);
    return colour;
}
