/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an operator should look at: what failed lately and will be tried again, what lies where it
 * should not, disks, the log. Told by status, doctor, metrics and the live view; what fails is
 * logged when it happens. */
#include "service/inner.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* So many lines of one kind in this time; the rest is counted, and the count follows. */
enum { BURST = 5 };
static const int64_t burst_ms = 30000;

void problem_noted(service *s, const char *about, const char *code, int64_t lasts_ms,
                   const char *message) {
    const int64_t now = steady_ms();
    problem_note *note = NULL;
    for (size_t i = 0; i < PROBLEM_NOTES; i++) {
        problem_note *at = &s->notes[i];
        if (strcmp(at->about, about) == 0 && strcmp(at->code, code) == 0) {
            note = at;
            break;
        }
        if (note == NULL || at->until_ms < note->until_ms) {
            note = at; /* the one that is over, or will be first */
        }
    }
    const bool same = strcmp(note->about, about) == 0 && strcmp(note->code, code) == 0;
    if (!same || note->until_ms <= now) {
        *note = (problem_note){.since_ms = wall_ms(), .burst_from_ms = now};
        snprintf(note->about, sizeof note->about, "%s", about);
        snprintf(note->code, sizeof note->code, "%s", code);
    }
    note->until_ms = lasts_ms < INT64_MAX - now ? now + lasts_ms : INT64_MAX;
    note->count++;
    snprintf(note->message, sizeof note->message, "%s", message);
}

static problem_note *find_note(const service *s, const char *about, const char *code) {
    for (size_t i = 0; i < PROBLEM_NOTES; i++) {
        const problem_note *at = &s->notes[i];
        if (at->until_ms > steady_ms() && strcmp(at->about, about) == 0 &&
            (code == NULL || strcmp(at->code, code) == 0)) {
            return (problem_note *)at;
        }
    }
    return NULL;
}

void problem_over(service *s, const char *about) {
    problem_note *note;
    while ((note = find_note(s, about, NULL)) != NULL) {
        *note = (problem_note){0};
    }
}

/* ---- the log ---- */

/* May one more line of this note be written? */
static bool in_burst(problem_note *note) {
    const int64_t now = steady_ms();
    if (now - note->burst_from_ms >= burst_ms) {
        note->burst_from_ms = now;
        note->burst = 0;
    }
    if (note->burst >= BURST) {
        note->unlogged++;
        return false;
    }
    note->burst++;
    return true;
}

void problem_job_waits(service *s, const store_job *job) {
    char time[SHEARD_TIME_SIZE];
    const char *code = job->code != NULL ? job->code : "unknown";
    const char *message = job->message != NULL ? job->message : code;
    /* It is the same trouble as long as attempts follow each other. */
    problem_noted(s, "jobs", code, 2 * s->config.retry.max_delay_ms + 60000, message);
    problem_note *note = find_note(s, "jobs", code);
    if (note != NULL && in_burst(note)) {
        log_warning("job %" PRId64 " (%s) waits: %s (%s, attempt %" PRId64
                    "); it is tried again at %s",
                    job->id, job->field != NULL ? job->field : "field unknown", message, code,
                    job->attempts, sheard_time_format(job->not_before_ms, time));
    }
}

void problem_file_waits(service *s, const char *name, const char *code, const char *message) {
    problem_noted(s, "spool", code, 3 * s->config.spool.scan_interval_ms + 60000, message);
    problem_note *note = find_note(s, "spool", code);
    if (note != NULL && in_burst(note)) {
        log_warning("the file %s waits in active/: %s; it is tried again within %.3g s", name,
                    message, 1e-3 * (double)s->config.spool.scan_interval_ms);
    }
}

void problems_tick(service *s) {
    const int64_t now = steady_ms();
    for (size_t i = 0; i < PROBLEM_NOTES; i++) {
        problem_note *note = &s->notes[i];
        if (note->unlogged > 0 && now - note->burst_from_ms >= burst_ms) {
            log_warning("%" PRId64 " times more, %s: %s: %s", note->unlogged, note->about,
                        note->code, note->message);
            note->unlogged = 0;
        }
    }
}

/* ---- the list ---- */

static sheard_msg_problem *add(problem_list *list, const char *about, const char *code) {
    if (list->n == PROBLEMS_TOLD) {
        return NULL;
    }
    sheard_msg_problem *p = &list->items[list->n];
    *p = (sheard_msg_problem){
        .about = about, .code = code, .message = list->texts[list->n], .count = 1};
    list->lines[list->n] = list->texts[list->n];
    list->texts[list->n][0] = '\0';
    list->n++;
    return p;
}

static char *text_of(problem_list *list) {
    return list->texts[list->n - 1];
}

