/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "options.h"

#include "base/cleanup.h"
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
    ROW("oversamp", INT, oversample, 1, 64, "K", "samples of the PSF image per pixel"),
    ROW_AUTO("psf-size", INT, psf_size, 3, 4096, "N",
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

static void *member(shear_mock_spec *s, const shear_mock_option *o) {
    return (char *)s + o->offset;
}

static const void *member_const(const shear_mock_spec *s, const shear_mock_option *o) {
    return (const char *)s + o->offset;
}

/* Store the option's numbers as doubles in v. Returns how many there are; 0 if the option has no
 * range. */
static int numbers(const shear_mock_spec *s, const shear_mock_option *o, double v[2]) {
    const void *m = member_const(s, o);
    switch (o->type) {
    case SHEAR_MOCK_T_INT:
        v[0] = *(const int *)m;
        return o->has_auto && v[0] == 0.0 ? 0 : 1;
    case SHEAR_MOCK_T_COUNT:
        v[0] = (double)*(const int64_t *)m;
        return 1;
    case SHEAR_MOCK_T_DOUBLE:
        v[0] = *(const double *)m;
        return o->has_auto && isnan(v[0]) ? 0 : 1;
    case SHEAR_MOCK_T_PAIR:
        v[0] = ((const double *)m)[0];
        v[1] = ((const double *)m)[1];
        return 2;
    case SHEAR_MOCK_T_SIZE:
        v[0] = ((const int *)m)[0];
        v[1] = ((const int *)m)[1];
        return 2;
    default:
        return 0;
    }
}

static int check_choice(const shear_mock_spec *s, const shear_mock_option *o, shear_error *err) {
    int value = *(const int *)member_const(s, o);
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
    double v[2];
    int n = numbers(s, o, v);
    for (int i = 0; i < n; i++) {
        if (!(v[i] >= o->min && v[i] <= o->max)) {
            return shear_fail(err, SHEAR_E_SETTING, NULL,
                              "mock option '%s': %.10g is not in the range from %g to %g%s",
                              o->name, v[i], o->min, o->max, o->has_auto ? ", or auto" : "");
        }
    }
    return SHEAR_OK;
}

int options_check_ranges(const shear_mock_spec *s, shear_error *err) {
    for (size_t i = 0; i < N_OPTIONS; i++)
        TRY(check_range(s, &table[i], err));
    return SHEAR_OK;
}

/* Parse `text` into the member(s) of *s. Returns false if it is not of the option's type. */
static bool parse(shear_mock_spec *s, const shear_mock_option *o, const char *text) {
    void *m = member(s, o);
    bool automatic = o->has_auto && strcmp(text, "auto") == 0;
    bool yes = false;
    switch (o->type) {
    case SHEAR_MOCK_T_INT:
        *(int *)m = 0;
        return automatic || value_int(text, m);
    case SHEAR_MOCK_T_COUNT:
        return value_int64(text, m);
    case SHEAR_MOCK_T_SEED:
        return value_uint64(text, m);
    case SHEAR_MOCK_T_DOUBLE:
        *(double *)m = NAN;
        return automatic || value_double(text, m);
    case SHEAR_MOCK_T_PAIR:
        return value_pair(text, m);
    case SHEAR_MOCK_T_SIZE:
        return value_size(text, m);
    case SHEAR_MOCK_T_CHOICE:
        return value_choice(text, o->choices, m);
    case SHEAR_MOCK_T_TEXT:
        return value_copy(text, m, sizeof s->field);
    default:
        if (!value_bool(text, &yes))
            return false;
        *(bool *)m = (o->type == SHEAR_MOCK_T_ON) == yes;
        return true;
    }
}

static const char *expected(const shear_mock_option *o) {
    static const char *const words[] = {
        [SHEAR_MOCK_T_INT] = "a whole number",
        [SHEAR_MOCK_T_COUNT] = "a whole number",
        [SHEAR_MOCK_T_SEED] = "a whole number from 0 to 18446744073709551615",
        [SHEAR_MOCK_T_DOUBLE] = "a number",
        [SHEAR_MOCK_T_PAIR] = "two numbers with a comma between",
        [SHEAR_MOCK_T_SIZE] = "one whole number, or two with an x between",
        [SHEAR_MOCK_T_ON] = "yes or no",
        [SHEAR_MOCK_T_OFF] = "yes or no",
        [SHEAR_MOCK_T_TEXT] = "at most 68 printable ASCII characters",
    };
    return o->type == SHEAR_MOCK_T_CHOICE ? o->metavar : words[o->type];
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
                          o->name, value, expected(o), o->has_auto ? ", or auto" : "");
    }
    TRY(check_range(&changed, o, err));
    *s = changed;
    return SHEAR_OK;
}

char *shear_mock_format(const shear_mock_spec *s, const shear_mock_option *o, char *buf,
                        size_t size) {
    const void *m = member_const(s, o);
    double v[2];
    char first[32];
    char second[32];
    bool automatic = o->has_auto && numbers(s, o, v) == 0;
    switch (o->type) {
    case SHEAR_MOCK_T_INT:
        snprintf(buf, size, automatic ? "auto" : "%d", *(const int *)m);
        break;
    case SHEAR_MOCK_T_COUNT:
        snprintf(buf, size, "%" PRId64, *(const int64_t *)m);
        break;
    case SHEAR_MOCK_T_SEED:
        snprintf(buf, size, "%" PRIu64, *(const uint64_t *)m);
        break;
    case SHEAR_MOCK_T_DOUBLE:
        snprintf(buf, size, "%s", automatic ? "auto" : value_of_double(*(const double *)m, first));
        break;
    case SHEAR_MOCK_T_PAIR:
        snprintf(buf, size, "%s,%s", value_of_double(((const double *)m)[0], first),
                 value_of_double(((const double *)m)[1], second));
        break;
    case SHEAR_MOCK_T_SIZE:
        snprintf(buf, size, "%dx%d", ((const int *)m)[0], ((const int *)m)[1]);
        break;
    case SHEAR_MOCK_T_CHOICE:
        snprintf(buf, size, "%s", o->choices[*(const int *)m]);
        break;
    case SHEAR_MOCK_T_TEXT:
        snprintf(buf, size, "%s", (const char *)m);
        break;
    default:
        snprintf(buf, size, "%s", *(const bool *)m == (o->type == SHEAR_MOCK_T_ON) ? "yes" : "no");
        break;
    }
    return buf;
}
