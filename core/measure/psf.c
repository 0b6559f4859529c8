/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The PSF's scale radius, from the area above exp(-1/2) of the peak, on samples `refine` times
 * finer. A cell that the contour crosses counts by the fraction inside, with the contour taken as
 * straight (marching squares). Between the given samples the logarithm is interpolated bicubically:
 * for a Gaussian it is a quadratic, which the paper's derivative estimates reproduce exactly. */
#include "measure/psf.h"

#include "base/simd.h"

#include "shear/plan.h"

#include <math.h>
#include <stdbool.h>

/* Compute the sum and the brightest sample. Return false if a sample is not finite. */
SHEAR_SIMD static bool scan(const double *psf, long n, double *sum, double *peak) {
    double total = 0.0;
    double most = -INFINITY;
    double not_finite = 0.0; /* becomes NaN at the first NaN or infinity */
#pragma omp simd reduction(+ : total, not_finite) reduction(max : most)
    for (long i = 0; i < n; i++) {
        total += psf[i];
        not_finite += psf[i] * 0.0;
        most = psf[i] > most ? psf[i] : most;
    }
    *sum = total;
    *peak = most;
    return not_finite == 0.0;
}

int psf_check(const double *psf, int nx, int ny, double *peak, shear_error *err) {
    static const char advice[] =
        "the PSF must be an image of positive total flux, pixel response included";
    const long n = (long)nx * ny;
    double sum;
    if (!scan(psf, n, &sum, peak)) {
        long i = 0;
        while (i < n - 1 && isfinite(psf[i]))
            i++;
        return shear_fail(err, SHEAR_E_PSF, advice, "the PSF is not finite at sample (%ld, %ld)",
                          i % nx + 1, i / nx + 1);
    }
    if (!(sum > 0.0) || !(*peak > 0.0) || !isfinite(sum)) {
        return shear_fail(err, SHEAR_E_PSF, advice,
                          "the PSF's sum is %g and its peak %g: not positive", sum, *peak);
    }
    return SHEAR_OK;
}

long psf_brightest(const double *psf, long n) {
    long brightest = 0;
    for (long i = 1; i < n; i++)
        brightest = psf[i] > psf[brightest] ? i : brightest;
    return brightest;
}

/* Cubic Hermite interpolation with central differences between b and c. */
static double cubic(double a, double b, double c, double d, double t) {
    const double u = 1.0 - t;
    return (1.0 + 2.0 * t) * u * u * b + t * t * (3.0 - 2.0 * t) * c + 0.5 * t * u * u * (c - a) -
           0.5 * t * t * u * (d - b);
}

/* Fill the logarithms of the 16 samples around the cell (i, j) .. (i+1, j+1). Return false if one
 * is not positive. */
static bool log_patch(const psf_view *v, int i, int j, double patch[4][4]) {
    for (int b = 0; b < 4; b++) {
        for (int a = 0; a < 4; a++) {
            const double value = psf_sample(v, i - 1 + a, j - 1 + b);
            if (!(value > 0.0))
                return false;
            patch[b][a] = log(value);
        }
    }
    return true;
}

static void patch_column(double patch[4][4], double t, double column[4]) {
    for (int b = 0; b < 4; b++)
        column[b] = cubic(patch[b][0], patch[b][1], patch[b][2], patch[b][3], t);
}

static double patch_at(double patch[4][4], double t, double u) {
    double column[4];
    patch_column(patch, t, column);
    return cubic(column[0], column[1], column[2], column[3], u);
}

static double bilinear(const psf_view *v, int x, int y, double t, double u) {
    return (1 - t) * (1 - u) * psf_sample(v, x, y) + t * (1 - u) * psf_sample(v, x + 1, y) +
           (1 - t) * u * psf_sample(v, x, y + 1) + t * u * psf_sample(v, x + 1, y + 1);
}

/* Return ln of the PSF at (x, y), in samples: log-bicubic; if a neighbouring sample is not
 * positive, the nearest sample. */
static double log_at(const psf_view *v, double x, double y) {
    const int i = (int)floor(x);
    const int j = (int)floor(y);
    double patch[4][4];
    if (log_patch(v, i, j, patch))
        return patch_at(patch, x - i, y - j);
    const double nearest = psf_sample(v, (int)lround(x), (int)lround(y));
    return nearest > 0.0 ? log(nearest) : -INFINITY;
}

void psf_refine(const psf_view *v, int x, int y, int fine, double *out) {
    double patch[4][4];
    const bool positive = log_patch(v, x, y, patch);
    for (int j = 0; j < fine; j++) {
        for (int i = 0; i < fine; i++) {
            const double t = (double)i / fine;
            const double u = (double)j / fine;
            out[j * fine + i] = positive ? exp(patch_at(patch, t, u)) : bilinear(v, x, y, t, u);
        }
    }
}

double psf_at(const psf_view *v, double x, double y) {
    return exp(log_at(v, x, y));
}

enum { MAX_REFINE = 32 };

/* Fill the height of the PSF above the level, positive inside, on the (refine+1)^2 corners of the
 * cell's subcells: as logarithms if all samples around are positive, else bilinear. */
