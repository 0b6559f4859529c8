/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/chip_survey.h"

#include "base/cleanup.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

CLEANUP_DEFINE(shear_workspace, shear_workspace_free)
CLEANUP_DEFINE(shear_block, shear_block_free)

/* ---- which chip ---- */

static int no_such_chip(const shear_field *field, const char *name, shear_error *err) {
    char names[160] = "";
    const int n = shear_field_chips(field);
    for (int i = 0; i < n && i < 8; i++) {
        shear_chip c;
        TRY(shear_field_get_chip(field, i, &c, err));
        if (c.name[0] != '\0')
            text_append_item(names, sizeof names, c.name);
    }
    char advice[240];
    snprintf(advice, sizeof advice, "give a number from 1 to %d%s%s%s", n,
             names[0] != '\0' ? ", or an EXTNAME: " : "", names, n > 8 ? ", ..." : "");
    return shear_fail(err, SHEAR_E_SETTING, advice, "there is no chip '%s'", name);
}

int chip_survey_find(const shear_field *field, const char *name, int *chip, shear_error *err) {
    int64_t number = 0;
    const int n = shear_field_chips(field);
    *chip = 0;
    for (int i = 0; i < n && name != NULL; i++) {
        shear_chip c;
        TRY(shear_field_get_chip(field, i, &c, err));
        if (strcasecmp(c.name, name) == 0) {
            *chip = i;
            return SHEAR_OK;
        }
    }
    if (name == NULL)
        return SHEAR_OK;
    if (!text_to_int64(name, &number) || number < 1 || number > n)
        return no_such_chip(field, name, err);
    *chip = (int)number - 1;
    return SHEAR_OK;
}

/* ---- pixels ---- */

/* A row of the picture in the making. */
typedef struct band {
    double *value, *sum;
    uint8_t *defect;
    int *good;
} band;

static void band_deinit(band *b) {
    free(b->value);
    free(b->sum);
    free(b->defect);
    free(b->good);
}

static bool band_init(band *b, const chip_survey *s) {
    const size_t n = (size_t)s->bin * (size_t)s->chip.nx;
    *b = (band){.value = calloc(n, sizeof *b->value),
                .sum = calloc((size_t)s->nx, sizeof *b->sum),
                .defect = calloc(n, sizeof *b->defect),
                .good = calloc((size_t)s->nx, sizeof *b->good)};
    return b->value != NULL && b->sum != NULL && b->defect != NULL && b->good != NULL;
}

/* Write one row of the picture from `rows` rows of the chip. A bad column is to be seen: pixels are
 * bad that have as many bad ones. Return the number of bad pixels of the chip. */
static int64_t bin_rows(const chip_survey *s, band *b, int rows, double *out) {
    int64_t bad = 0;
    memset(b->sum, 0, (size_t)s->nx * sizeof *b->sum);
    memset(b->good, 0, (size_t)s->nx * sizeof *b->good);
    for (int j = 0; j < rows; j++) {
        for (int i = 0; i < s->chip.nx; i++) {
            const size_t k = (size_t)j * (size_t)s->chip.nx + (size_t)i;
            if (b->defect[k] == 0) {
                b->sum[i / s->bin] += b->value[k];
                b->good[i / s->bin]++;
            }
        }
    }
    for (int i = 0; i < s->nx; i++) {
        const int columns = s->chip.nx - i * s->bin < s->bin ? s->chip.nx - i * s->bin : s->bin;
        const int missing = rows * columns - b->good[i];
        bad += missing;
        out[i] = missing < (rows < columns ? rows : columns) ? b->sum[i] / b->good[i] : NAN;
    }
    return bad;
}

static int read_pixels(chip_survey *s, shear_field *field, shear_error *err) {
    CLEANUP(band_deinit) band b = {0};
    int64_t bad = 0;
    s->pixels = calloc((size_t)s->nx * (size_t)s->ny, sizeof *s->pixels);
    if (s->pixels == NULL || !band_init(&b, s))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a picture");
    for (int j = 0; j < s->ny; j++) {
        const int y = j * s->bin;
        const int rows = s->chip.ny - y < s->bin ? s->chip.ny - y : s->bin;
        const shear_chip_box box = {
            .y = y, .nx = s->chip.nx, .ny = rows, .value = b.value, .defect = b.defect};
        TRY(shear_chip_read(field, s->number, &box, err));
        bad += bin_rows(s, &b, rows, s->pixels + (size_t)j * (size_t)s->nx);
    }
    s->bad = (double)bad / ((double)s->chip.nx * s->chip.ny);
    return SHEAR_OK;
}

/* ---- galaxies ---- */

/* Return the galaxy without a flag of its position that is nearest to a place; -1: none. */
static int64_t nearest(const chip_survey *s, double x, double y) {
    int64_t found = -1;
    double least = INFINITY;
    for (int64_t i = 0; i < s->chip.n_stamps; i++) {
        const shear_chip_place *p = &s->galaxies[i].place;
        const double d = hypot(p->x - x, p->y - y);
        if ((p->flags & ((unsigned)SHEAR_FLAG_NO_POSITION | (unsigned)SHEAR_FLAG_PSF_UNUSABLE)) ==
                0 &&
            d < least) {
            least = d;
            found = i;
        }
    }
    return found;
}

