/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/array.h"
#include "base/cleanup.h"
#include "base/text.h"
#include "survey/psf/internal.h"

#include <math.h>
#include <string.h>
#include <strings.h>

int psf_chip_new(psf_models *p, psf_chip **chip, shear_error *err) {
    const sf_place at = {p->file.source.name, NULL};
    *chip = NULL;
    if (p->n == PSF_CHIPS) {
        return sf_fail(err, SHEAR_E_FORMAT, at, "give the models of one exposure",
                       "has more than %d PSF models", PSF_CHIPS);
    }
    if (!ARRAY_RESERVE(p->chips, p->capacity, (size_t)p->n + 1))
        return sf_fail_memory(err, at);
    *chip = &p->chips[p->n++];
    **chip = (psf_chip){0};
    return SHEAR_OK;
}

static enum psf_quantity quantity_of(const char *name) {
    const bool image = strstr(name, "_IMAGE") != NULL;
    if (strcasecmp(name, "x") == 0 || (image && name[0] == 'X'))
        return PSF_QUANTITY_X;
    if (strcasecmp(name, "y") == 0 || (image && name[0] == 'Y'))
        return PSF_QUANTITY_Y;
    if (strcmp(name, "u") == 0)
        return PSF_QUANTITY_U;
    return strcmp(name, "v") == 0 ? PSF_QUANTITY_V : PSF_QUANTITY_CONTEXT;
}

void psf_chip_set_variable(psf_chip *c, int variable, const char *name) {
    psf_variable *v = &c->variables[variable];
    text_set(v->name, sizeof v->name, name);
    v->quantity = quantity_of(name);
}

void psf_chip_tangent(const psf_chip *c, double ra, double dec, double *u, double *v) {
    const double degree = acos(-1.0) / 180.0;
    const double a = (ra - c->ra0) * degree;
    const double d = dec * degree;
    const double d0 = c->dec0 * degree;
    const double cosine = sin(d0) * sin(d) + cos(d0) * cos(d) * cos(a);
    const double r = cosine > 0.0 ? 3600.0 / degree / cosine : NAN;
    *u = -r * cos(d) * sin(a);
    *v = r * (cos(d0) * sin(d) - sin(d0) * cos(d) * cos(a));
}

const char *psf_chip_failure(const psf_chip *c) {
    double u[POLYNOMIAL_VARIABLES] = {0};
    double t[POLYNOMIAL_TERMS];
    double flux = 0.0;
    const size_t plane = (size_t)c->model.nx * (size_t)c->model.ny;
    for (int i = 0; i < c->terms.variables; i++)
        u[i] = (c->variables[i].middle - c->variables[i].zero) / c->variables[i].scale;
    polynomial_terms(&c->terms, u, t);
    for (size_t i = 0; i < plane * (size_t)c->model.terms; i++)
        flux += isfinite(c->samples[i]) ? t[i / plane] * c->samples[i] : NAN;
    if (!isfinite(flux))
        return "its samples are not finite";
    return flux > 0.0 ? NULL : "its flux is not positive";
}

/* Append "2 in X_IMAGE, Y_IMAGE" for a group of variables. Return whether it has any. */
static bool describe_group(psf_chip *c, int group, const char *before) {
    char names[POLYNOMIAL_VARIABLES * SF_NAME] = "";
    for (int i = 0; i < c->terms.variables; i++) {
        if (c->terms.group[i] == group)
            text_append_item(names, sizeof names, c->variables[i].name);
    }
    if (names[0] != '\0') {
        text_append(c->text, sizeof c->text, "%s%d in %s", before, c->terms.degree[group], names);
    }
    return names[0] != '\0';
}

void psf_chip_describe(psf_chip *c) {
    const char *before = ", degree ";
    for (int group = 0; group < POLYNOMIAL_VARIABLES; group++)
        before = describe_group(c, group, before) ? " and " : before;
    if (c->terms.variables == 0)
        text_append(c->text, sizeof c->text, ", constant");
}