static void cell_heights(const psf_view *v, int i, int j, int refine, double level,
                         double height[MAX_REFINE + 1][MAX_REFINE + 1]) {
    double patch[4][4];
    const bool positive = log_patch(v, i, j, patch);
    const double log_level = log(level);
    for (int p = 0; p <= refine; p++) {
        const double t = (double)p / refine;
        double column[4] = {0};
        if (positive)
            patch_column(patch, t, column);
        for (int q = 0; q <= refine; q++) {
            const double u = (double)q / refine;
            height[q][p] = positive
                               ? cubic(column[0], column[1], column[2], column[3], u) - log_level
                               : bilinear(v, i, j, t, u) - level;
        }
    }
}

/* Return the part of a triangle at the corner that is alone on its side of a straight contour. */
static double lone_part(double lone, double p, double q) {
    return lone / (lone - p) * (lone / (lone - q));
}

/* Return the fraction of a triangle with corner values a, b, c that is above 0, with a straight
 * contour. */
static double triangle(double a, double b, double c) {
    const int above = (a > 0) + (b > 0) + (c > 0);
    if (above == 0 || above == 3)
        return above == 3 ? 1.0 : 0.0;
    const bool lone_side = above == 1;
    const double part = (b > 0) == lone_side   ? lone_part(b, a, c)
                        : (c > 0) == lone_side ? lone_part(c, a, b)
                                               : lone_part(a, b, c);
    return above == 1 ? part : 1.0 - part;
}

/* Return the area above `level` of the cell between four samples, in cells. */
static double cell_area(const psf_view *v, int i, int j, int refine, double level) {
    double height[MAX_REFINE + 1][MAX_REFINE + 1];
    cell_heights(v, i, j, refine, level, height);
    double area = 0.0;
    for (int q = 0; q < refine; q++) {
        for (int p = 0; p < refine; p++) {
            const double low_left = height[q][p];
            const double high_right = height[q + 1][p + 1];
            const int above =
                (low_left > 0) + (high_right > 0) + (height[q][p + 1] > 0) + (height[q + 1][p] > 0);
            area += above % 4 == 0 /* the contour is elsewhere */
                        ? above / 4
                        : 0.5 * (triangle(low_left, height[q][p + 1], high_right) +
                                 triangle(low_left, height[q + 1][p], high_right));
        }
    }
    return area / ((double)refine * refine);
}

/* Return the highest value near sample (x, y), by hill climbing with halved steps. */
static double peak_near(const psf_view *v, int x, int y) {
    double best = log(psf_sample(v, x, y));
    double best_x = x;
    double best_y = y;
    for (double step = 0.5; step > 1e-3;) {
        bool climbed = false;
        for (int direction = 0; direction < 4; direction++) {
            const double try_x = best_x + (direction == 0 ? step : direction == 1 ? -step : 0.0);
            const double try_y = best_y + (direction == 2 ? step : direction == 3 ? -step : 0.0);
            const bool near = fabs(try_x - x) <= 1.0 && fabs(try_y - y) <= 1.0;
            const double value = near ? log_at(v, try_x, try_y) : -INFINITY;
            if (value > best) {
                best = value;
                best_x = try_x;
                best_y = try_y;
                climbed = true;
            }
        }
        step *= climbed ? 1.0 : 0.5;
    }
    return exp(best);
}

/* Return 1 if the cell and all around it is above the level, 0 if all is well below it, -1 if the
 * contour may pass. */
static int cell_side(const psf_view *v, int i, int j, double level) {
    double high = -INFINITY;
    double low = INFINITY;
    for (int b = -1; b <= 2; b++) {
        for (int a = -1; a <= 2; a++) {
            const double value = psf_sample(v, i + a, j + b);
            high = value > high ? value : high;
            low = value < low ? value : low;
        }
    }
    return low > level ? 1 : high < 0.25 * level ? 0 : -1;
}

int shear_psf_radius(const double *psf, int nx, int ny, double oversample, double *r_psf_px,
                     shear_error *err) {
    double largest;
    if (psf_check(psf, nx, ny, &largest, err) != SHEAR_OK)
        return SHEAR_E_PSF;
    const psf_view view = {.psf = psf, .nx = nx, .ny = ny};
    const long brightest = psf_brightest(psf, (long)nx * ny);
    long above = 0; /* samples above the level, about the area: they decide the refinement */
    const double peak = peak_near(&view, (int)(brightest % nx), (int)(brightest / nx));
    const double level = exp(-0.5) * peak;
    for (long i = 0; i < (long)nx * ny; i++)
        above += psf[i] > level;
    const int refine = above < 16 ? MAX_REFINE : above < 256 ? 8 : above < 4096 ? 2 : 1;
    double area = 0.0;
    for (int j = -1; j < ny; j++) {
        for (int i = -1; i < nx; i++) {
            /* Half a cell beyond the outermost samples still belongs to the image. */
            const double part =
                (i < 0 || i == nx - 1 ? 0.5 : 1.0) * (j < 0 || j == ny - 1 ? 0.5 : 1.0);
            const int side = cell_side(&view, i, j, level);
            area += part * (side >= 0 ? side : cell_area(&view, i, j, refine, level));
        }
    }
    *r_psf_px = sqrt(area / M_PI) / oversample;
    return SHEAR_OK;
}
