/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "shear_mocks/mock.h"

#include "base/cleanup.h"
#include "galaxy.h"
#include "noise.h"
#include "painter.h"
#include "random.h"
#include "spec.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

struct shear_mock {
    shear_mock_spec spec;
    shear_mock_info info;
};

static void fill_info(shear_mock *m) {
    const shear_mock_spec *s = &m->spec;
    int side = spec_psf_side(s);
    enum shear_psf_layout layout = s->psf_per_stamp ? SHEAR_PSF_PER_STAMP
                                   : s->psf_ids > 0 ? SHEAR_PSF_BY_ID
                                                    : SHEAR_PSF_ONE;
    m->info =
        (shear_mock_info){.geometry = {s->nx, s->ny, side, side, s->oversample},
                          .n_stamps = s->n_stamps,
                          .n_galaxies = (s->n_stamps + s->rotate - 1) / s->rotate,
                          .n_psf = s->psf_per_stamp ? s->n_stamps
                                   : s->psf_ids > 0 ? s->psf_ids
                                                    : 1,
                          .psf_layout = layout,
                          .max_points = galaxy_max_points(s),
                          .psf_peak = psf_peak(s->psf),
                          .psf_flux = psf_flux(s->psf, s->r_psf_px),
                          .point_amplitude = spec_point_amplitude(s),
                          .noise_density = spec_noise_density(s),
                          .noise_amplitude = spec_point_amplitude(s) * spec_noise_amplitude(s)};
}

