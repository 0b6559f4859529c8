/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/probe_field.h"

#include "base/cleanup.h"
#include "shear/field.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { SIDE = 32 };
/* noise: relative to the galaxy's peak */
static const double galaxy_sigma_px = 2.5, psf_sigma_px = 1.5, noise = 1e-3;

/* Return a number in [-1, 1), from the same sequence in every process. */
static double draw(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

/* Draw a round Gaussian under the shear, convolved with the PSF, which gives a Gaussian again. Its
 * centre is off the stamp's by a fraction of a pixel. */
static void draw_galaxy(uint64_t *seed, double out[SIDE * SIDE]) {
    const double s2 = galaxy_sigma_px * galaxy_sigma_px;
    const double p2 = psf_sigma_px * psf_sigma_px;
    const double norm = 1.0 - PROBE_G1 * PROBE_G1 - PROBE_G2 * PROBE_G2;
    const double a = (1.0 + PROBE_G1) / norm;
    const double b = PROBE_G2 / norm;
    const double d = (1.0 - PROBE_G1) / norm;
    const double xx = s2 * (a * a + b * b) + p2;
    const double yy = s2 * (b * b + d * d) + p2;
    const double xy = s2 * b * (a + d);
    const double det = xx * yy - xy * xy;
    const double x0 = 0.5 * (SIDE + draw(seed));
    const double y0 = 0.5 * (SIDE + draw(seed));
    for (int j = 0; j < SIDE; j++) {
        for (int i = 0; i < SIDE; i++) {
            const double x = i - x0;
            const double y = j - y0;
            const double r2 = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / det;
            out[j * SIDE + i] = exp(-0.5 * r2) + noise * draw(seed);
        }
    }
}

static void draw_psf(double out[SIDE * SIDE]) {
    const double p2 = psf_sigma_px * psf_sigma_px;
    for (int j = 0; j < SIDE; j++) {
        for (int i = 0; i < SIDE; i++) {
            const double x = i - 0.5 * SIDE;
            const double y = j - 0.5 * SIDE;
            out[j * SIDE + i] = exp(-0.5 * (x * x + y * y) / p2);
        }
    }
}

static int write_all(shear_field_writer *w, shear_error *err) {
    double galaxy[SIDE * SIDE];
    double blank[SIDE * SIDE];
    uint64_t seed = 1;
    for (int i = 0; i < PROBE_STAMPS; i++) {
        draw_galaxy(&seed, galaxy);
        for (int k = 0; k < SIDE * SIDE; k++)
            blank[k] = noise * draw(&seed);
        TRY(shear_field_write(w, i, 1, galaxy, blank, NULL, err));
    }
    draw_psf(galaxy);
    return shear_field_write_psf(w, 0, galaxy, err);
}

static int open_path(const char *path, int *fd, shear_error *err) {
    *fd = open(path, O_RDONLY | O_CLOEXEC);
    return *fd >= 0 ? SHEAR_OK
                    : shear_fail(err, SHEAR_E_IO, NULL, "%.300s: cannot be opened: %s", path,
                                 strerror(errno));
}

int probe_field_make(const char *directory, int *fd, shear_error *err) {
    char path[4300];
    shear_field_writer *w = NULL;
    const shear_field_spec spec = {.name = "probe",
                                   .pixscale = NAN,
                                   .has_truth = true,
                                   .sim_g1 = PROBE_G1,
                                   .sim_g2 = PROBE_G2,
                                   .geometry = {SIDE, SIDE, SIDE, SIDE, 1},
                                   .n_stamps = PROBE_STAMPS,
                                   .n_psf = 1,
                                   .layout = SHEAR_LAYOUT_CUBE,
                                   .bitpix = -64,
                                   .overwrite = true};
    *fd = -1;
    snprintf(path, sizeof path, "%s/probe.fits", directory);
    int code = shear_field_create(&w, path, &spec, err);
    code = code == SHEAR_OK ? write_all(w, err) : code;
    if (code != SHEAR_OK) {
        shear_field_abort(w);
        return code;
    }
    code = shear_field_finish(w, err);
    code = code == SHEAR_OK ? open_path(path, fd, err) : code;
    unlink(path);
    return code;
}
