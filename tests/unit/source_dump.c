/* SPDX-License-Identifier: GPL-3.0-or-later */
/* source_dump CATALOG [SELECT]: print a catalog's sources as libshear reads them. For each table
 * "table N CHIP CARDS", then a line per source: id, x, y, r_gal, a, b, theta, selected. */
#include "survey/sources/source_list.h"

#include <stdio.h>

static double at(const double *values, int64_t i) {
    return values != NULL ? values[i] : 0.0;
}

static int dump(source_catalog *c, int table, shear_error *err) {
    source_list s;
    int64_t cards = 0;
    const int code = source_catalog_load(c, table, NULL, 0, NULL, &s, err);
    (void)source_catalog_header(c, table, &cards);
    printf("table %d %s %lld\n", table, source_catalog_chip(c, table), (long long)cards);
    for (int64_t i = 0; code == SHEAR_OK && i < s.n; i++) {
        printf("%lld %.9g %.9g %.9g %.9g %.9g %.9g %d\n", (long long)s.id[i], at(s.x, i),
               at(s.y, i), at(s.r_gal, i), at(s.a, i), at(s.b, i), at(s.theta, i), s.selected[i]);
    }
    source_list_deinit(&s);
    return code;
}

int main(int argc, char **argv) {
    if (argc < 2)
        return 2;
    source_catalog *c = NULL;
    shear_error err = {0};
    const shear_input_part part = {.path = argv[1], .hdu = -1};
    const shear_exposure exposure = {.origin = 1, .select = argc > 2 ? argv[2] : NULL};
    int code = source_catalog_open(&c, &part, -1, &exposure, &err);
    for (int i = 0; code == SHEAR_OK && i < source_catalog_tables(c); i++)
        code = dump(c, i, &err);
    source_catalog_close(c);
    if (code != SHEAR_OK)
        fprintf(stderr, "%s: %s\n", err.message, err.advice);
    return code == SHEAR_OK ? 0 : 1;
}
