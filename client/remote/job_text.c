/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/job_text.h"

#include "local/report_text.h"

#include "base/text.h"
#include "sheard/report_summary.h"
#include "terminal/bar.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/style.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const char *or_dash(const char *text) {
    return text != NULL && *text != '\0' ? text : "-";
}

static const char *image_text(const shear_input_part *image, char *buf, size_t size) {
    return shear_input_text(&(shear_input){.parts = {*image}}, buf, size);
}

/* Return whether the measured file itself was dropped. A dropped job file names other files. */
static bool is_dropped(const sheard_msg_job *job) {
    const char *dot = job->dropped_name != NULL ? strrchr(job->dropped_name, '.') : NULL;
    return job->dropped_name != NULL && !(dot != NULL && strcmp(dot, ".json") == 0);
}

/* Return the current place of a dropped file: "failed/a.1.fits", or "active" alone, because names
 * there are long. */
static const char *where_now(const sheard_msg_job *job, char *buf, size_t size) {
    const char *name = job->file_now != NULL ? strrchr(job->file_now, '/') : NULL;
    const char *folder = name;
    while (folder != NULL && folder > job->file_now && folder[-1] != '/')
        folder--;
    if (name == NULL)
        return "gone";
    const bool active = strncmp(folder, "active/", strlen("active/")) == 0;
    snprintf(buf, size, "%.*s", (int)(active ? name - folder : (ptrdiff_t)strlen(folder)), folder);
    return buf;
}

char *job_source_text(const sheard_msg_job *job, char *buf, size_t size) {
    const sheard_msg_source *source = &job->source;
    char galaxy[4180];
    if (is_dropped(job)) {
        snprintf(buf, size, "%s (%s)", job->dropped_name, where_now(job, galaxy, sizeof galaxy));
    } else if (source->exposure.image.path != NULL) {
        const shear_input input = sheard_source_input(source);
        snprintf(buf, size, "%s, an exposure",
                 image_text(&input.parts[SHEAR_PART_IMAGE], galaxy, sizeof galaxy));
    } else if (source->galaxy.path != NULL) {
        const shear_input input = sheard_source_input(source);
        snprintf(buf, size, "%s + noise, psf",
                 image_text(&input.parts[SHEAR_PART_GALAXY], galaxy, sizeof galaxy));
    } else {
        snprintf(buf, size, "%s", or_dash(source->path));
    }
    return buf;
}

const char *job_state_style(enum sheard_job_state state) {
    switch (state) {
    case SHEARD_JOB_RUNNING:
        return STYLE_ACTIVE;
    case SHEARD_JOB_DONE:
        return STYLE_GOOD;
    case SHEARD_JOB_FAILED:
        return STYLE_BAD;
    case SHEARD_JOB_WAITING:
    case SHEARD_JOB_CANCELLED:
    case SHEARD_JOB_RETRACTED:
        return STYLE_DOUBT;
    default:
        return NULL;
    }
}

/* ---- Tables ---- */

text_table *job_table_new(void) {
    static const text_column columns[] = {{"ID", 'r'},   {"STATE", 'l'}, {"FIELD", 'l'},
                                          {"DONE", 'r'}, {"PRIO", 'r'},  {"USER", 'l'},
                                          {"AGE", 'r'},  {"TOOK", 'r'},  {"SOURCE", 'l'}};
    return text_table_new(columns, sizeof columns / sizeof *columns);
}

bool job_is_before_measuring(const sheard_msg_job *job) {
    const int phase = job->progress.phase;
    return job->state == SHEARD_JOB_RUNNING && phase > SHEARD_PHASE_NONE &&
           phase < SHEARD_PHASE_MEASURING;
}

static int percent(int64_t done, int64_t total) {
    return (int)(100.0 * bar_part((double)done, (double)total));
}

