/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_keywords.h"

#include "base/cleanup.h"
#include "fits/io/status.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* Parse one or two digits without a leading zero at *text, and move it behind them. Return -1 if
 * there are none. */
static int digits(const char **text) {
    const char *c = *text;
    int n = 0, value = 0;
    for (; n < 2 && c[n] >= '0' && c[n] <= '9'; n++)
        value = 10 * value + (c[n] - '0');
    *text = c + n;
    return n == 0 || (n == 2 && c[0] == '0') ? -1 : value;
}

/* Return whether `key` is root, number, '_', number. */
static bool is_pair(const char *key, const char *root, int *i, int *j) {
    const size_t n = strlen(root);
    if (strncmp(key, root, n) != 0)
        return false;
    const char *c = key + n;
    *i = digits(&c);
    if (*i < 0 || *c++ != '_')
        return false;
    *j = digits(&c);
    return *j >= 0 && *c == '\0';
}

/* The same for an element of a 2 x 2 matrix, CD1_2 or, as it was once written, CD001002. */
static bool is_element(const char *key, const char *root, int *i, int *j) {
    if (is_pair(key, root, i, j))
        return *i >= 1 && *i <= 2 && *j >= 1 && *j <= 2;
    if (strncmp(key, root, 2) != 0 || strlen(key) != SF_KEY || memcmp(key + 2, "00", 2) != 0 ||
        memcmp(key + 5, "00", 2) != 0) {
        return false;
    }
    *i = key[4] - '0';
    *j = key[7] - '0';
    return *i >= 1 && *i <= 2 && *j >= 1 && *j <= 2;
}

/* Return where the number of a keyword is kept, or NULL if it is not one of those with numbers. */
static double *place_of(sky_keywords *k, const char *key) {
    const struct {
        const char *root;
        double *values; /* [2] */
    } vectors[] = {
        {"CRVAL", k->crval}, {"CRPIX", k->crpix}, {"CDELT", k->cdelt}, {"CROTA", k->crota}};
    for (size_t v = 0; v < sizeof vectors / sizeof *vectors; v++) {
        const int axis = sf_card_index(key, vectors[v].root);
        if (axis == 1 || axis == 2)
            return &vectors[v].values[axis - 1];
    }
    int i = 0, j = 0;
    if (is_element(key, "CD", &i, &j))
        return &k->cd[i - 1][j - 1];
    if (is_element(key, "PC", &i, &j))
        return &k->pc[i - 1][j - 1];
    if (is_pair(key, "PV", &i, &j) && (i == 1 || i == 2) && j < SKY_PV)
        return &k->pv[i - 1][j];
    if (is_pair(key, "A_", &i, &j) && i < SKY_POWERS && j < SKY_POWERS)
        return &k->sip[0][i][j];
    if (is_pair(key, "B_", &i, &j) && i < SKY_POWERS && j < SKY_POWERS)
        return &k->sip[1][i][j];
    if (strcmp(key, "A_ORDER") == 0)
        return &k->sip_order[0];
    if (strcmp(key, "B_ORDER") == 0)
        return &k->sip_order[1];
    if (strcmp(key, "EQUINOX") == 0)
        return &k->equinox;
    if (strcmp(key, "LONPOLE") == 0)
        return &k->lonpole;
    return strcmp(key, "LATPOLE") == 0 ? &k->latpole : NULL;
}

bool sky_keywords_has(const char card[SF_CARD]) {
    static const char *const names[] = {"LONPOLE", "LATPOLE",  "WCSAXES", "RADESYS", "RADECSYS",
                                        "EQUINOX", "EPOCH",    "A_DMAX",  "B_DMAX",  "A_ORDER",
                                        "B_ORDER", "AP_ORDER", "BP_ORDER"};
    static const char *const vectors[] = {"CTYPE",   "CUNIT", "CRVAL", "CRPIX", "CDELT",
                                          "CROTA",   "CPDIS", "CQDIS", "CPERR", "CQERR",
                                          "D2IMDIS", "DP",    "DQ"};
    static const char *const pairs[] = {"CD", "PC", "PV", "A_", "B_", "AP_", "BP_"};
    char key[SF_KEY + 1];
    int i = 0, j = 0;
    sf_card_key(card, key);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        if (strcmp(key, names[n]) == 0)
            return true;
    }
    for (size_t n = 0; n < sizeof vectors / sizeof *vectors; n++) {
        if (sf_card_index(key, vectors[n]) > 0)
            return true;
    }
    for (size_t n = 0; n < sizeof pairs / sizeof *pairs; n++) {
        if (is_pair(key, pairs[n], &i, &j))
            return true;
    }
    return is_element(key, "CD", &i, &j) || is_element(key, "PC", &i, &j) ||
           strncmp(key, "WAT", 3) == 0;
}

