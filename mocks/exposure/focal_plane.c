/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "exposure/focal_plane.h"

#include <gsl/gsl_math.h>
#include <math.h>

static const double degree = M_PI / 180.0;

/* A vector of length 1 in the equatorial frame. */
typedef struct vector {
    double x, y, z;
} vector;

static double dot(vector a, vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Return a + p b + q c. */
static vector combine(vector a, double p, vector b, double q, vector c) {
    return (vector){a.x + p * b.x + q * c.x, a.y + p * b.y + q * c.y, a.z + p * b.z + q * c.z};
}

static vector direction(double ra, double dec) {
    return (vector){cos(dec) * cos(ra), cos(dec) * sin(ra), sin(dec)};
}

static vector east(double ra) {
    return (vector){-sin(ra), cos(ra), 0.0};
}

static vector north(double ra, double dec) {
    return (vector){-sin(dec) * cos(ra), -sin(dec) * sin(ra), cos(dec)};
}

/* Without distortion, (West, North) = scale * rotation * (+-dx, dy); xi is to the East. */
static void set_matrix(focal_plane *f, const shear_mock_exposure *e) {
    const double scale = e->pixel_scale_arcsec / 3600.0;
    const double c = scale * cos(e->rotation_deg * degree);
    const double s = scale * sin(e->rotation_deg * degree);
    const double parity = e->mirrored ? -1.0 : 1.0;
    f->cd[0] = -parity * c;
    f->cd[1] = s;
    f->cd[2] = parity * s;
    f->cd[3] = c;
}

focal_plane focal_plane_make(const shear_mock_exposure *e) {
    focal_plane f = {.skew1 = e->skew1,
                     .skew2 = e->skew2,
                     .ra = e->ra_deg * degree,
                     .dec = e->dec_deg * degree,
                     .half_x = 0.5 * (e->chips_x * (e->nx + e->gap_px) - e->gap_px),
                     .half_y = 0.5 * (e->chips_y * (e->ny + e->gap_px) - e->gap_px)};
    set_matrix(&f, e);
    /* xi = x (1 + k r^2) is stretched by 1 + 3 k r^2 along the radius and by 1 + k r^2 across: its
     * shear is k r^2 / (1 + 2 k r^2). */
    const double corner = hypot(f.half_x, f.half_y) * e->pixel_scale_arcsec / 3600.0;
    f.k = e->distortion / (1.0 - 2.0 * e->distortion) / (corner * corner);
    return f;
}

chip_place focal_plane_chip(const shear_mock_exposure *e, int i) {
    const double column = i % e->chips_x - 0.5 * (e->chips_x - 1);
    const double row = i / e->chips_x - 0.5 * (e->chips_y - 1);
    return (chip_place){0.5 * (e->nx + 1) - column * (e->nx + e->gap_px),
                        0.5 * (e->ny + 1) - row * (e->ny + e->gap_px)};
}

bool focal_plane_distorted(const focal_plane *f) {
    return f->k != 0.0 || f->skew1 != 0.0 || f->skew2 != 0.0;
}

/* Set out = a b, 2 x 2. */
static void multiply(const double a[4], const double b[4], double out[4]) {
    out[0] = a[0] * b[0] + a[1] * b[2];
    out[1] = a[0] * b[1] + a[1] * b[3];
    out[2] = a[2] * b[0] + a[3] * b[2];
    out[3] = a[2] * b[1] + a[3] * b[3];
}

/* Compute (xi, eta), degrees, and their derivatives by pixels. */
static void polynomial(const focal_plane *f, double dx, double dy, double *xi, double *eta,
                       double slope[4]) {
    const double x = f->cd[0] * dx + f->cd[1] * dy;
    const double y = f->cd[2] * dx + f->cd[3] * dy;
    const double r2 = x * x + y * y;
    *xi = (1.0 + f->skew1) * x + f->skew2 * y + f->k * x * r2;
    *eta = (1.0 - f->skew1) * y + f->skew2 * x + f->k * y * r2;
    const double cross = f->skew2 + 2.0 * f->k * x * y;
    const double d[4] = {1.0 + f->skew1 + f->k * (r2 + 2.0 * x * x), cross, cross,
                         1.0 - f->skew1 + f->k * (r2 + 2.0 * y * y)};
    multiply(d, f->cd, slope);
}

/* The direction n of (xi, eta) is w / |w|, w = centre + xi east + eta north. Its derivative by xi,
 * (east - n (n east)) / |w|, has the components e' east / |w| and n' east / |w| along East e' and
 * North n' at that place, which are perpendicular to n. */
sky_place focal_plane_sky(const focal_plane *f, double dx, double dy) {
    double xi, eta;
    double slope[4];
    polynomial(f, dx, dy, &xi, &eta, slope);
    const vector e0 = east(f->ra);
    const vector n0 = north(f->ra, f->dec);
    const vector w = combine(direction(f->ra, f->dec), xi * degree, e0, eta * degree, n0);
    const double length = sqrt(dot(w, w));
    const double ra = atan2(w.y, w.x);
    const double dec = atan2(w.z, hypot(w.x, w.y));
    const vector e = east(ra);
    const vector n = north(ra, dec);
    const double arcsec = 3600.0 / length;
    const double projection[4] = {-arcsec * dot(e, e0), -arcsec * dot(e, n0), arcsec * dot(n, e0),
                                  arcsec * dot(n, n0)};
    sky_place place = {.ra = ra / degree, .dec = dec / degree};
    if (place.ra < 0.0)
        place.ra += 360.0;
    multiply(projection, slope, place.j);
    return place;
}
