/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "options.h"

#include "base/cleanup.h"
#include "base/spelling.h"
#include "base/text.h"
#include "value.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const galaxy_names[] = {"regular", "irregular", NULL};
static const char *const psf_names[] = {"a", "b", NULL};
static const char *const layout_names[] = {"cube", "mosaic", NULL};

#define AT(member) offsetof(shear_mock_spec, member)
#define ROW(name, type, member, min, max, metavar, help)                                           \
    { name, AT(member), NULL, min, max, metavar, help, SHEAR_MOCK_T_##type, false }
#define ROW_AUTO(name, type, member, min, max, metavar, help)                                      \
    { name, AT(member), NULL, min, max, metavar, help, SHEAR_MOCK_T_##type, true }
#define CHOICE(name, member, choices, metavar, help)                                               \
    { name, AT(member), choices, 0, 0, metavar, help, SHEAR_MOCK_T_CHOICE, false }
#define SWITCH(name, type, member, help) ROW(name, type, member, 0, 0, NULL, help)

static const shear_mock_option table[] = {
    ROW("stamps", COUNT, n_stamps, 1, 1e9, "N", "stamp pairs"),
    ROW("size", SIZE, nx, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE, "NX[xNY]", "pixels of a stamp"),
    ROW("seed", SEED, seed, 0, 0, "S", "same seed: same galaxies and noise, at any shear"),
    ROW("shear", PAIR, g1, -0.99, 0.99, "G1,G2", "the true shear"),
    ROW("rotate", INT, rotate, 1, 4, "1|2|4",
        "each galaxy at 0, at 0 and 90, or at 0, 45, 90 and 135 degrees, in neighbouring stamps"),
    SWITCH("no-shift", OFF, shift, "no random sub-pixel position of the galaxies"),
    ROW("offset", PAIR, offset_x, -512, 512, "DX,DY", "move every galaxy by this much, px"),
    SWITCH("share-shift", ON, share_shift,
           "the rotated copies of a galaxy have the same sub-pixel position"),
    SWITCH("share-noise", ON, share_noise, "the rotated copies of a galaxy have the same noise"),
    SWITCH(
        "turn-stamps", ON, turn_stamps,
        "copies at 90 degrees are whole stamps turned, position and noise too, under the same PSF"),
    CHOICE("galaxy", galaxy, galaxy_names, "regular|irregular", "disk and bulge, or random walk"),
    ROW("r-gal", DOUBLE, r_gal_px, 0.01, 512, "PX", "radius R_G at which galaxies are cut"),
    ROW("points", INT, points, 1, 1e6, "N", "points of a regular galaxy"),
    ROW("bulge-fraction", DOUBLE, bulge_fraction, 0, 100, "X",
        "f_b/d, central brightness of the bulge over the disk's"),
    ROW("disk-scale", DOUBLE, disk_scale, 0.05, 1000, "X", "r_disk / R_G"),
    ROW("bulge-ratio", DOUBLE, bulge_ratio, 0.01, 100, "X", "r_disk / r_bulge"),
    ROW("inclination", PAIR, inclination_min_deg, 0, 90, "MIN,MAX",
        "range of the regular galaxies' inclinations, degrees"),
    ROW("steps", INT, steps, 1, 1e6, "N", "steps of an irregular galaxy"),
    ROW("step-size", DOUBLE, step_px, 1e-3, 512, "PX", "length of a step"),
    CHOICE("psf", psf, psf_names, "a|b", "PSF form: a, or b with diffraction spikes"),
    ROW("r-psf", DOUBLE, r_psf_px, 0.1, 100, "PX", "scale radius of the PSF"),
    ROW("psf-angle", DOUBLE, psf_angle_deg, -360, 360, "DEG", "turns the PSF from x towards y"),
    ROW("oversamp", INT, oversample, 1, SHEAR_MAX_PSF_OVERSAMPLE, "K",
        "samples of the PSF image per pixel"),
    ROW_AUTO("psf-size", INT, psf_size, SHEAR_MIN_PSF_SIDE, SHEAR_MAX_PSF_SIDE, "N",
             "samples per side of the PSF image (auto: all above 1e-20 of the peak)"),
    SWITCH("psf-per-stamp", ON, psf_per_stamp, "every stamp has its own PSF, at a random angle"),
    ROW("psf-ids", INT, psf_ids, 0, 1e6, "K",
        "K PSFs at random angles, told apart by PSF_ID (0: one)"),
    ROW("noise-stamps", INT, noise_stamps, 1, SHEAR_MAX_NOISE_PLANES, "N",
        "noise stamps per galaxy"),
    ROW("noise-ratio", DOUBLE, noise_ratio, 0, 1e6, "X",
        "astronomical noise: I_N/I_G, its mean flux density over the galaxy's (0: none)"),
    ROW_AUTO("noise-density", DOUBLE, noise_density, 1e-9, 1e4, "N",
             "its point sources per square pixel (auto: 1/R_PSF^2)"),
    ROW("white", DOUBLE, white_sigma, 0, 1e12, "SIGMA",
        "white Gaussian noise per pixel, in units of a point's peak or in photons (0: none)"),
    ROW("photons", DOUBLE, photons, 0, 1e8, "N",
        "photon counting: mean number of background photons per pixel (0: none)"),
    ROW("photon-snr", DOUBLE, photon_snr, 1e-9, 1e6, "X",
        "mean surface brightness of the galaxy over that of the background"),
    SWITCH("subtract-background", ON, subtract_background,
           "take the mean background off the photon counts"),
    ROW("field", TEXT, field, 0, 0, "NAME", "the field's name (none: the file's)"),
    CHOICE("layout", layout, layout_names, "cube|mosaic", "of the stamps in the file"),
    ROW("bitpix", INT, bitpix, -64, -32, "-32|-64", "pixel type: float or double"),
    SWITCH("no-r-gal", OFF, write_r_gal, "leave R_GAL out of the catalog"),
};

enum { N_OPTIONS = sizeof table / sizeof *table };

const shear_mock_option *shear_mock_options(size_t *n) {
    *n = N_OPTIONS;
    return table;
}

const shear_mock_option *shear_mock_option_find(const char *name) {
    for (size_t i = 0; i < N_OPTIONS; i++) {
        if (strcmp(table[i].name, name) == 0)
            return &table[i];
    }
    return NULL;
}

static const void *member(const shear_mock_spec *s, const shear_mock_option *o) {
    return (const char *)s + o->offset;
}

/* A type's numbers (none: it has no range), the mark between two of them, and the words for them.
 */
typedef struct option_type {
    int numbers;
    char mark;
    const char *expected;
} option_type;

static const option_type types[] = {
    [SHEAR_MOCK_T_INT] = {1, '\0', "a whole number"},
    [SHEAR_MOCK_T_COUNT] = {1, '\0', "a whole number"},
    [SHEAR_MOCK_T_SEED] = {0, '\0', "a whole number from 0 to 18446744073709551615"},
    [SHEAR_MOCK_T_DOUBLE] = {1, '\0', "a number"},
    [SHEAR_MOCK_T_PAIR] = {2, ',', "two numbers with a comma between"},
    [SHEAR_MOCK_T_SIZE] = {2, 'x', "one whole number, or two with an x between"},
    [SHEAR_MOCK_T_CHOICE] = {0, '\0', NULL}, /* the option's metavar */
    [SHEAR_MOCK_T_ON] = {0, '\0', "yes or no"},
    [SHEAR_MOCK_T_OFF] = {0, '\0', "yes or no"},
    [SHEAR_MOCK_T_TEXT] = {0, '\0', "at most 68 printable ASCII characters"},
};

static bool is_whole(const shear_mock_option *o) {
    return o->type == SHEAR_MOCK_T_INT || o->type == SHEAR_MOCK_T_SIZE;
}

/* Return number i of the option. */
static double number(const shear_mock_spec *s, const shear_mock_option *o, int i) {
    const void *m = member(s, o);
    if (o->type == SHEAR_MOCK_T_COUNT)
        return (double)*(const int64_t *)m;
    return is_whole(o) ? ((const int *)m)[i] : ((const double *)m)[i];
}

static bool is_auto(const shear_mock_spec *s, const shear_mock_option *o) {
    return o->has_auto && (is_whole(o) ? number(s, o, 0) == 0.0 : isnan(number(s, o, 0)));
}

static int check_choice(const shear_mock_spec *s, const shear_mock_option *o, shear_error *err) {
    int value = *(const int *)member(s, o);
    int n = 0;
    while (o->choices[n] != NULL)
        n++;
    if (value < 0 || value >= n) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "mock option '%s': %d is not one of %s",
                          o->name, value, o->metavar);
    }
    return SHEAR_OK;
}