static char *phase_text(const sheard_msg_progress *p, char *buf, size_t size) {
    const char *name = sheard_job_phase_name(p->phase);
    if (p->phase == SHEARD_PHASE_WAITING_MEMORY) {
        snprintf(buf, size, "waiting for memory");
    } else if (p->bytes_total > 0 && p->bytes_done >= 0) {
        snprintf(buf, size, "%s, %d%% of %.1f MB", name, percent(p->bytes_done, p->bytes_total),
                 1e-6 * (double)p->bytes_total);
    } else {
        snprintf(buf, size, "%s", name);
    }
    return buf;
}

/* Add "42%"; or "duplicate", or the code of a failure instead of 100 % or 0 %. */
static void add_part(text_table *t, const sheard_msg_job *job) {
    const sheard_msg_progress *p = &job->progress;
    if (job->outcome == SHEARD_OUTCOME_DUPLICATE) {
        text_table_cell(t, STYLE_DIM, "duplicate");
    } else if (job->state == SHEARD_JOB_FAILED || job->state == SHEARD_JOB_WAITING) {
        text_table_cell(t, NULL, "%s", or_dash(job->code));
    } else if (job_is_before_measuring(job)) {
        text_table_cell(t, STYLE_DIM, "%s", sheard_job_phase_name(p->phase));
    } else if (p->total >= 0 && job->state != SHEARD_JOB_QUEUED) {
        text_table_cell(t, NULL, "%d%%", percent(p->done, p->total));
    } else {
        text_table_cell(t, NULL, "%s", job->state == SHEARD_JOB_DONE ? "100%" : "-");
    }
}

static double took(const sheard_msg_job *job, int64_t now_ms) {
    const int64_t end = job->finished_ms != 0 ? job->finished_ms : now_ms;
    return job->started_ms != 0 ? (double)(end - job->started_ms) / 1000.0 : (double)NAN;
}

void job_table_add(text_table *t, const sheard_msg_job *job, int64_t now_ms) {
    char text[4200];
    char duration[HUMAN_SIZE];
    text_table_cell(t, NULL, "%" PRId64, job->id);
    text_table_cell(t, job_state_style(job->state), "%s", sheard_job_state_name(job->state));
    text_table_cell(t, NULL, "%s", or_dash(job->field));
    add_part(t, job);
    text_table_cell(t, NULL, "%" PRId64, job->priority);
    text_table_cell(t, NULL, "%s", or_dash(job->user));
    text_table_cell(t, NULL, "%s", human_age(job->created_ms, now_ms, duration));
    text_table_cell(t, NULL, "%s", human_duration(took(job, now_ms), duration));
    text_table_cell(t, NULL, "%s", job_source_text(job, text, sizeof text));
}

text_table *job_results_new(void) {
    static const text_column columns[] = {{"ID", 'r'}, {"STATE", 'l'}, {"FIELD", 'l'},
                                          {"G1", 'l'}, {"G2", 'l'},    {"USED", 'r'},
                                          {"OF", 'r'}, {"SOURCE", 'l'}};
    return text_table_new(columns, sizeof columns / sizeof *columns);
}

void job_results_add(text_table *t, const sheard_msg_job *job) {
    char text[4200];
    sheard_report_summary s = {.g1 = NAN, .g2 = NAN};
    shear_error err = {0};
    const bool has = job->result != NULL && sheard_report_summary_parse(&s, job->result, &err) == 0;
    text_table_cell(t, NULL, "%" PRId64, job->id);
    text_table_cell(t, job_state_style(job->state), "%s%s", sheard_job_state_name(job->state),
                    job->outcome == SHEARD_OUTCOME_DUPLICATE ? " (duplicate)" : "");
    text_table_cell(t, NULL, "%s", or_dash(job->field));
    text_table_cell(t, NULL, "%s", has ? human_value(s.g1, s.g1_err, text, sizeof text) : "-");
    text_table_cell(t, NULL, "%s", has ? human_value(s.g2, s.g2_err, text, sizeof text) : "-");
    text_table_cell(t, NULL, "%" PRId64, s.n_used);
    text_table_cell(t, NULL, "%" PRId64, s.n_stamps);
    text_table_cell(t, NULL, "%s", job_source_text(job, text, sizeof text));
    if (has)
        sheard_report_summary_deinit(&s);
}

