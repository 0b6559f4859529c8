/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/validation_text.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "local/chips_text.h"
#include "local/report_text.h"
#include "sheard/report.h"
#include "terminal/message.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

static const char *const column_names[] = {"ID",     "X",      "Y",     "RA",   "DEC",
                                           "WEIGHT", "PSF_ID", "R_GAL", "FLAGS"};

static void print_psf(const shear_field_info *f, FILE *out) {
    const shear_geometry *g = &f->geometry;
    char layout[48];
    char fine[48] = "";
    snprintf(layout, sizeof layout, "%" PRId64 ", chosen by PSF_ID", f->n_psf);
    if (g->psf_oversample != 1.0)
        snprintf(fine, sizeof fine, ", %g per galaxy pixel", g->psf_oversample);
    text_line(out, "psf", "%s, %d x %d samples%s",
              f->psf_layout == SHEAR_PSF_ONE         ? "one for all stamps"
              : f->psf_layout == SHEAR_PSF_PER_STAMP ? "one per stamp"
                                                     : layout,
              g->psf_nx, g->psf_ny, fine);
}

static void print_stamps(const shear_field_info *f, FILE *out) {
    text_line(out, "stamps", "%" PRId64 " pairs of %d x %d pixels, a %s of %d-bit %s%s%s, %.4g MB",
              f->n_stamps, f->geometry.nx, f->geometry.ny,
              f->layout == SHEAR_LAYOUT_CUBE ? "cube" : "mosaic", abs(f->bitpix),
              f->bitpix < 0 ? "floats" : "integers", f->compressed ? ", tile-compressed" : "",
              f->gzipped ? ", gzipped" : "", 1e-6 * (double)f->file_bytes);
}

static void print_columns(const shear_field_info *f, FILE *out) {
    char text[128] = "";
    for (unsigned i = 0; i < sizeof column_names / sizeof column_names[0]; i++) {
        if ((f->columns & (1u << i)) != 0)
            text_append_item(text, sizeof text, column_names[i]);
    }
    text_line(out, "columns", "%s", text[0] != '\0' ? text : "none");
}

static void print_field(const shear_field_info *f, bool exposure, FILE *out) {
    char scale[48] = "";
    if (isfinite(f->pixscale))
        snprintf(scale, sizeof scale, ", %.4g arcsec per pixel", f->pixscale);
    text_line(out, "field", "%s%s", f->name[0] != '\0' ? f->name : "-", scale);
    if (!exposure)
        print_stamps(f, out);
    if (f->noise_planes > 1) {
        text_line(out, "noise", "%d stamps per galaxy, whose moments are averaged",
                  f->noise_planes);
    }
    if (!exposure)
        print_psf(f, out);
    print_columns(f, out);
    if (f->has_truth)
        text_line(out, "truth", "g1 %+.6g, g2 %+.6g", f->sim_g1, f->sim_g2);
}

/* Read the report that measuring the file gives, with its result as far as it is known. */
static bool summarize(sheard_report_summary *s, const sheard_validation_report *v) {
    CLEANUP(release_free) char *text = NULL;
    shear_error err = {0};
    shear_result result = v->result;
    result.estimator = v->settings->estimator;
    const sheard_report report = {.result = &result, .settings = v->settings, .plan = v->plan};
    if (sheard_report_json(&text, &report, &err) == SHEAR_OK &&
        sheard_report_summary_parse(s, text, &err) == SHEAR_OK) {
        return true;
    }
    message_error(&err);
    return false;
}

static void print_fault(const char *name, const char *help, const sheard_fault *f, FILE *out) {
    char stamps[256] = "";
    for (int i = 0; i < SHEARD_FAULT_SAMPLES && i < f->count; i++)
        text_append(stamps, sizeof stamps, "%s %" PRId64, i != 0 ? "," : "", f->first[i]);
    if (f->count > 0) {
        text_line(out, "flagged", "%" PRId64 " %s (%s): stamps%s%s", f->count, name, help, stamps,
                  f->count > SHEARD_FAULT_SAMPLES ? ", ..." : "");
    }
}

static void print_noise(const sheard_validation_report *v, FILE *out) {
    char error[32] = "";
    if (isfinite(v->noise_mean_err))
        snprintf(error, sizeof error, " +- %.2g", v->noise_mean_err);
    if (isfinite(v->noise_mean)) {
        text_line(out, "noise", "mean %.4g%s per pixel, rms %.4g about each stamp's own",
                  v->noise_mean, error, v->noise_rms);
    }
}

/* Print the results of the scan of all stamps. */
static void print_scan(const sheard_validation_report *v, FILE *out) {
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++)
        print_fault(shear_flag_name(bit), shear_flag_help(bit), &v->flags[bit], out);
    print_noise(v, out);
    if (isfinite(v->weight_follows_flux)) {
        text_line(out, "weights", "rank correlation with the stamps' own flux %+.2f%s",
                  v->weight_follows_flux, v->weight_is_suspect ? ": they bias the shear" : "");
    }
    print_fault("negative", "pixels below zero, of which there is no logarithm", &v->negative, out);
}

void validation_text_print(const sheard_validation_report *v, FILE *out) {
    char clean[1024];
    sheard_report_summary s = {0};
    fprintf(out, "file %s\n", message_clean(v->path, clean, sizeof clean));
    if (v->field != NULL)
        print_field(v->field, v->n_chips > 0, out);
    if (v->n_chips > 0)
        chips_text_print(v, out);
    if (v->plan != NULL && summarize(&s, v)) {
        report_text_method(&s, -1, out);
        text_line(out, "spectrum", "%d x %d grid, modes below %.4g radians per pixel",
                  v->plan->fine_nx, v->plan->fine_ny, v->plan->k_cut);
    }
    if (v->scanned)
        print_scan(v, out);
    if (v->measured && v->result.valid)
        report_text_quality(&s, out);
    text_line(out, v->good ? "good" : "bad", "%s", v->conclusion);
    for (size_t i = 0; i < v->n_warnings; i++)
        text_line(out, "warning", "%s", v->warnings[i]);
    if (v->advice[0] != '\0')
        text_line(out, "advice", "%s", v->advice);
    sheard_report_summary_deinit(&s);
}
