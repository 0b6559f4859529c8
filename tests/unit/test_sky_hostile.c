/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Headers with changes at random: a clear error or no map, or a map whose numbers are NaN or sound,
 * and which leads back to where it came from. */
#include "sky_fixture.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 20000 };

static uint64_t state_of_random = 1;

static uint64_t draw(void) {
    state_of_random = state_of_random * 6364136223846793005u + 1442695040888963407u;
    return state_of_random >> 33;
}

static const char *pick(const char *const *words, size_t n) {
    return words[draw() % n];
}

/* Give a keyword of the header, or another one, a value that nobody wrote. */
static void change_value(sky_header *h) {
    static const char *const values[] = {
        "NaN",  "1E300", "-1E300", "0",     "1E-300", "1E15", "-90",  "90.0000001", "180",
        "'x'",  "T",     "",       "1E308", "2.5D1",  "-0.0", "1E-9", "999999999",  "'RA---TAB'",
        "1E20", "-1",    "0.5",    "1E-4",  "3",      "9",    "1E6",  "'DEC--TPV'", "'RA---ZPN'"};
    static const char *const keys[] = {
        "PV1_0",   "PV1_1",  "PV1_3",  "PV2_1",   "PV1_39",  "PV2_20",  "PV1_4",  "PV2_7",
        "A_ORDER", "A_9_0",  "B_0_0",  "A_5_4",   "LONPOLE", "LATPOLE", "CDELT1", "CROTA2",
        "PC1_2",   "CTYPE1", "CTYPE2", "CD1_1",   "CD2_1",   "CRVAL2",  "CRPIX1", "WAT1_001",
        "CPDIS1",  "CUNIT2", "NAXIS",  "WCSAXES", "CD001001"};
    char key[9] = "", card[200];
    memcpy(key, h->cards[draw() % (uint64_t)h->n], 8);
    snprintf(card, sizeof card, "%-8s= %s",
             draw() % 2 == 0 ? key : pick(keys, sizeof keys / sizeof *keys),
             pick(values, sizeof values / sizeof *values));
    sky_header_set(h, card);
}

static void change(sky_header *h) {
    char *const card = h->cards[draw() % (uint64_t)h->n];
    switch (draw() % 8) {
    case 0:
        card[draw() % 80] = (char)draw();
        break;
    case 1: /* a digit of the value */
        card[10 + draw() % 20] = "0123456789.E+-"[draw() % 14];
        break;
    case 2:
        if (h->n < SKY_FIXTURE_CARDS)
            memcpy(h->cards[h->n++], card, 80);
        break;
    case 3:
        memcpy(card, h->cards[draw() % (uint64_t)h->n], 80);
        break;
    default:
        change_value(h);
    }
}

/* Positions over the chip and far from it. */
static void use(sky_map *map) {
    enum { N = 8 };
    const double x[N] = {1.0, 2000.0, 1.0, 1300.5, 1e5, -1e8, NAN, 1e300};
    const double y[N] = {1.0, 4000.0, 4000.0, 1700.25, 5.0, 1e8, 1.0, -1e300};
    double ra[N], dec[N], xx[N], yy[N], a[N], d[N], j[4];
    sky_map_to_sky(map, N, x, y, ra, dec);
    sky_map_to_pixel(map, N, ra, dec, xx, yy);
    sky_map_to_sky(map, N, xx, yy, a, d);
    for (int i = 0; i < N; i++) {
        assert_true(isnan(ra[i]) == isnan(dec[i]) && isnan(xx[i]) == isnan(yy[i]));
        assert_false(isnan(ra[i]) && !isnan(xx[i]));
        assert_true(isnan(ra[i]) || (ra[i] >= 0.0 && ra[i] <= 360.0 && fabs(dec[i]) <= 90.0));
        if (!isnan(xx[i]))
            assert_true(sky_distance(ra[i], dec[i], a[i], d[i]) < 1.1e-8);
        if (sky_map_jacobian(map, x[i], y[i], j))
            assert_true(isfinite(j[0]) && isfinite(j[1]) && isfinite(j[2]) && isfinite(j[3]));
    }
}

static void changed_headers(void **state) {
    (void)state;
    sky_header good[4] = {sky_header_make("TAN"), sky_header_make("TPV"),
                          sky_header_make("TAN-SIP"), sky_header_make("TNX")};
    sky_header_add_tpv(&good[1]);
    sky_header_add_sip(&good[2]);
    sky_header_set(&good[3],
                   "WAT1_001= 'wtype=tnx lngcor = \"3. 2. 2. 1. -1 1 -1 1 1e-3 1e-4 2e-4 1e-3\"'");
    sky_header_set(&good[3],
                   "WAT2_001= 'wtype=tnx latcor = \"1. 3. 2. 2. -1 1 -1 1 1e-3 0 2e-4 1e-3 0\"'");
    int maps = 0, refused = 0;
    for (int round = 0; round < ROUNDS; round++) {
        sky_header h = good[round % 4];
        for (uint64_t n = 1 + draw() % 4; n > 0; n--)
            change(&h);
        shear_error err = {0};
        sky_map *map = NULL;
        const int code = sky_map_new(&map, h.cards[0], h.n, "file 'f'", &err);
        assert_true(code == SHEAR_OK || (code == SHEAR_E_FORMAT && map == NULL));
        assert_true(code == SHEAR_OK || strncmp(err.message, "file 'f': ", 10) == 0);
        refused += code != SHEAR_OK;
        if (map == NULL)
            continue;
        maps++;
        use(map);
        sky_map_free(map);
    }
    assert_true(maps > ROUNDS / 10 && refused > ROUNDS / 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(changed_headers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