/* ---- One job ---- */

/* Print a line, unless `text` is empty. */
static void print_text(FILE *out, const char *name, const char *text) {
    if (text != NULL && text[0] != '\0')
        text_line(out, name, "%s", text);
}

/* Print the options of an exposure that are given. */
static void print_options(const shear_exposure *e, FILE *out) {
    char number[24];
    for (int i = 0; i < SHEAR_N_EXPOSURE_OPTIONS; i++) {
        print_text(out, shear_exposure_option(i),
                   shear_exposure_get(e, shear_exposure_option(i), number));
    }
}

static void print_source(const sheard_msg_job *job, FILE *out) {
    const shear_input input = sheard_source_input(&job->source);
    if (job->dropped_name != NULL) {
        text_line(out, "dropped", "%s", job->dropped_name);
        text_line(out, "now at", "%s",
                  job->file_now != NULL ? job->file_now : "- (it was taken away)");
    }
    print_text(out, "file", is_dropped(job) ? NULL : job->source.path);
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (input.parts[i].path != NULL) {
            char text[4200];
            const bool sources = shear_input_is_exposure(&input) && i == SHEAR_PART_CATALOG;
            text_line(out, sources ? "sources" : shear_part_name(i), "%s",
                      image_text(&input.parts[i], text, sizeof text));
        }
    }
    if (shear_input_is_exposure(&input))
        print_options(&input.exposure, out);
}

static void print_failure(const sheard_msg_job *job, bool utc, FILE *out) {
    char time[HUMAN_SIZE];
    if (job->code != NULL) {
        const char *class = sheard_job_class_name(job->job_class);
        text_line(out, "failure", "%s%s%s%s: %s", job->code, *class != '\0' ? " (" : "", class,
                  *class != '\0' ? ")" : "", or_dash(job->message));
        print_text(out, "advice", job->advice);
    }
    if (job->not_before_ms != 0 && job->state == SHEARD_JOB_WAITING)
        text_line(out, "retry", "not before %s", human_time(job->not_before_ms, utc, time));
}

static void print_times(const sheard_msg_job *job, bool utc, FILE *out) {
    char time[HUMAN_SIZE];
    char duration[HUMAN_SIZE];
    text_line(out, "submitted", "%s by %s (%s)", human_time(job->created_ms, utc, time),
              or_dash(job->user), sheard_job_origin_name(job->origin));
    if (job->started_ms != 0)
        text_line(out, "started", "%s", human_time(job->started_ms, utc, time));
    if (job->finished_ms != 0) {
        text_line(out, "finished", "%s (took %s)", human_time(job->finished_ms, utc, time),
                  human_duration(took(job, job->finished_ms), duration));
    }
}

char *job_progress_text(const sheard_msg_job *job, int width, char *buf, size_t size) {
    const sheard_msg_progress *p = &job->progress;
    if (job_is_before_measuring(job))
        return phase_text(p, buf, size);
    const double part = bar_part((double)p->done, (double)p->total);
    char figures[96];
    bar_text(part, width, buf, size);
    text_append(buf, size, "%s", bar_figures(part, p->rate, p->eta_s, figures, sizeof figures));
    return buf;
}

static void print_progress(const sheard_msg_job *job, FILE *out) {
    char text[144];
    if (job->state == SHEARD_JOB_RUNNING &&
        (job_is_before_measuring(job) || job->progress.total >= 0)) {
        text_line(out, "progress", "%s", job_progress_text(job, 32, text, sizeof text));
    }
}

