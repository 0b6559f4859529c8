/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws an exposure chip by chip, and writes its four files. */
#include "shear_mocks/exposure.h"

#include "base/cleanup.h"
#include "exposure/detector.h"
#include "exposure/drawer.h"
#include "exposure/image_file.h"
#include "shear/version.h"

#include <inttypes.h>
#include <math.h>
#include <omp.h>

/* Light below this part of the noise (or of the faintest object's flux, without noise) is left
 * out. */
static const double negligible = 0.01;

enum { BAND_ROWS = 512 };
enum { IMAGE, WEIGHT, MASK, TRUTH, N_FILES };
static const char *const endings[N_FILES] = {"", ".weight", ".mask", ".truth"};

/* The exposure while it is written. */
typedef struct exposure_writer {
    const shear_mock_exposure *spec;
    focal_plane plane;
    int threads;
    double threshold; /* ADU per pixel */
    double *image;    /* [ny][nx], owned */
    uint8_t *mask;    /* [ny][nx], owned */
    buffer rows;      /* of the truth table */
    image_file files[N_FILES];
    shear_mock_exposure_counts counts;
} exposure_writer;

static void writer_deinit(exposure_writer *w) {
    for (int i = 0; i < N_FILES; i++)
        image_file_abort(&w->files[i]);
    free(w->image);
    free(w->mask);
    buffer_deinit(&w->rows);
}

static int fail_memory(const shear_mock_exposure *e, shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, "give smaller chips",
                      "out of memory for a chip of %dx%d px", e->nx, e->ny);
}

/* ---- headers ---- */
static void add_history(buffer *cards, const shear_mock_exposure *e) {
    size_t n;
    const shear_mock_option *options = shear_mock_exposure_options(&n);
    image_card_history(cards, "shear_mocks " SHEAR_VERSION_STRING);
    for (size_t i = 0; i < n; i++) {
        char value[96];
        char line[160];
        shear_mock_exposure_format(e, &options[i], value, sizeof value);
        snprintf(line, sizeof line, "mock %s = %s", options[i].name, value);
        image_card_history(cards, line);
    }
}

static void add_shear(buffer *cards, const shear_mock_exposure *e) {
    image_card_real(cards, "SIM_G1", e->g1, "true shear, x to the West");
    image_card_real(cards, "SIM_G2", e->g2, "... and y to the North");
}

/* Axis 1 is `xi`; its polynomial has x first, that of axis 2 has y first. */
static void add_distortion(buffer *cards, const focal_plane *f) {
    const double linear[2] = {1.0 + f->skew1, 1.0 - f->skew1};
    for (int axis = 0; axis < 2; axis++) {
        const double terms[] = {linear[axis], f->skew2, f->k, f->k};
        static const int numbers[] = {1, 2, 7, 9};
        for (int i = 0; i < 4; i++) {
            char key[32];
            snprintf(key, sizeof key, "PV%d_%d", axis + 1, numbers[i]);
            image_card_real(cards, key, terms[i], NULL);
        }
    }
}

static void add_coordinates(buffer *cards, const exposure_writer *w, int chip) {
    const chip_place place = focal_plane_chip(w->spec, chip);
    const focal_plane *f = &w->plane;
    const bool distorted = focal_plane_distorted(f);
    image_card_text(cards, "RADESYS", "ICRS", NULL);
    image_card_real(cards, "EQUINOX", 2000.0, NULL);
    image_card_text(cards, "CTYPE1", distorted ? "RA---TPV" : "RA---TAN", NULL);
    image_card_text(cards, "CTYPE2", distorted ? "DEC--TPV" : "DEC--TAN", NULL);
    image_card_text(cards, "CUNIT1", "deg", NULL);
    image_card_text(cards, "CUNIT2", "deg", NULL);
    image_card_real(cards, "CRVAL1", w->spec->ra_deg, NULL);
    image_card_real(cards, "CRVAL2", w->spec->dec_deg, NULL);
    image_card_real(cards, "CRPIX1", place.crpix_x, NULL);
    image_card_real(cards, "CRPIX2", place.crpix_y, NULL);
    image_card_real(cards, "CD1_1", f->cd[0], NULL);
    image_card_real(cards, "CD1_2", f->cd[1], NULL);
    image_card_real(cards, "CD2_1", f->cd[2], NULL);
    image_card_real(cards, "CD2_2", f->cd[3], NULL);
    if (distorted)
        add_distortion(cards, f);
}

