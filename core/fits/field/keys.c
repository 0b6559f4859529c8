/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read the keywords of the primary header, in the file that holds the galaxies. */
#include "base/cleanup.h"
#include "fits/field/internal.h"
#include "fits/field/name.h"
#include "fits/io/source.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Return the name without blanks around it: trailing blanks mean nothing in FITS. */
static char *trim(char *text) {
    text += strspn(text, " ");
    for (size_t n = strlen(text); n > 0 && text[n - 1] == ' '; n--)
        text[n - 1] = '\0';
    return text;
}

static int read_name(shear_field *f, const sf_cards *primary, shear_error *err) {
    const sf_file *galaxy = f->parts.of[SHEAR_PART_GALAXY].file;
    CLEANUP(release_free) char *text = NULL;
    TRY(sf_key_string(primary, "FIELD", &text, err));
    const char *given = text == NULL ? "" : trim(text);
    if (given[0] != '\0') {
        return sf_field_name_copy(f->info.name, given, SHEAR_E_FORMAT, primary->at, "keyword FIELD",
                                  err);
    }
    /* A file name need not be a valid field name; shear_field_need_name() reports that, if the name
     * is needed. */
    char base[sizeof galaxy->source.base];
    sf_field_name_default(base, sizeof base, galaxy->source.base);
    if (sf_field_name_copy(f->info.name, base, SHEAR_E_FORMAT, primary->at, "from the file's name",
                           NULL) != SHEAR_OK) {
        f->info.name[0] = '\0';
    }
    return SHEAR_OK;
}

static int read_pixscale(shear_field *f, const sf_cards *primary, shear_error *err) {
    double *pixscale = &f->info.pixscale;
    *pixscale = NAN;
    TRY(sf_key_double(primary, "PIXSCALE", pixscale, err));
    return !(*pixscale <= 0.0)
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_FORMAT, primary->at, "give arcseconds per pixel",
                         "keyword PIXSCALE is %g, but must be positive", *pixscale);
}

static int read_shear(const sf_cards *primary, const char *key, double *g, shear_error *err) {
    *g = NAN;
    TRY(sf_key_double(primary, key, g, err));
    return !(fabs(*g) >= 1.0)
               ? SHEAR_OK
               : sf_fail(err, SHEAR_E_FORMAT, primary->at, NULL,
                         "keyword %s is %g, but a shear lies between -1 and 1", key, *g);
}

int sf_field_read_keys(shear_field *f, const sf_cards *primary, shear_error *err) {
    TRY(read_name(f, primary, err));
    TRY(read_pixscale(f, primary, err));
    TRY(read_shear(primary, "SIM_G1", &f->info.sim_g1, err));
    TRY(read_shear(primary, "SIM_G2", &f->info.sim_g2, err));
    f->info.has_truth = !isnan(f->info.sim_g1) && !isnan(f->info.sim_g2);
    return SHEAR_OK;
}

int shear_field_need_name(const shear_field_info *info, const char *path, shear_error *err) {
    if (info->name[0] != '\0')
        return SHEAR_OK;
    char shown[161];
    char base[256];
    char unused[sizeof info->name];
    const char *slash = strrchr(path, '/');
    sf_printable_name(shown, sizeof shown, path);
    sf_field_name_default(base, sizeof base, slash != NULL ? slash + 1 : path);
    const sf_place at = {shown, "primary"};
    TRY(sf_field_name_copy(unused, base, SHEAR_E_FORMAT, at, "from the file's name", err));
    return sf_fail(err, SHEAR_E_FORMAT, at, "give the keyword FIELD in the primary header",
                   "the field has no name");
}
