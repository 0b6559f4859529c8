/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/measure_group.h"

#include "local/estimators.h"
#include "local/weight_check.h"

#include "base/array.h"
#include "base/cleanup.h"
#include "sheard/advice.h"
#include "sheard/no_shear.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Return the group of this field, or a new group after the last. */
static measure_group *group_of(measure_group *groups, size_t n, const char *field) {
    for (size_t i = 0; i < n; i++) {
        if (strcmp(groups[i].field, field) == 0)
            return &groups[i];
    }
    groups[n].field = field;
    return &groups[n];
}

bool measure_groups_new(measure_input *inputs, size_t n, measure_group **groups, size_t *n_groups) {
    *n_groups = 0;
    *groups = calloc(n + 1, sizeof **groups);
    for (size_t i = 0; *groups != NULL && i < n; i++) {
        if (!measure_input_is_wanted(&inputs[i]))
            continue;
        measure_group *g = group_of(*groups, *n_groups, inputs[i].field);
        *n_groups += g == &(*groups)[*n_groups];
        if (!ARRAY_RESERVE(g->inputs, g->capacity, g->n + 1)) {
            measure_groups_free(*groups, *n_groups);
            *groups = NULL;
            *n_groups = 0;
            return false;
        }
        g->inputs[g->n++] = &inputs[i];
    }
    return *groups != NULL;
}

void measure_groups_free(measure_group *groups, size_t n_groups) {
    for (size_t i = 0; groups != NULL && i < n_groups; i++) {
        free(groups[i].inputs);
        free(groups[i].files);
        warnings_deinit(&groups[i].warnings);
    }
    free(groups);
}

static int by_checksum(const void *a, const void *b) {
    const measure_input *const *x = a;
    const measure_input *const *y = b;
    return strcmp((*x)->checksum, (*y)->checksum);
}