/* Print the settings that differ from the built-in defaults, as "NAME=VALUE NAME=VALUE". */
static void print_settings(const char *settings, FILE *out) {
    char text[SHEARD_MSG_SETTINGS_SIZE] = "";
    size_t n = 0;
    shear_settings theirs;
    shear_settings defaults;
    const shear_setting_def *table = shear_settings_table(&n);
    shear_settings_init(&theirs);
    shear_settings_init(&defaults);
    if (settings == NULL || sheard_settings_apply(&theirs, settings, NULL) != SHEAR_OK)
        return;
    for (size_t i = 0; i < n; i++) {
        char a[64];
        char b[64];
        shear_settings_format(&theirs, &table[i], a, sizeof a);
        if (strcmp(a, shear_settings_format(&defaults, &table[i], b, sizeof b)) != 0)
            text_append(text, sizeof text, "%s%s=%s", text[0] != '\0' ? " " : "", table[i].name, a);
    }
    text_line(out, "settings", "%s", text[0] != '\0' ? text : "all at their defaults");
}

static void print_outcome(const sheard_msg_job *job, FILE *out) {
    if (job->outcome == SHEARD_OUTCOME_DUPLICATE) {
        text_line(out, "outcome",
                  "duplicate of job %" PRId64 ": not counted again (--force counts it)",
                  job->duplicate_of);
    } else if (job->outcome == SHEARD_OUTCOME_COUNTED) {
        text_line(out, "outcome", "counted to the field");
    } else if (job->state == SHEARD_JOB_RETRACTED) {
        text_line(out, "outcome", "was counted, and was taken back");
    }
    print_text(out, "catalog", job->catalog);
    report_text_print(job->result, NULL, false, out);
}

static void print_history(const sheard_msg_shown *shown, bool utc, FILE *out) {
    for (size_t i = 0; i < shown->n_history; i++) {
        const sheard_msg_attempt *a = &shown->history[i];
        char time[HUMAN_SIZE];
        char after[64] = "";
        char duration[HUMAN_SIZE];
        const char *outcome = sheard_attempt_outcome_name(a->outcome);
        if (a->ended_ms != 0) {
            human_duration((double)(a->ended_ms - a->started_ms) / 1000.0, duration);
            snprintf(after, sizeof after, " after %s", duration);
        }
        text_line(out, "attempt", "%" PRId64 ": %s, %s%s%s%s", a->number,
                  human_time(a->started_ms, utc, time), *outcome != '\0' ? outcome : "running",
                  after, a->code != NULL ? ", " : "", a->code != NULL ? a->code : "");
    }
}

void job_text_print(const sheard_msg_shown *shown, bool utc, FILE *out) {
    const sheard_msg_job *job = &shown->job;
    const char *style = style_on(out) ? job_state_style(job->state) : NULL;
    fprintf(out, "job %" PRId64 "  %s%s%s%s\n", job->id, style != NULL ? style : "",
            sheard_job_state_name(job->state), style != NULL ? STYLE_END : "",
            job->cancel_asked && !sheard_job_state_is_final(job->state) ? " (being cancelled)"
                                                                        : "");
    text_line(out, "field", "%s", or_dash(job->field));
    print_source(job, out);
    print_failure(job, utc, out);
    print_progress(job, out);
    print_outcome(job, out);
    print_times(job, utc, out);
    if (job->priority != 0)
        text_line(out, "priority", "%" PRId64, job->priority);
    print_text(out, "key", job->key);
    print_settings(job->settings, out);
    print_text(out, "checksum", job->checksum);
    print_history(shown, utc, out);
}

void job_complain(const sheard_msg_job *job) {
    if (job->state == SHEARD_JOB_FAILED) {
        message_fail(EXIT_CODE_JOB_FAILED, job->advice, "job %" PRId64 " failed: %s [%s]", job->id,
                     or_dash(job->message), or_dash(job->code));
    } else if (job->state == SHEARD_JOB_CANCELLED || job->state == SHEARD_JOB_RETRACTED) {
        message_fail(EXIT_CODE_CANCELLED, NULL, "job %" PRId64 " was %s", job->id,
                     sheard_job_state_name(job->state));
    } else if (!sheard_job_state_is_final(job->state)) {
        message_fail(EXIT_CODE_TIMED_OUT, NULL, "job %" PRId64 " is not finished: %s", job->id,
                     sheard_job_state_name(job->state));
    }
}