static void fill_nan(double *values, size_t n) {
    for (size_t i = 0; i < n; i++)
        values[i] = NAN;
}

static void clear(sky_keywords *k) {
    *k = (sky_keywords){.lonpole = NAN, .latpole = NAN, .equinox = NAN};
    fill_nan(k->crval, 2);
    fill_nan(k->crpix, 2);
    fill_nan(k->cdelt, 2);
    fill_nan(k->crota, 2);
    fill_nan(&k->cd[0][0], sizeof k->cd / sizeof(double));
    fill_nan(&k->pc[0][0], sizeof k->pc / sizeof(double));
    fill_nan(&k->pv[0][0], sizeof k->pv / sizeof(double));
    fill_nan(&k->sip[0][0][0], sizeof k->sip / sizeof(double));
    fill_nan(k->sip_order, 2);
}

static int fail_twice(const char *key, const char *where, shear_error *err) {
    return shear_fail(err, SHEAR_E_FORMAT, "leave one of them out",
                      "%s: keyword %s is given twice, with different values", where, key);
}

static int read_type(sky_keywords *k, const char *card, const char *where, shear_error *err) {
    char key[SF_KEY + 1], text[SF_CARD] = "";
    sf_card_key(card, key);
    const int axis = sf_card_index(key, "CTYPE");
    if ((axis != 1 && axis != 2) || !sf_card_string(card, text, sizeof text) || text[0] == '\0')
        return SHEAR_OK;
    sf_make_printable(text);
    char *ctype = k->type.text[axis - 1];
    if (ctype[0] != '\0' && strcmp(ctype, text) != 0)
        return fail_twice(key, where, err);
    memcpy(ctype, text, sizeof text);
    return SHEAR_OK;
}

static int check_unit(const char *card, const char *where, shear_error *err) {
    char key[SF_KEY + 1], text[SF_CARD] = "";
    sf_card_key(card, key);
    const int axis = sf_card_index(key, "CUNIT");
    if ((axis != 1 && axis != 2) || !sf_card_string(card, text, sizeof text) || text[0] == '\0' ||
        strncasecmp(text, "deg", 3) == 0) {
        return SHEAR_OK;
    }
    sf_make_printable(text);
    return shear_fail(err, SHEAR_E_FORMAT, "convert the coordinates to degrees",
                      "%s: keyword %s is '%.24s', but must be 'deg'", where, key, text);
}

static int read_number(sky_keywords *k, const char *card, const char *where, shear_error *err) {
    char key[SF_KEY + 1];
    double value = NAN;
    sf_card_key(card, key);
    double *const place = place_of(k, key);
    if (place == NULL || !sf_card_has_value(card))
        return SHEAR_OK;
    if (!sf_card_double(card, &value)) {
        return shear_fail(err, SHEAR_E_FORMAT, "correct the keyword, or leave it out",
                          "%s: keyword %s is not a finite number", where, key);
    }
    if (!isnan(*place) && *place != value)
        return fail_twice(key, where, err);
    *place = value;
    return SHEAR_OK;
}

/* Refuse what is not the sky of today's catalogs: RA and Dec of 1950, and where North was then. */
static int check_equinox(const sky_keywords *k, const char *where, shear_error *err) {
    return !(k->equinox < 1984.0)
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_FORMAT, "convert the coordinates to J2000 or ICRS",
                            "%s: keyword EQUINOX is %g: coordinates of 1950 (FK4) are not read",
                            where, k->equinox);
}