/* Check this before measuring: an hour of work must not end in "fewer blocks than groups". */
static int check_blocks(const measure_group *g, int groups, shear_error *err) {
    int64_t blocks = 0;
    for (size_t i = 0; i < g->n; i++)
        blocks += (g->inputs[i]->info.n_stamps + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    if (groups > blocks) {
        return shear_fail(err, SHEAR_E_SETTING,
                          "use fewer groups, or the delta method (no --jackknife)",
                          "--jackknife %d: field %s has only %lld blocks of %d stamps", groups,
                          g->field, (long long)blocks, SHEAR_BLOCK);
    }
    return SHEAR_OK;
}

/* Shears along different axes cannot be averaged. */
static int check_frames(const measure_group *g, shear_error *err) {
    for (size_t i = 1; i < g->n; i++) {
        const measure_input *const *in = (const measure_input *const *)g->inputs;
        if (in[i]->info.frame != in[0]->info.frame) {
            return shear_fail(err, SHEAR_E_SETTING,
                              "measure them with one --frame, or as different fields",
                              "field %s: %s is in the frame %s, but %s in %s", g->field,
                              in[0]->path, shear_frame_name(in[0]->info.frame), in[i]->path,
                              shear_frame_name(in[i]->info.frame));
        }
    }
    return SHEAR_OK;
}

static void fail_all(measure_group *g, const shear_error *err) {
    const enum exit_code code = message_error(err);
    for (size_t i = 0; i < g->n; i++) {
        if (g->inputs[i]->failure == 0)
            g->inputs[i]->failure = code;
    }
}

/* The sums of all files of a group. */
typedef struct gathering {
    shear_field_sums *sums;
    shear_symmetry *terms; /* or NULL */
    shear_jackknife *jack; /* or NULL */
} gathering;

static void run_input(measure_input *input, const measure_options *o, const gathering *to) {
    shear_error err = {0};
    progress *bar = progress_begin(input->path, o->quiet);
    shear_run_options run = {
        .threads = (int)o->threads,
        .catalog_path = input->catalog,
        .overwrite = o->force,
        .rows = chip_counts_sink(&input->counts),
        .terms = to->terms,
        .checksum = input->checksum,
        .progress = progress_callback,
        .context = bar,
    };
    int code = shear_run_input(&input->source, &o->settings.values, &run, to->sums, to->jack,
                               &input->report, &err);
    progress_end(bar);
    if (code != SHEAR_OK) {
        const bool writing = code == SHEAR_E_IO && input->catalog != NULL;
        const enum exit_code failure = message_error(&err);
        input->failure = writing ? EXIT_CODE_OTHER : failure;
    }
    input->measured = code == SHEAR_OK;
}

/* Measure all files of the group, in `order`. */
static void run_inputs(measure_group *g, measure_input **order, const measure_options *o,
                       const gathering *to) {
    for (size_t i = 0; i < g->n; i++) {
        if (progress_interrupted()) {
            order[i]->failure = EXIT_CODE_OTHER;
        } else {
            run_input(order[i], o, to);
        }
    }
}

/* Describe the measured files as a report contains them, and add up their times. */
static void list_files(measure_group *g) {
    for (size_t i = 0; i < g->n; i++) {
        const measure_input *input = g->inputs[i];
        const shear_run_report *run = &input->report;
        if (input->measured) {
            g->files[g->n_measured++] = (sheard_report_file){
                input->path,        input->checksum, input->info.name, run->result.n_stamps,
                run->result.n_used, &run->plan,      run->seconds};
            g->seconds += run->seconds;
        }
    }
}

static int64_t count_stamps(const measure_group *g) {
    int64_t n = 0;
    for (size_t i = 0; i < g->n; i++)
        n += g->inputs[i]->info.n_stamps;
    return n;
}

static int gathering_init(gathering *to, const measure_group *g, const measure_options *o,
                          shear_error *err) {
    const bool wanted = estimators_wanted(count_stamps(g), o->settings.values.estimator);
    TRY(shear_field_sums_new(&to->sums, err));
    TRY(wanted ? shear_symmetry_new(&to->terms, err) : SHEAR_OK);
    return o->jackknife == 0 ? SHEAR_OK : shear_jackknife_new(&to->jack, (int)o->jackknife, err);
}

static void gathering_deinit(gathering *to) {
    shear_jackknife_free(to->jack);
    shear_symmetry_free(to->terms);
    shear_field_sums_free(to->sums);
}

/* Warn of weights that depend on the stamps' brightness. */
static void check_weights(measure_group *g, const shear_symmetry *terms) {
    const rank_relation r = weight_check_terms(terms);
    if (rank_is_strong(&r)) {
        warnings_add(&g->warnings,
                     "WEIGHT follows the stamps' own power (rank correlation %+.2f): such weights "
                     "bias the shear, 1/flux^2 by 4 to 6 %%; take weights of something else, or "
                     "none and --estimator pdf-sym",
                     r.correlation);
    }
}

static int run_all(measure_group *g, const measure_options *o, measure_input **order,
                   shear_error *err) {
    CLEANUP(gathering_deinit) gathering to = {0};
    TRY(gathering_init(&to, g, o, err));
    run_inputs(g, order, o, &to);
    list_files(g);
    TRY(shear_estimate(o->settings.values.estimator, to.sums, to.terms, &g->result, err));
    if (to.terms != NULL)
        check_weights(g, to.terms);
    TRY(estimators_solve(to.sums, to.terms, &g->result, &g->estimators, err));
    return to.jack == NULL || g->n_measured == 0 ? SHEAR_OK
                                                 : shear_jackknife_finish(to.jack, &g->result, err);
}

/* Check the result. A field without a usable stamp is an error, but its counts are still shown. */
static int check_result(const measure_group *g, shear_error *err) {
    char text[400];
    char advice[400];
    const shear_result *r = &g->result;
    sheard_cause cause = {.words = NULL};
    if (!r->valid && !sheard_cause_of(r, &measure_group_first(g)->report.plan, &cause)) {
        cause.words = sheard_no_shear_text(r, text, sizeof text);
        cause.advice = sheard_no_shear_advice(r, advice, sizeof advice);
    }
    if (!r->valid) {
        return shear_fail(err, SHEAR_E_FORMAT, cause.advice,
                          "field %s: %s: no shear could be measured", g->field, cause.words);
    }
    if (!isfinite(r->g1_err) || !isfinite(r->g2_err)) {
        return shear_fail(
            err, SHEAR_E_FORMAT,
            "scale the pixels up, or the weights: their squares are beyond what a double holds",
            "field %s: the errors of the shear could not be computed", g->field);
    }
    return SHEAR_OK;
}

/* The advice concerns the PSF of the first file; warn if other files have another one. */
static void warn_of_other_psfs(measure_group *g) {
    char line[SHEARD_ADVICE_SIZE];
    const char *first = measure_group_first(g)->path;
    if (sheard_advice_other_psfs(g->files, g->n_measured, first, line, sizeof line) != NULL)
        warnings_add(&g->warnings, "%s", line);
}

/* Say which chips have a PSF that is too broad, if there are several chips or files. */
static void warn_of_broad_psfs(measure_group *g) {
    char line[SHEARD_ADVICE_SIZE];
    char other[SHEARD_ADVICE_SIZE];
    const char *name = NULL;
    int broad = 0;
    int chips = 0;
    for (size_t i = 0; i < g->n; i++) {
        const measure_input *in = g->inputs[i];
        const char *its = NULL;
        if (!in->measured)
            continue;
        chips += in->counts.n;
        const int n = chip_counts_broad(&in->counts, &in->report.result, &in->report.plan,
                                        broad == 0 ? line : other, sizeof line, &its);
        name = broad == 0 ? its : name;
        broad += n;
    }
    if (broad > 0 && chips > 1) {
        warnings_add(&g->warnings, "%d of %d %s, the first %s: %s", broad, chips,
                     chips > (int)g->n_measured ? "chips" : "files", name, line);
    }
}

/* Add warnings about the result. */
static void add_warnings(measure_group *g) {
    sheard_advice_list advice;
    const measure_input *top = g->n_measured > 1 ? measure_group_top(g) : NULL;
    sheard_advice_all(&advice, &g->result, &measure_group_first(g)->report.plan,
                      top != NULL ? top->path : NULL);
    for (size_t i = 0; i < advice.n; i++)
        warnings_add(&g->warnings, "%s", advice.lines[i]);
    warn_of_other_psfs(g);
    warn_of_broad_psfs(g);
    for (size_t i = 0; i < g->n; i++) {
        for (size_t k = 0; k < g->inputs[i]->warnings.n; k++)
            warnings_add(&g->warnings, "%s", g->inputs[i]->warnings.text[k]);
    }
    if (g->n_measured < g->n) {
        warnings_add(&g->warnings, "%zu of %zu files failed and are not in this result",
                     g->n - g->n_measured, g->n);
    }
}

static int measure(measure_group *g, const measure_options *o, shear_error *err) {
    /* in the order of the arguments, or of the checksums for a jackknife */
    CLEANUP(release_free) measure_input **order = calloc(g->n, sizeof(measure_input *));
    g->files = calloc(g->n, sizeof *g->files);
    if (order == NULL || g->files == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    TRY(check_frames(g, err));
    memcpy(order, g->inputs, g->n * sizeof(measure_input *));
    if (o->jackknife > 0) {
        qsort(order, g->n, sizeof(measure_input *), by_checksum);
        TRY(check_blocks(g, (int)o->jackknife, err));
    }
    return run_all(g, o, order, err);
}

bool measure_group_run(measure_group *g, const measure_options *o) {
    shear_error err = {0};
    int code = measure(g, o, &err);
    const bool measured = code == SHEAR_OK && g->n_measured > 0;
    if (measured) {
        add_warnings(g);
        code = check_result(g, &err);
    }
    if (code != SHEAR_OK)
        fail_all(g, &err);
    return measured;
}

const measure_input *measure_group_first(const measure_group *g) {
    for (size_t i = 0; i < g->n; i++) {
        if (g->inputs[i]->measured)
            return g->inputs[i];
    }
    return NULL;
}

const measure_input *measure_group_top(const measure_group *g) {
    const measure_input *top = NULL;
    double largest = 0.0;
    for (size_t i = 0; i < g->n; i++) {
        const shear_result *r = &g->inputs[i]->report.result;
        const double size = r->top_share * fabs(r->sum_d);
        if (g->inputs[i]->measured && r->top_stamp == g->result.top_stamp && size > largest) {
            top = g->inputs[i];
            largest = size;
        }
    }
    return top;
}

bool measure_group_truth(const measure_group *g, double *g1, double *g2) {
    const measure_input *first = measure_group_first(g);
    if (first == NULL || !first->info.has_truth)
        return false;
    *g1 = first->info.sim_g1;
    *g2 = first->info.sim_g2;
    for (size_t i = 0; i < g->n; i++) {
        const shear_field_info *info = &g->inputs[i]->info;
        if (g->inputs[i]->measured &&
            (!info->has_truth || info->sim_g1 != *g1 || info->sim_g2 != *g2)) {
            return false;
        }
    }
    return true;
}
