/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The chips of an exposure in its validation report. */
#include "report/parts.h"

#include "json/text.h"

static json_t *hdus(const shear_chip *c) {
    json_t *object = json_object();
    for (int part = SHEAR_PART_IMAGE; part <= SHEAR_PART_SEGMENTATION; part++)
        json_text_set(&object, shear_part_name(part), json_text_index(c->hdu[part]));
    return object;
}

static json_t *psf(const shear_chip *c) {
    return JSON_OBJECT({"model", json_integer(c->model)}, {"chip", json_text_string(c->psf_chip)},
                       {"text", json_text_string(c->psf)}, {"terms", json_integer(c->psf_terms)},
                       {"stars", json_text_index(c->psf_stars)});
}

/* `scanned`: its stamps have been looked at. */
static json_t *chip(const sheard_chip_report *r, bool scanned) {
    const shear_chip *c = &r->chip;
    return JSON_OBJECT(
        {"name", json_text_string(c->name)}, {"nx", json_integer(c->nx)},
        {"ny", json_integer(c->ny)}, {"hdu", hdus(c)}, {"table", json_integer(c->table)},
        {"wcs", json_boolean(c->has_wcs)}, {"psf", psf(c)}, {"masked", json_text_number(r->masked)},
        {"weight_slope", json_text_number(r->weight_slope)},
        {"n_extreme", json_integer(r->n_extreme)}, {"n_sources", json_integer(c->n_sources)},
        {"n_selected", json_integer(c->n_stamps)},
        {"n_measurable", scanned ? json_integer(r->n_measurable) : json_null()},
        {"n_bright", scanned ? json_integer(r->n_bright) : json_null()},
        {"n_sharp", scanned ? json_integer(r->n_sharp) : json_null()},
        {"flags",
         scanned ? json_text_counts(r->flags, SHEAR_N_FLAGS, shear_flag_name) : json_null()},
        {"centring", scanned ? parts_centring(&r->centring) : json_null()});
}

json_t *parts_exposure(const sheard_validation_report *v) {
    json_t *chips = json_array();
    for (int i = 0; i < v->n_chips; i++)
        json_text_append(&chips, chip(&v->chips[i], v->scanned));
    return JSON_OBJECT(
        {"frame", json_text_string(v->field != NULL ? shear_frame_name(v->field->frame) : NULL)},
        {"distortion", JSON_OBJECT({"min", json_text_number(v->distortion_min)},
                                   {"max", json_text_number(v->distortion_max)})},
        {"chips", chips});
}
