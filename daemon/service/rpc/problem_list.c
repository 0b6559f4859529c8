/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/problem_list.h"

#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"

#include <inttypes.h>
#include <stdlib.h>

static sheard_msg_problem *add(problem_list *list, const char *about, const char *code) {
    if (list->n == PROBLEMS_TOLD)
        return NULL;
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
    const problem_note *note = problem_note_find(&s->notes, "store", NULL);
    sheard_msg_problem *p = note != NULL ? add(list, "store", note->code) : NULL;
    if (p != NULL) {
        p->since_ms = note->since_ms;
        p->count = note->count;
        p->next_attempt_ms = clock_wall_ms() + 1000; /* tried at every tick */
        snprintf(text_of(list), PROBLEM_TEXT, "the store: %s", note->message);
    }
}

static void add_waiting(const service *s, problem_list *list) {
    shear_error ignored;
    if (store_waiting_reasons(s->store, list->waiting, PROBLEM_REASONS, &list->n_waiting,
                              &ignored) != SHEAR_OK) {
        return;
    }
    for (size_t i = 0; i < list->n_waiting; i++) {
        const store_waiting *w = &list->waiting[i];
        const problem_note *note = problem_note_find(&s->notes, "jobs", w->code);
        sheard_msg_problem *p = add(list, "jobs", w->code);
        if (p == NULL)
            return;
        p->since_ms = note != NULL ? note->since_ms : s->started_wall_ms;
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
    const problem_note *note = problem_note_find(&s->notes, "spool", NULL);
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
    const size_t n = data_roots_missing(&s->roots, reasons, PROBLEMS_TOLD);
    for (size_t i = 0; i < n && add(list, "root", "root_missing") != NULL; i++)
        snprintf(text_of(list), PROBLEM_TEXT, "%s", reasons[i]);
}

problem_list *problem_list_new(const service *s) {
    problem_list *list = calloc(1, sizeof *list);
    if (list == NULL)
        return NULL;
    const log_losses log = log_get_losses();
    list->n_disks = disks_get(s, list->disks);
    add_store(s, list);
    add_waiting(s, list);
    add_disks(list);
    if (s->spool != NULL)
        add_spool(s, list);
    add_log(list, &log);
    add_roots(s, list);
    return list;
}
