/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/chips_text.h"

#include "base/text.h"
#include "local/chip_scan.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

static void print_frame(const sheard_validation_report *v, FILE *out) {
    static const char *const axes[] = {[SHEAR_FRAME_PIXEL] = "x along rows, y along columns",
                                       [SHEAR_FRAME_SKY] = "x to the West, y to the North",
                                       [SHEAR_FRAME_SKY_EAST] = "x to the East, y to the North"};
    const shear_field_info *f = v->field;
    text_line(out, "stamps", "%" PRId64 " pairs of %d x %d pixels, from %d chip%s", f->n_stamps,
              f->geometry.nx, f->geometry.ny, v->n_chips, v->n_chips == 1 ? "" : "s");
    text_line(out, "frame", "%s: %s", shear_frame_name(f->frame), axes[f->frame]);
    if (isfinite(v->distortion_max)) {
        text_line(out, "distortion", "shear of %.4f to %.4f%s", v->distortion_min,
                  v->distortion_max,
                  f->frame == SHEAR_FRAME_PIXEL ? ", which remains in the shear" : ", taken out");
    }
}

/* Print which image, weight map, ..., catalog table and model the chip was matched with. */
static void print_matches(const shear_chip *c, FILE *out) {
    char text[200] = "";
    for (int part = SHEAR_PART_IMAGE; part <= SHEAR_PART_SEGMENTATION; part++) {
        if (c->hdu[part] >= 0) {
            text_append(text, sizeof text, "%s HDU %" PRId64 ", ", shear_part_name(part),
                        c->hdu[part]);
        } else {
            text_append(text, sizeof text, "no %s, ", shear_part_name(part));
        }
    }
    text_line(out, "matched", "%ssources table %d, PSF model %d%s%s%s, %s", text, c->table,
              c->model, c->psf_chip[0] != '\0' ? " (" : "", c->psf_chip,
              c->psf_chip[0] != '\0' ? ")" : "", c->has_wcs ? "WCS" : "no WCS");
}

static void print_chip(const sheard_chip_report *r, bool scanned, FILE *out) {
    const shear_chip *c = &r->chip;
    char name[96];
    char found[96] = "";
    if (scanned) {
        snprintf(found, sizeof found, ", %" PRId64 " measurable; %.2f %% bad pixels",
                 r->n_measurable, 100.0 * r->masked);
    }
    text_line(out, "chip", "%s: %d x %d px; %" PRId64 " sources on it, %" PRId64 " selected%s",
              chip_scan_name(r, name, sizeof name), c->nx, c->ny, c->n_sources, c->n_stamps, found);
    print_matches(c, out);
    if (r->centring.found > 1) {
        text_line(out, "positions",
                  "light of %" PRId64 " of %" PRId64
                  " galaxies at (%+.3f, %+.3f) +- (%.3f, %.3f) px from them",
                  r->centring.found, r->centring.looked_at, r->centring.x, r->centring.y,
                  r->centring.x_err, r->centring.y_err);
    }
}

void chips_text_print(const sheard_validation_report *v, FILE *out) {
    print_frame(v, out);
    for (int i = 0; i < v->n_chips; i++) {
        const char *psf = v->chips[i].chip.psf;
        print_chip(&v->chips[i], v->scanned, out);
        if (i == 0 || strcmp(psf, v->chips[i - 1].chip.psf) != 0)
            text_line(out, "psf", "%s", psf);
    }
}