/* Refuse what changes positions and cannot be read. */
static int refuse_tables(const char *card, const char *where, shear_error *err) {
    char key[SF_KEY + 1];
    sf_card_key(card, key);
    int i = 0, m = 0;
    if (sf_card_index(key, "CPDIS") > 0 || sf_card_index(key, "CQDIS") > 0 ||
        sf_card_index(key, "D2IMDIS") > 0) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "fit TPV or SIP coefficients to it, or leave such keywords out",
                          "%s: keyword %s: such distortions are not read", where, key);
    }
    if (is_pair(key, "PV", &i, &m) && (i == 1 || i == 2) && m >= SKY_PV) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "%s: keyword %s: TPV coefficients end at PVi_%d", where, key, SKY_PV - 1);
    }
    return SHEAR_OK;
}

/* SCAMP, before 2012, and many headers since, write the coefficients of TPV under the name of TAN,
 * which has no parameters of its own but PV_0 to PV_4 of the axis of RA, which place the pole. */
static bool has_tpv_coefficients(const sky_keywords *k) {
    bool found = false;
    for (int i = 0; i < 2; i++) {
        for (int m = i == k->type.lng ? 5 : 0; m < SKY_PV; m++)
            found = found || (!isnan(k->pv[i][m]) && k->pv[i][m] != 0.0);
    }
    return found;
}

static int need(const double values[2], const char *root, const char *where, shear_error *err) {
    for (int i = 0; i < 2; i++) {
        if (isnan(values[i])) {
            return shear_fail(err, SHEAR_E_FORMAT,
                              "complete the header, or use --frame pixel and pixel positions",
                              "%s: keyword %s%d is missing", where, root, i + 1);
        }
    }
    return SHEAR_OK;
}

/* Positions are differences of angles: 1e9 degrees have no digits left for them. */
static int check_reference(const sky_keywords *k, const char *where, shear_error *err) {
    TRY(need(k->crval, "CRVAL", where, err));
    TRY(need(k->crpix, "CRPIX", where, err));
    for (int i = 0; i < 2; i++) {
        const double limit = i == k->type.lng ? 360.0 : 90.0;
        if (fabs(k->crval[i]) > limit) {
            return shear_fail(err, SHEAR_E_FORMAT, "correct the keyword",
                              "%s: keyword CRVAL%d is %g, but must be from %g to %g degrees", where,
                              i + 1, k->crval[i], -limit, limit);
        }
        if (fabs(k->crpix[i]) > 1e8) {
            return shear_fail(err, SHEAR_E_FORMAT, "correct the keyword",
                              "%s: keyword CRPIX%d is %g: no image is as large as that", where,
                              i + 1, k->crpix[i]);
        }
    }
    return SHEAR_OK;
}

static bool any_number(const double *values, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (!isnan(values[i]))
            return true;
    }
    return false;
}

/* Keep one form of the linear transformation: CDi_j, else PCi_j, else CROTAi. */
static int check_matrix(sky_keywords *k, const char *where, shear_error *err) {
    const bool has_cd = any_number(&k->cd[0][0], 4), has_pc = any_number(&k->pc[0][0], 4);
    if (has_cd && has_pc) {
        return shear_fail(err, SHEAR_E_FORMAT, "leave one of them out",
                          "%s: has both CDi_j and PCi_j", where);
    }
    if (has_cd || has_pc)
        fill_nan(k->crota, 2);
    if (has_cd)
        fill_nan(k->cdelt, 2);
    return has_cd ? SHEAR_OK : need(k->cdelt, "CDELT", where, err);
}

/* Check the coefficients of one axis against its order. */
static int check_sip_axis(const sky_keywords *k, int i, const char *where, shear_error *err) {
    const char letter = i == 0 ? 'A' : 'B';
    const double order = k->sip_order[i];
    if (!(order >= 0.0 && order < SKY_POWERS && order == floor(order))) {
        return shear_fail(err, SHEAR_E_FORMAT, NULL,
                          "%s: keyword %c_ORDER is missing, or is not an integer from 0 to %d",
                          where, letter, SKY_POWERS - 1);
    }
    for (int p = 0; p < SKY_POWERS; p++) {
        for (int q = 0; q < SKY_POWERS; q++) {
            const double c = k->sip[i][p][q];
            if (p + q <= (int)order || isnan(c) || c == 0.0)
                continue;
            return shear_fail(err, SHEAR_E_FORMAT, "correct the order, or leave the term out",
                              "%s: has %c_%d_%d, but %c_ORDER is %d", where, letter, p, q, letter,
                              (int)order);
        }
    }
    return SHEAR_OK;
}

