/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/validation_text.h"

#include "base/text.h"
#include "local/method_text.h"
#include "local/quality_text.h"
#include "local/value_text.h"
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
    if (g->psf_oversample > 1)
        snprintf(fine, sizeof fine, ", %d per galaxy pixel", g->psf_oversample);
    text_line(out, "psf", "%s, %d x %d samples%s",
              f->psf_layout == SHEAR_PSF_ONE         ? "one for all stamps"
              : f->psf_layout == SHEAR_PSF_PER_STAMP ? "one per stamp"
                                                     : layout,
              g->psf_nx, g->psf_ny, fine);
}

static void print_columns(const shear_field_info *f, FILE *out) {
    char text[128] = "";
    for (unsigned i = 0; i < sizeof column_names / sizeof column_names[0]; i++) {
        if ((f->columns & (1u << i)) != 0)
            text_append_item(text, sizeof text, column_names[i]);
    }
    text_line(out, "columns", "%s", text[0] != '\0' ? text : "none");
}

static void print_field(const shear_field_info *f, FILE *out) {
    char scale[48] = "";
    if (isfinite(f->pixscale))
        snprintf(scale, sizeof scale, ", %.4g arcsec per pixel", f->pixscale);
    text_line(out, "field", "%s%s", f->name[0] != '\0' ? f->name : "-", scale);
    text_line(out, "stamps", "%" PRId64 " pairs of %d x %d pixels, a %s of %d-bit %s%s%s, %.4g MB",
              f->n_stamps, f->geometry.nx, f->geometry.ny,
              f->layout == SHEAR_LAYOUT_CUBE ? "cube" : "mosaic", abs(f->bitpix),
              f->bitpix < 0 ? "floats" : "integers", f->compressed ? ", tile-compressed" : "",
              f->gzipped ? ", gzipped" : "", 1e-6 * (double)f->file_bytes);
    if (f->noise_planes > 1)
        text_line(out, "noise", "%d stamps per galaxy, whose moments are averaged",
                  f->noise_planes);
    print_psf(f, out);
    print_columns(f, out);
    if (f->has_truth)
        text_line(out, "truth", "g1 %+.6g, g2 %+.6g", f->sim_g1, f->sim_g2);
}

static void print_plan(const shear_plan_info *plan, const shear_settings *settings, FILE *out) {
    char core[64];
    char r_psf[64];
    char beta[64];
    const method_lines m = method_text_of(
        plan, settings, value_text_length(plan->r_psf_px, plan->r_psf_px, r_psf, sizeof r_psf),
        value_text_length(plan->beta_px, plan->beta_px, beta, sizeof beta),
        value_text_length(plan->core_px, plan->core_px, core, sizeof core));
    method_text_print(&m, out);
    text_line(out, "spectrum", "%d x %d grid, modes below %.4g radians per pixel", plan->fine_nx,
              plan->fine_ny, plan->k_cut);
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
    fprintf(out, "file %s\n", message_clean(v->path, clean, sizeof clean));
    if (v->field != NULL)
        print_field(v->field, out);
    if (v->plan != NULL)
        print_plan(v->plan, v->settings, out);
    if (v->scanned)
        print_scan(v, out);
    if (v->measured && v->result.valid && v->plan != NULL) {
        const quality_lines q = quality_text_of(&v->result, v->plan);
        quality_text_print(&q, out);
    }
    text_line(out, v->good ? "good" : "bad", "%s", v->conclusion);
    for (size_t i = 0; i < v->n_warnings; i++)
        text_line(out, "warning", "%s", v->warnings[i]);
    if (v->advice[0] != '\0')
        text_line(out, "advice", "%s", v->advice);
}