static void add_detector(buffer *cards, const shear_mock_exposure *e) {
    image_card_real(cards, "GAIN", e->gain, "electrons per ADU");
    image_card_real(cards, "RDNOISE", e->read_noise, "electrons");
    image_card_real(cards, "SATURATE", e->saturation, "ADU");
    image_card_real(cards, "EXPTIME", e->exposure_time, "seconds");
}

/* ---- one chip ---- */
static void draw_band(const exposure_writer *w, const scene *s, drawer *d, const image_band *band) {
    for (int64_t i = 0; i < s->n; i++) {
        const scene_object *o = &s->objects[i];
        const psf_place psf = light_psf(w->spec, &w->plane, o->dx, o->dy);
        const light l = light_of(w->spec, o, &psf);
        drawer_place(d, &l, o->x - 1.0, o->y - 1.0, w->threshold);
        if (!drawer_touches(d, band))
            continue;
        drawer_draw(d, &l, o->x - 1.0, o->y - 1.0, w->threshold);
        drawer_add(d, band);
    }
}

/* Each band of rows is drawn by one thread, in the objects' order: the pixels do not depend on the
 * threads. Objects on a border are drawn twice. */
static bool draw_objects(exposure_writer *w, const scene *s) {
    const shear_mock_exposure *e = w->spec;
    bool failed = false;
#pragma omp parallel num_threads(w->threads) reduction(|| : failed)
    {
        CLEANUP(drawer_deinit) drawer d = {0};
        failed = !drawer_init(&d);
#pragma omp for schedule(dynamic)
        for (int first = 0; first < e->ny; first += BAND_ROWS) {
            const int end = first + BAND_ROWS < e->ny ? first + BAND_ROWS : e->ny;
            const image_band band = {w->image, e->nx, first, end};
            if (!failed)
                draw_band(w, s, &d, &band);
        }
    }
    return !failed;
}

static const image_column truth_columns[] = {
    {"NUMBER", NULL, 'J'},
    {"CHIP", NULL, 'J'},
    {"IS_STAR", NULL, 'J'},
    {"X", "pixel", 'D'},
    {"Y", "pixel", 'D'},
    {"RA", "deg", 'D'},
    {"DEC", "deg", 'D'},
    {"FLUX", "adu", 'D'},
    {"R_HALF", "arcsec", 'D'},
    {"E1", NULL, 'D'},
    {"E2", NULL, 'D'},
    {"PSF_FWHM", "pixel", 'D'},
    {"PSF_E1", NULL, 'D'},
    {"PSF_E2", NULL, 'D'},
    {"DUDX", "arcsec/pixel", 'D'},
    {"DUDY", "arcsec/pixel", 'D'},
    {"DVDX", "arcsec/pixel", 'D'},
    {"DVDY", "arcsec/pixel", 'D'},
};
enum { N_COLUMNS = sizeof truth_columns / sizeof *truth_columns, FIRST_REAL = 3 };

static void add_truth(exposure_writer *w, const scene *s, int chip) {
    for (int64_t i = 0; i < s->n; i++) {
        const scene_object *o = &s->objects[i];
        const psf_place psf = light_psf(w->spec, &w->plane, o->dx, o->dy);
        const double *j = o->sky.j;
        const double reals[N_COLUMNS - FIRST_REAL] = {
            o->x,     o->y,   o->sky.ra, o->sky.dec, o->flux, o->r_half, o->e1, o->e2,
            psf.fwhm, psf.e1, psf.e2,    j[0],       j[1],    j[2],      j[3]};
        image_row_int(&w->rows, (int32_t)(w->counts.galaxies + w->counts.stars + 1));
        image_row_int(&w->rows, chip + 1);
        image_row_int(&w->rows, o->is_star);
        for (int k = 0; k < N_COLUMNS - FIRST_REAL; k++)
            image_row_double(&w->rows, reals[k]);
        *(o->is_star ? &w->counts.stars : &w->counts.galaxies) += 1;
    }
}

static int draw_chip(exposure_writer *w, int chip, shear_error *err) {
    const shear_mock_exposure *e = w->spec;
    CLEANUP(scene_deinit) scene s = {0};
    if (!scene_init(&s, e, &w->plane, chip))
        return fail_memory(e, err);
    memset(w->image, 0, (size_t)e->nx * (size_t)e->ny * sizeof *w->image);
    if (!draw_objects(w, &s) || !detector_expose(e, chip, w->threads, w->image, w->mask))
        return fail_memory(e, err);
    add_truth(w, &s, chip);
    return SHEAR_OK;
}