static int look_at_galaxies(chip_survey *s, shear_field *field, const shear_plan *plan,
                            shear_error *err) {
    CLEANUP(shear_workspace_release) shear_workspace *ws = NULL;
    CLEANUP(shear_block_release) shear_block *block = NULL;
    s->galaxies = calloc((size_t)s->chip.n_stamps + 1, sizeof *s->galaxies);
    if (s->galaxies == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a picture");
    TRY(shear_workspace_new(&ws, plan, err));
    TRY(shear_block_new(&block, shear_field_get_info(field), 1, err));
    for (int64_t i = 0; i < s->chip.n_stamps; i++) {
        shear_row row;
        TRY(shear_chip_find(field, s->chip.first + i, &s->galaxies[i].place, err));
        TRY(shear_field_read(field, s->chip.first + i, 1, block, err));
        TRY(shear_examine(plan, ws, &block->stamps, 0, &row, err));
        s->galaxies[i].flags = row.flags;
    }
    for (int k = 0; k < 4; k++)
        s->jacobian[k] = NAN;
    const int64_t middle = nearest(s, 0.5 * s->chip.nx, 0.5 * s->chip.ny);
    if (middle < 0 || block->jacobian == NULL)
        return SHEAR_OK;
    TRY(shear_field_read(field, s->chip.first + middle, 1, block, err));
    memcpy(s->jacobian, block->jacobian, sizeof s->jacobian);
    return SHEAR_OK;
}

/* ---- the PSF ---- */

/* Describe the ellipse of p->cov. Return false if there is none. */
static bool describe_psf(chip_psf *p) {
    static const double fwhm_of_sigma = 2.3548200450309493;
    const double *c = p->cov;
    const double trace = c[0] + c[2];
    const double length = hypot(c[0] - c[2], 2.0 * c[1]);
    const double a = sqrt(0.5 * (trace + length));
    const double b = sqrt(0.5 * (trace - length));
    p->e = (a - b) / (a + b);
    p->e1 = length > 0.0 ? p->e * (c[0] - c[2]) / length : 0.0;
    p->e2 = length > 0.0 ? p->e * 2.0 * c[1] / length : 0.0;
    p->fwhm = fwhm_of_sigma * sqrt(a * b);
    return isfinite(p->fwhm);
}

static bool is_known(const chip_survey *s, const chip_psf *p) {
    for (int i = 0; i < s->n_psfs; i++) {
        if (s->psfs[i].x == p->x && s->psfs[i].y == p->y)
            return true;
    }
    return false;
}

/* Add the PSF of the galaxy that is nearest to a place, unless it is there already. */
static int add_psf(chip_survey *s, const shear_field *field, double x, double y, shear_error *err) {
    const int64_t i = nearest(s, x, y);
    if (i < 0)
        return SHEAR_OK;
    chip_psf p = {.x = s->galaxies[i].place.x, .y = s->galaxies[i].place.y};
    TRY(shear_chip_psf(field, s->chip.first + i, p.cov, err));
    if (describe_psf(&p) && !is_known(s, &p))
        s->psfs[s->n_psfs++] = p;
    return SHEAR_OK;
}

/* Take PSFs on a square grid. */
static int look_at_psf(chip_survey *s, const shear_field *field, shear_error *err) {
    const double longer = fmax(s->chip.nx, s->chip.ny);
    const int columns = (int)fmax(1.0, round(CHIP_PSFS * s->chip.nx / longer));
    const int rows = (int)fmax(1.0, round(CHIP_PSFS * s->chip.ny / longer));
    for (int j = 0; j < rows; j++) {
        for (int i = 0; i < columns; i++) {
            TRY(add_psf(s, field, (i + 0.5) / columns * s->chip.nx, (j + 0.5) / rows * s->chip.ny,
                        err));
        }
    }
    return SHEAR_OK;
}

int chip_survey_init(chip_survey *s, shear_field *field, int chip, const shear_plan *plan,
                     shear_error *err) {
    *s = (chip_survey){.number = chip};
    TRY(shear_field_get_chip(field, chip, &s->chip, err));
    const int longer = s->chip.nx > s->chip.ny ? s->chip.nx : s->chip.ny;
    s->bin = (longer + CHIP_SIDE - 1) / CHIP_SIDE;
    s->nx = (s->chip.nx + s->bin - 1) / s->bin;
    s->ny = (s->chip.ny + s->bin - 1) / s->bin;
    TRY(read_pixels(s, field, err));
    TRY(look_at_galaxies(s, field, plan, err));
    return look_at_psf(s, field, err);
}

void chip_survey_deinit(chip_survey *s) {
    free(s->pixels);
    free(s->galaxies);
    *s = (chip_survey){0};
}
