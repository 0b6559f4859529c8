/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_ctype.h"

#include <string.h>

bool sky_ctype_is_angle(const char *ctype) {
    static const char *const names[] = {"RA",   "DEC",  "GLON", "GLAT", "ELON",
                                        "ELAT", "SLON", "SLAT", "HLON", "HLAT"};
    const size_t n = strcspn(ctype, "-");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strlen(names[i]) == n && strncmp(ctype, names[i], n) == 0)
            return true;
    }
    return n == 4 && ctype[4] == '-' &&
           (strncmp(ctype + 2, "LN", 2) == 0 || strncmp(ctype + 2, "LT", 2) == 0);
}

/* Return whether wcslib has the projection, without tables. */
static bool is_projection(const char *code) {
    static const char *const codes[] = {"TAN", "TPV", "TNX", "ZPX", "AZP", "SZP", "STG", "SIN",
                                        "ARC", "ZPN", "ZEA", "AIR", "CYP", "CEA", "CAR", "MER",
                                        "COP", "COE", "COD", "COO", "SFL", "PAR", "MOL", "AIT",
                                        "BON", "PCO", "TSC", "CSC", "QSC", "HPX", "XPH"};
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
        if (strcmp(codes[i], code) == 0)
            return true;
    }
    return false;
}

int sky_ctype_parse(sky_ctype *t, const char *where, shear_error *err) {
    t->lng = strncmp(t->text[0], "DEC-", 4) == 0 ? 1 : 0;
    const char *const ra = t->text[t->lng], *const dec = t->text[1 - t->lng];
    if (strncmp(ra, "RA---", 5) != 0 || strncmp(dec, "DEC--", 5) != 0 ||
        strcmp(ra + 5, dec + 5) != 0 || strlen(ra) < 8) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "use coordinates such as RA---TAN and DEC--TAN, or --frame pixel",
                          "%s: CTYPE1 and CTYPE2 are '%.24s' and '%.24s', but must be RA and Dec "
                          "of one projection",
                          where, t->text[0], t->text[1]);
    }
    memcpy(t->projection, ra + 5, 3);
    t->has_sip = strcmp(ra + 8, "-SIP") == 0;
    if (!is_projection(t->projection) || (ra[8] != '\0' && !t->has_sip)) {
        return shear_fail(err, SHEAR_E_FORMAT,
                          "fit TPV or SIP coefficients to it (SCAMP does), or use --frame pixel",
                          "%s: the projection of CTYPE '%.24s' is not read", where, ra);
    }
    return SHEAR_OK;
}