/* The pixels of the weight and of the mask take the image's memory. */
static int write_chip(exposure_writer *w, int chip, shear_error *err) {
    const shear_mock_exposure *e = w->spec;
    const ptrdiff_t n = (ptrdiff_t)e->nx * e->ny;
    const double variance = detector_variance(e, 0.0);
    char name[16];
    CLEANUP(buffer_deinit) buffer cards = {0};
    snprintf(name, sizeof name, "CHIP%d", chip + 1);
    add_coordinates(&cards, w, chip);
    add_detector(&cards, e);
    TRY(image_file_add_image(&w->files[IMAGE], name, -32, e->nx, e->ny, w->image, &cards, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        w->image[i] = w->mask[i] == 0 && variance > 0.0 ? 1.0 / variance : 0.0;
        w->counts.bad_pixels += w->mask[i] != 0;
        w->counts.saturated_pixels += (w->mask[i] & DETECTOR_SATURATED) != 0;
    }
    TRY(image_file_add_image(&w->files[WEIGHT], name, -32, e->nx, e->ny, w->image, NULL, err));
    for (ptrdiff_t i = 0; i < n; i++)
        w->image[i] = w->mask[i];
    return image_file_add_image(&w->files[MASK], name, 16, e->nx, e->ny, w->image, NULL, err);
}

/* ---- the files ---- */
static int create(exposure_writer *w, const char *path, bool overwrite, shear_error *err) {
    const char *fits = strrchr(path, '.');
    const int length =
        (int)(fits != NULL && strcmp(fits, ".fits") == 0 ? (size_t)(fits - path) : strlen(path));
    for (int i = 0; i < N_FILES; i++) {
        CLEANUP(buffer_deinit) buffer cards = {0};
        char name[4096];
        if (i == IMAGE || i == TRUTH)
            add_history(&cards, w->spec);
        if (snprintf(name, sizeof name, "%.*s%s.fits", length, path, endings[i]) >=
            (int)sizeof name) {
            return shear_fail(err, SHEAR_E_IO, NULL, "the name %.60s... is too long", path);
        }
        TRY(image_file_create(&w->files[i], i == IMAGE ? path : name, overwrite, &cards, err));
    }
    return SHEAR_OK;
}

static int write_truth(exposure_writer *w, shear_error *err) {
    CLEANUP(buffer_deinit) buffer cards = {0};
    add_shear(&cards, w->spec);
    return image_file_add_table(&w->files[TRUTH], "TRUTH", truth_columns, N_COLUMNS, &w->rows,
                                &cards, err);
}

static int writer_init(exposure_writer *w, const shear_mock_exposure *e, int threads,
                       shear_error *err) {
    const size_t pixels = (size_t)e->nx * (size_t)e->ny;
    const double faintest = fmin(e->flux_min, e->star_flux_min) / 100.0;
    const double sigma = sqrt(detector_variance(e, 0.0));
    *w = (exposure_writer){.spec = e,
                           .plane = focal_plane_make(e),
                           .threads = threads > 0 ? threads : omp_get_max_threads(),
                           .threshold = negligible * (sigma > 0.0 ? sigma : faintest),
                           .image = malloc(pixels * sizeof *w->image),
                           .mask = malloc(pixels)};
    return w->image != NULL && w->mask != NULL ? SHEAR_OK : fail_memory(e, err);
}

static int write_chips(exposure_writer *w, const shear_mock_write_options *o, shear_error *err) {
    const int n = w->spec->chips_x * w->spec->chips_y;
    for (int chip = 0; chip < n; chip++) {
        TRY(draw_chip(w, chip, err));
        TRY(write_chip(w, chip, err));
        if (o->progress != NULL && o->progress(o->context, chip + 1, n) != 0) {
            return shear_fail(err, SHEAR_E_CANCELLED, NULL, "stopped after %d of %d chips",
                              chip + 1, n);
        }
    }
    return write_truth(w, err);
}

int shear_mock_exposure_write(const shear_mock_exposure *e, const char *path,
                              const shear_mock_write_options *options,
                              shear_mock_exposure_counts *counts, shear_error *err) {
    static const shear_mock_write_options defaults = {0};
    const shear_mock_write_options *o = options != NULL ? options : &defaults;
    CLEANUP(writer_deinit) exposure_writer w = {0};
    TRY(shear_mock_exposure_check(e, err));
    TRY(writer_init(&w, e, o->threads, err));
    TRY(create(&w, path, o->overwrite, err));
    TRY(write_chips(&w, o, err));
    for (int i = 0; i < N_FILES; i++)
        TRY(image_file_finish(&w.files[i], err));
    if (counts != NULL)
        *counts = w.counts;
    return SHEAR_OK;
}