/* Read the polynomials of TNX and ZPX, which are TAN and ZPN with them. */
static int read_surfaces(sky_keywords *k, const char *cards, int64_t count, const char *where,
                         shear_error *err) {
    sky_surface_text text[2] = {{""}, {""}};
    const bool zpx = strcmp(k->type.projection, "ZPX") == 0;
    bool too_long = false;
    for (int64_t n = 0; n < count && !too_long; n++)
        sky_surface_add(text, cards + n * SF_CARD, &too_long);
    for (int i = 0; i < 2; i++) {
        const char *wrong = too_long                  ? "it has too many cards"
                            : text[i].text[0] == '\0' ? "it is missing"
                                                      : sky_surface_parse(&k->surface[i], &text[i]);
        if (wrong != NULL) {
            return shear_fail(err, SHEAR_E_FORMAT, "fit TPV coefficients to it (SCAMP does)",
                              "%s: keyword WAT%d_001: %s", where, i + 1, wrong);
        }
    }
    fill_nan(&k->pv[0][0], sizeof k->pv / sizeof(double));
    if (zpx) /* both axes repeat the parameters */
        memcpy(k->pv[1 - k->type.lng], k->surface[1 - k->type.lng].projp, sizeof k->surface->projp);
    memcpy(k->type.projection, zpx ? "ZPN" : "TAN", 4);
    return SHEAR_OK;
}

/* Decide between PVi_m and SIP. */
static int choose_distortion(sky_keywords *k, const char *where, shear_error *err) {
    if (k->type.has_sip) {
        fill_nan(&k->pv[0][0], sizeof k->pv / sizeof(double));
        TRY(check_sip_axis(k, 0, where, err));
        return check_sip_axis(k, 1, where, err);
    }
    if (strcmp(k->type.projection, "TAN") != 0)
        return SHEAR_OK;
    if (has_tpv_coefficients(k)) {
        memcpy(k->type.projection, "TPV", 4);
        return SHEAR_OK;
    }
    fill_nan(k->pv[1 - k->type.lng], SKY_PV); /* zeros */
    if (!any_number(&k->sip[0][0][0], sizeof k->sip / sizeof(double)))
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_FORMAT,
                      "let CTYPE1 and CTYPE2 end in -SIP, or leave out A_p_q and B_p_q",
                      "%s: has SIP coefficients, but CTYPE1 is '%.24s'", where, k->type.text[0]);
}

int sky_keywords_read(sky_keywords *k, const char *cards, int64_t count, const char *where,
                      bool *celestial, shear_error *err) {
    clear(k);
    for (int64_t n = 0; n < count; n++) {
        const char *const card = cards + n * SF_CARD;
        if (card[0] == 'C')
            TRY(read_type(k, card, where, err));
    }
    *celestial = sky_ctype_is_angle(k->type.text[0]) || sky_ctype_is_angle(k->type.text[1]);
    if (!*celestial)
        return SHEAR_OK;
    TRY(sky_ctype_parse(&k->type, where, err));
    for (int64_t n = 0; n < count; n++) {
        const char *const card = cards + n * SF_CARD;
        if (strchr("ABCDELP", card[0]) == NULL || card[0] == '\0')
            continue;
        TRY(check_unit(card, where, err));
        TRY(refuse_tables(card, where, err));
        TRY(read_number(k, card, where, err));
    }
    TRY(check_equinox(k, where, err));
    TRY(check_reference(k, where, err));
    TRY(check_matrix(k, where, err));
    TRY(choose_distortion(k, where, err));
    const bool wat =
        strcmp(k->type.projection, "TNX") == 0 || strcmp(k->type.projection, "ZPX") == 0;
    return wat ? read_surfaces(k, cards, count, where, err) : SHEAR_OK;
}