int shear_mock_new(shear_mock **m, const shear_mock_spec *spec, shear_error *err) {
    *m = NULL;
    TRY(shear_mock_spec_check(spec, err));
    shear_mock *made = calloc(1, sizeof *made);
    if (made == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a mock");
    made->spec = *spec;
    fill_info(made);
    *m = made;
    return SHEAR_OK;
}

void shear_mock_free(shear_mock *m) {
    free(m);
}

const shear_mock_info *shear_mock_get_info(const shear_mock *m) {
    return &m->info;
}

const shear_mock_spec *shear_mock_get_spec(const shear_mock *m) {
    return &m->spec;
}

int shear_mock_points(const shear_mock *m, int64_t galaxy, double *x, double *y) {
    return galaxy_points(&m->spec, galaxy, x, y);
}

int shear_mock_image_points(const shear_mock *m, int64_t stamp, double *x, double *y) {
    const shear_mock_spec *s = &m->spec;
    int n = galaxy_points(s, stamp / s->rotate, x, y);
    int copy = (int)(stamp % s->rotate);
    galaxy_rotate(s->rotate == 2 ? 2 * copy : copy, n, x, y);
    galaxy_lens(s->g1, s->g2, n, x, y);
    return n;
}

/* Return whether the whole stamp is rotated: the second half of a galaxy's copies is. */
static bool is_rotated(const shear_mock_spec *s, int64_t stamp) {
    return s->turn_stamps && stamp % s->rotate >= s->rotate / 2;
}

/* Return the index by which position (or noise) of a stamp is drawn. */
static uint64_t index_of(const shear_mock_spec *s, int64_t stamp, bool shared) {
    return (uint64_t)(shared                 ? stamp / s->rotate
                      : is_rotated(s, stamp) ? stamp - s->rotate / 2
                                             : stamp);
}

void shear_mock_centre(const shear_mock *m, int64_t stamp, double *x, double *y) {
    const shear_mock_spec *s = &m->spec;
    *x = s->offset_x;
    *y = s->offset_y;
    if (s->shift) {
        random_sequence r;
        uint64_t index = index_of(s, stamp, s->share_shift);
        random_begin(&r, s->seed, RANDOM_SHIFT, index, 0);
        *x += gsl_rng_uniform(&r.rng) - 0.5;
        *y += gsl_rng_uniform(&r.rng) - 0.5;
    }
    if (is_rotated(s, stamp)) {
        double drawn_x = *x;
        *x = -*y;
        *y = drawn_x;
    }
}

/* The rotated copies of a galaxy share its PSF; otherwise the PSFs' shapes would not average out
 * over them. */
int64_t shear_mock_psf_of(const shear_mock *m, int64_t stamp) {
    switch (m->info.psf_layout) {
    case SHEAR_PSF_PER_STAMP:
        return stamp;
    case SHEAR_PSF_BY_ID:
        return stamp / m->spec.rotate % m->info.n_psf;
    default:
        return 0;
    }
}

double shear_mock_psf_angle(const shear_mock *m, int64_t psf) {
    double angle = m->spec.psf_angle_deg;
    if (m->info.psf_layout != SHEAR_PSF_ONE) {
        random_sequence r;
        random_begin(&r, m->spec.seed, RANDOM_PSF_ANGLE, (uint64_t)psf, 0);
        angle += 180.0 * gsl_rng_uniform(&r.rng);
    }
    return angle;
}

void shear_mock_psf_image(const shear_mock *m, int64_t psf, double *out) {
    int nx = m->info.geometry.psf_nx;
    int ny = m->info.geometry.psf_ny;
    psf_image(m->spec.psf, m->spec.r_psf_px, shear_mock_psf_angle(m, psf), m->spec.oversample, nx,
              ny, out);
}

/* ---- stamps ---- */

/* The scratch memory of one thread. */
typedef struct workspace {
    painter painter;
    double *x, *y; /* [max_points], in one allocation */
} workspace;

static void workspace_deinit(workspace *ws) {
    painter_deinit(&ws->painter);
    free(ws->x);
}

static bool workspace_init(workspace *ws, const shear_mock *m) {
    const shear_mock_spec *s = &m->spec;
    const size_t n = (size_t)m->info.max_points;
    ws->x = calloc(2 * n, sizeof *ws->x);
    if (ws->x == NULL)
        return false;
    ws->y = ws->x + n;
    return painter_init(&ws->painter, s->psf, s->r_psf_px, s->nx, s->ny);
}

static void paint_galaxy(const shear_mock *m, workspace *ws, int64_t stamp) {
    const shear_mock_spec *s = &m->spec;
    double magnification = 1.0 - s->g1 * s->g1 - s->g2 * s->g2;
    double amplitude = magnification * m->info.point_amplitude;
    double cx, cy;
    shear_mock_centre(m, stamp, &cx, &cy);
    cx += 0.5 * (s->nx - 1);
    cy += 0.5 * (s->ny - 1);
    int n = shear_mock_image_points(m, stamp, ws->x, ws->y);
    for (int k = 0; k < n; k++)
        painter_point(&ws->painter, amplitude, cx + ws->x[k], cy + ws->y[k]);
}

/* Offset of a noise stamp's random streams from those of the galaxy's preceding noise stamp. */
enum { NEXT_NOISE_STAMP = 1000 };

/* Add noise to the image in the workspace's painter. `stamp_of` is 0 for the galaxy stamp, 1, 2,
 * ... for its noise stamps. Each stream of the galaxy stamp is followed by the one of the noise
 * stamp. */
static void add_noise(const shear_mock *m, workspace *ws, int64_t stamp, int stamp_of,
                      double *image) {
    const int pure = stamp_of > 0 ? 1 + NEXT_NOISE_STAMP * (stamp_of - 1) : 0;
    const shear_mock_spec *s = &m->spec;
    uint64_t index = index_of(s, stamp, s->share_noise);
    const noise_place place = {s->nx, s->ny, is_rotated(s, stamp)};
    random_sequence r;
    if (s->noise_ratio > 0.0) {
        random_begin(&r, s->seed, RANDOM_SOURCES + pure, index, 0);
        noise_sources(&ws->painter, &r, m->info.noise_density, m->info.noise_amplitude,
                      place.rotated);
    }
    painter_finish(&ws->painter, image);
    if (s->photons > 0.0) {
        random_begin(&r, s->seed, RANDOM_PHOTONS + pure, index, 0);
        noise_photons(&r, s->photons, s->subtract_background ? s->photons : 0.0, &place, image);
    }
    if (s->white_sigma > 0.0) {
        random_begin(&r, s->seed, RANDOM_WHITE + pure, index, 0);
        noise_white(&r, s->white_sigma, &place, image);
    }
}

static void make_pair(const shear_mock *m, workspace *ws, int64_t stamp, double *galaxy,
                      double *noise) {
    size_t pixels = (size_t)m->spec.nx * (size_t)m->spec.ny;
    painter_rotate(&ws->painter, shear_mock_psf_angle(m, shear_mock_psf_of(m, stamp)));
    memset(galaxy, 0, pixels * sizeof *galaxy);
    memset(noise, 0, (size_t)m->spec.noise_stamps * pixels * sizeof *noise);
    paint_galaxy(m, ws, stamp);
    add_noise(m, ws, stamp, 0, galaxy);
    for (int k = 0; k < m->spec.noise_stamps; k++)
        add_noise(m, ws, stamp, 1 + k, noise + (size_t)k * pixels);
}

int shear_mock_stamps(const shear_mock *m, int64_t first, int count, int threads, double *galaxy,
                      double *noise, shear_error *err) {
    if (first < 0 || count < 0 || first > m->info.n_stamps - count) {
        return shear_fail(err, SHEAR_E_SETTING, NULL,
                          "%d stamps from number %lld on are not in a mock of %lld stamps", count,
                          (long long)first, (long long)m->info.n_stamps);
    }
    const int wanted = threads > 0 ? threads : omp_get_max_threads();
    const int n = wanted < count ? wanted : count;
    const size_t pixels = (size_t)m->spec.nx * (size_t)m->spec.ny;
    bool failed = false;
    if (count == 0)
        return SHEAR_OK;
#pragma omp parallel num_threads(n) reduction(|| : failed)
    {
        CLEANUP(workspace_deinit) workspace ws = {0};
        failed = !workspace_init(&ws, m);
#pragma omp for schedule(dynamic)
        for (int i = 0; i < count; i++) {
            const size_t at = (size_t)i * pixels;
            if (!failed) {
                make_pair(m, &ws, first + i, galaxy + at,
                          noise + (size_t)m->spec.noise_stamps * at);
            }
        }
    }
    return failed ? shear_fail(err, SHEAR_E_NOMEM, "use fewer threads",
                               "out of memory for mock stamps on %d threads", n)
                  : SHEAR_OK;
}

int shear_mock_paint(const shear_mock *m, int64_t psf, int n, const double *x, const double *y,
                     double amplitude, double *image, shear_error *err) {
    const shear_mock_spec *s = &m->spec;
    CLEANUP(painter_deinit) painter p = {0};
    if (!painter_init(&p, s->psf, s->r_psf_px, s->nx, s->ny))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for painting points");
    painter_rotate(&p, shear_mock_psf_angle(m, psf));
    for (int k = 0; k < n; k++)
        painter_point(&p, amplitude, x[k], y[k]);
    painter_finish(&p, image);
    return SHEAR_OK;
}