static void add_store(const service *s, problem_list *list) {
    const problem_note *note = find_note(s, "store", NULL);
    sheard_msg_problem *p = note != NULL ? add(list, "store", note->code) : NULL;
    if (p != NULL) {
        p->since_ms = note->since_ms;
        p->count = note->count;
        p->next_attempt_ms = wall_ms() + 1000; /* every tick */
        snprintf(text_of(list), PROBLEM_TEXT, "the store: %s", note->message);
    }
}

static void add_waiting(service *s, problem_list *list) {
    shear_error ignored;
    if (store_waiting_reasons(s->store, list->waiting, PROBLEM_REASONS, &list->n_waiting,
                              &ignored) != SHEAR_OK) {
        return;
    }
    for (size_t i = 0; i < list->n_waiting; i++) {
        const store_waiting *w = &list->waiting[i];
        const problem_note *note = find_note(s, "jobs", w->code);
        sheard_msg_problem *p = add(list, "jobs", w->code);
        if (p == NULL) {
            return;
        }
        p->since_ms = note != NULL ? note->since_ms : s->started_ms;
        p->count = w->jobs;
        p->attempts = w->attempts;
        p->next_attempt_ms = w->next_ms;
        snprintf(text_of(list), PROBLEM_TEXT, "%" PRId64 " %s (%s): %.300s", w->jobs,
                 w->jobs == 1 ? "job waits" : "jobs wait", w->code, w->message);
    }
}

static void add_spool(const service *s, problem_list *list) {
    const spool_stats st = spool_get_stats(s->spool);
    spool_ignored first;
    const problem_note *note = find_note(s, "spool", NULL);
    sheard_msg_problem *p;
    if (st.trouble[0] != '\0' && (p = add(list, "spool", "io")) != NULL) {
        p->since_ms = st.trouble_since_ms;
        snprintf(text_of(list), PROBLEM_TEXT, "the watch folder: %.300s", st.trouble);
    } else if (!st.watching && add(list, "spool", "not_watched") != NULL) {
        snprintf(text_of(list), PROBLEM_TEXT,
                 "the watch folder: the kernel does not announce files there; they are found by "
                 "searching it only ([spool] scan_interval)");
    }
    if (note != NULL && st.active > 0 && (p = add(list, "spool", note->code)) != NULL) {
        p->since_ms = note->since_ms;
        p->count = note->count;
        snprintf(text_of(list), PROBLEM_TEXT, "files wait in active/ (%s): %.300s", note->code,
                 note->message);
    }
    if (spool_get_ignored(s->spool, &first, 1) > 0 &&
        (p = add(list, "incoming", "ignored_files")) != NULL) {
        p->count = st.ignored;
        snprintf(text_of(list), PROBLEM_TEXT, "%" PRId64 " %s in incoming/: %.200s: %s", st.ignored,
                 st.ignored == 1 ? "file is left lying" : "files are left lying", first.name,
                 first.reason);
    }
}

static void add_disks(problem_list *list) {
    for (size_t i = 0; i < list->n_disks; i++) {
        const sheard_msg_disk *d = &list->disks[i];
        if (d->problem != NULL && add(list, "disk", "unusable") != NULL) {
            snprintf(text_of(list), PROBLEM_TEXT, "%s, %.200s: %s", d->use, d->path, d->problem);
        } else if (d->problem == NULL && d->same_as == NULL && disk_is_full(d) &&
                   add(list, "disk", "disk_full") != NULL) {
            snprintf(text_of(list), PROBLEM_TEXT, "%s, %.200s: only %" PRId64 " KiB are free",
                     d->use, d->path, d->free_bytes / 1024);
        }
    }
}

static void add_log(problem_list *list, const log_losses *log) {
    sheard_msg_problem *p = log->untold > 0 ? add(list, "log", "log_stalled") : NULL;
    if (p != NULL) {
        p->since_ms = log->since_ms;
        p->count = log->untold;
        snprintf(text_of(list), PROBLEM_TEXT,
                 "nobody reads the log: %" PRId64 " lines of it are lost", log->untold);
    }
}

static void add_roots(const service *s, problem_list *list) {
    const char *reasons[PROBLEMS_TOLD];
    const size_t n = roots_problems(s, reasons, PROBLEMS_TOLD);
    for (size_t i = 0; i < n && add(list, "root", "root_missing") != NULL; i++) {
        snprintf(text_of(list), PROBLEM_TEXT, "%s", reasons[i]);
    }
}

problem_list *problems_look(service *s, shear_error *err) {
    problem_list *list = calloc(1, sizeof *list);
    if (list == NULL) {
        shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for what is to be told");
        return NULL;
    }
    const log_losses log = log_get_losses();
    list->n_disks = disks_look(s, list->disks);
    add_store(s, list);
    add_waiting(s, list);
    add_disks(list);
    if (s->spool != NULL) {
        add_spool(s, list);
    }
    add_log(list, &log);
    add_roots(s, list);
    return list;
}
