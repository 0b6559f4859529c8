/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/validation_text.h"

#include "local/method_text.h"
#include "local/quality_text.h"
#include "terminal/message.h"

#include <inttypes.h>
#include <math.h>

static const char *const column_names[] = {"ID",     "X",      "Y",     "RA",   "DEC",
                                           "WEIGHT", "PSF_ID", "R_GAL", "FLAGS"};

static const char *pixel_type(int bitpix) {
    switch (bitpix) {
    case 8:
        return "8-bit integers";
    case 16:
        return "16-bit integers";
    case 32:
        return "32-bit integers";
    case 64:
        return "64-bit integers";
    case -32:
        return "32-bit floats";
    default:
        return "64-bit floats";
    }
}

static void print_psf(const shear_field_info *f, FILE *out) {
    const shear_geometry *g = &f->geometry;
    fprintf(out, "  %-10s ", "psf");
    if (f->psf_layout == SHEAR_PSF_ONE) {
        fputs("one for all stamps", out);
    } else if (f->psf_layout == SHEAR_PSF_PER_STAMP) {
        fputs("one per stamp", out);
    } else {
        fprintf(out, "%" PRId64 ", chosen by PSF_ID", f->n_psf);
    }
    fprintf(out, ", %d x %d samples", g->psf_nx, g->psf_ny);
    if (g->psf_oversample > 1) {
        fprintf(out, ", %d per galaxy pixel", g->psf_oversample);
    }
    fputc('\n', out);
}

static void print_columns(const shear_field_info *f, FILE *out) {
    const char *before = "";
    fprintf(out, "  %-10s ", "columns");
    for (unsigned i = 0; i < sizeof column_names / sizeof column_names[0]; i++) {
        if (f->columns & (1u << i)) {
            fprintf(out, "%s%s", before, column_names[i]);
            before = ", ";
        }
    }
    fprintf(out, "%s\n", before[0] ? "" : "none");
}

static void print_field(const shear_field_info *f, FILE *out) {
    char name[80];
    fprintf(out, "  %-10s %s", "field",
            f->name[0] ? message_clean(f->name, name, sizeof name) : "-");
    if (isfinite(f->pixscale)) {
        fprintf(out, ", %.4g arcsec a pixel", f->pixscale);
    }
    fprintf(out, "\n  %-10s %" PRId64 " pairs of %d x %d pixels, a %s of %s%s%s, %.4g MB\n",
            "stamps", f->n_stamps, f->geometry.nx, f->geometry.ny,
            f->layout == SHEAR_LAYOUT_CUBE ? "cube" : "mosaic", pixel_type(f->bitpix),
            f->compressed ? ", tile-compressed" : "", f->gzipped ? ", gzipped" : "",
            1e-6 * (double)f->file_bytes);
    if (f->noise_planes > 1) {
        fprintf(out, "  %-10s %d stamps a galaxy, whose moments are averaged\n", "noise",
                f->noise_planes);
    }
    print_psf(f, out);
    print_columns(f, out);
    if (f->has_truth) {
        fprintf(out, "  %-10s g1 %+.6g, g2 %+.6g\n", "truth", f->sim_g1, f->sim_g2);
    }
}

static void print_plan(const shear_plan_info *plan, const shear_settings *settings, FILE *out) {
    char core[32];
    char r_psf[32];
    char beta[32];
    snprintf(r_psf, sizeof r_psf, "%.4g px", plan->r_psf_px);
    snprintf(beta, sizeof beta, "%.4g px", plan->beta_px);
    snprintf(core, sizeof core, "%.4g px", plan->core_px);
    const method_lines m = method_text_of(plan, settings, r_psf, beta, core);
    method_text_print(&m, out);
    fprintf(out, "  %-10s %d x %d grid, modes below %.4g radians a pixel\n", "spectrum",
            plan->fine_nx, plan->fine_ny, plan->k_cut);
}

static void print_fault(const char *name, const char *help, const sheard_fault *f, FILE *out) {
    if (f->count == 0) {
        return;
    }
    fprintf(out, "  %-10s %" PRId64 " %s (%s): stamps", "flagged", f->count, name, help);
    for (int i = 0; i < SHEARD_FAULT_SAMPLES && i < f->count; i++) {
        fprintf(out, "%s %" PRId64, i != 0 ? "," : "", f->first[i]);
    }
    fputs(f->count > SHEARD_FAULT_SAMPLES ? ", ...\n" : "\n", out);
}

static void print_noise(const sheard_validation_report *v, FILE *out) {
    if (isfinite(v->noise_mean)) {
        fprintf(out, "  %-10s mean %.4g", "noise", v->noise_mean);
        if (isfinite(v->noise_mean_err)) {
            fprintf(out, " +- %.2g", v->noise_mean_err);
        }
        fprintf(out, " a pixel, rms %.4g about each stamp's own\n", v->noise_rms);
    }
}

static void print_weights(const sheard_validation_report *v, FILE *out) {
    if (isfinite(v->weight_follows_flux)) {
        fprintf(out, "  %-10s rank correlation with the stamps' own flux %+.2f%s\n", "weights",
                v->weight_follows_flux, v->weight_is_suspect ? ": they bias the shear" : "");
    }
}

void validation_text_print(const sheard_validation_report *v, FILE *out) {
    char clean[1024];
    fprintf(out, "file %s\n", message_clean(v->path, clean, sizeof clean));
    if (v->field != NULL) {
        print_field(v->field, out);
    }
    if (v->plan != NULL) {
        print_plan(v->plan, v->settings, out);
    }
    for (int bit = 0; v->scanned && bit < SHEAR_N_FLAGS; bit++) {
        print_fault(shear_flag_name(bit), shear_flag_help(bit), &v->flags[bit], out);
    }
    if (v->scanned) {
        print_noise(v, out);
        print_weights(v, out);
        print_fault("negative", "pixels below zero, of which there is no logarithm", &v->negative,
                    out);
    }
    if (v->measured && v->result.valid && v->plan != NULL) {
        const quality_lines q = quality_text_of(&v->result, v->plan);
        quality_text_print(&q, out);
    }
    fprintf(out, "  %-10s %s\n", v->good ? "good" : "bad",
            message_clean(v->conclusion, clean, sizeof clean));
    for (size_t i = 0; i < v->n_warnings; i++) {
        fprintf(out, "  %-10s %s\n", "warning", message_clean(v->warnings[i], clean, sizeof clean));
    }
    if (v->advice[0]) {
        fprintf(out, "  %-10s %s\n", "advice", message_clean(v->advice, clean, sizeof clean));
    }
}