static int check_range(const shear_mock_spec *s, const shear_mock_option *o, shear_error *err) {
    if (o->type == SHEAR_MOCK_T_CHOICE)
        return check_choice(s, o, err);
    for (int i = 0; i < types[o->type].numbers && !is_auto(s, o); i++) {
        const double v = number(s, o, i);
        if (!(v >= o->min && v <= o->max)) {
            return shear_fail(err, SHEAR_E_SETTING, NULL,
                              "mock option '%s': %.10g is not in the range from %g to %g%s",
                              o->name, v, o->min, o->max, o->has_auto ? ", or auto" : "");
        }
    }
    return SHEAR_OK;
}

int options_check_ranges(const shear_mock_spec *s, shear_error *err) {
    for (size_t i = 0; i < N_OPTIONS; i++)
        TRY(check_range(s, &table[i], err));
    return SHEAR_OK;
}

static bool parse_number(const shear_mock_option *o, const char *text, void *m, int i) {
    return is_whole(o) ? value_int(text, (int *)m + i) : value_double(text, (double *)m + i);
}

/* Parse two numbers; one size is that of both sides. */
static bool parse_two(const shear_mock_option *o, const char *text, void *m) {
    char first[64];
    const bool fits = text_set(first, sizeof first, text);
    char *mark = strchr(first, types[o->type].mark);
    const char *second = mark != NULL ? mark + 1 : is_whole(o) ? first : "";
    if (mark != NULL)
        *mark = '\0';
    return fits && parse_number(o, first, m, 0) && parse_number(o, second, m, 1);
}

/* Parse `text` into the member(s) of *s. Returns false if it is not of the option's type. */
static bool parse(shear_mock_spec *s, const shear_mock_option *o, const char *text) {
    void *m = (char *)s + o->offset;
    bool yes = false;
    switch (o->type) {
    case SHEAR_MOCK_T_INT:
        *(int *)m = 0;
        break;
    case SHEAR_MOCK_T_DOUBLE:
        *(double *)m = NAN;
        break;
    case SHEAR_MOCK_T_COUNT:
        return value_int64(text, m);
    case SHEAR_MOCK_T_SEED:
        return value_uint64(text, m);
    case SHEAR_MOCK_T_CHOICE:
        *(int *)m = spelling_find(o->choices, text);
        return *(int *)m >= 0;
    case SHEAR_MOCK_T_TEXT:
        return value_copy(text, m, sizeof s->field);
    case SHEAR_MOCK_T_PAIR:
    case SHEAR_MOCK_T_SIZE:
        return parse_two(o, text, m);
    default:
        if (!value_bool(text, &yes))
            return false;
        *(bool *)m = (o->type == SHEAR_MOCK_T_ON) == yes;
        return true;
    }
    return (o->has_auto && strcmp(text, "auto") == 0) || parse_number(o, text, m, 0);
}

int shear_mock_set(shear_mock_spec *s, const char *name, const char *text, shear_error *err) {
    const shear_mock_option *o = shear_mock_option_find(name);
    if (o == NULL) {
        return shear_fail(err, SHEAR_E_SETTING, "\"shearctl help mock\" lists the options",
                          "there is no mock option '%s'", name);
    }
    bool is_switch = o->type == SHEAR_MOCK_T_ON || o->type == SHEAR_MOCK_T_OFF;
    const char *value = text != NULL ? text : is_switch ? "yes" : "";
    shear_mock_spec changed = *s;
    if (!parse(&changed, o, value)) {
        return shear_fail(err, SHEAR_E_SETTING, NULL, "mock option '%s': \"%s\" is not %s%s",
                          o->name, value,
                          o->type == SHEAR_MOCK_T_CHOICE ? o->metavar : types[o->type].expected,
                          o->has_auto ? ", or auto" : "");
    }
    TRY(check_range(&changed, o, err));
    *s = changed;
    return SHEAR_OK;
}

char *shear_mock_format(const shear_mock_spec *s, const shear_mock_option *o, char *buf,
                        size_t size) {
    const void *m = member(s, o);
    char first[32];
    char second[32];
    if (o->type == SHEAR_MOCK_T_SEED) {
        snprintf(buf, size, "%" PRIu64, *(const uint64_t *)m);
    } else if (o->type == SHEAR_MOCK_T_CHOICE) {
        text_set(buf, size, o->choices[*(const int *)m]);
    } else if (o->type == SHEAR_MOCK_T_TEXT) {
        text_set(buf, size, m);
    } else if (types[o->type].numbers == 0) {
        text_set(buf, size, *(const bool *)m == (o->type == SHEAR_MOCK_T_ON) ? "yes" : "no");
    } else if (types[o->type].numbers == 2) {
        snprintf(buf, size, "%s%c%s", value_of_double(number(s, o, 0), first), types[o->type].mark,
                 value_of_double(number(s, o, 1), second));
    } else {
        text_set(buf, size, is_auto(s, o) ? "auto" : value_of_double(number(s, o, 0), first));
    }
    return buf;
}
