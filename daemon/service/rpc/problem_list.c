/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/rpc/problem_list.h"

#include "log/log.h"
#include "service/core/clock.h"
#include "service/core/parts.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* Add a problem, with a message as of printf, and return it. If the list is full, the problem is
 * left out, and what the caller writes is lost. */
static __attribute__((format(printf, 4, 5))) sheard_msg_problem *
add(problem_list *list, const char *about, const char *code, const char *format, ...) {
    const size_t i = list->n;
    va_list args;
    va_start(args, format);
    vsnprintf(list->texts[i], PROBLEM_TEXT, format, args);
    va_end(args);
    list->lines[i] = list->texts[i];
    list->items[i] =
        (sheard_msg_problem){.about = about, .code = code, .message = list->texts[i], .count = 1};
    list->n += i < PROBLEMS_TOLD;
    return &list->items[i];
}

static void add_store(const service *s, problem_list *list) {
    const problem_note *note = problem_note_find(&s->notes, "store", NULL);
    if (note == NULL)
        return;
    sheard_msg_problem *p = add(list, "store", note->code, "the store: %s", note->message);
    p->since_ms = note->since_ms;
    p->count = note->count;
    p->next_attempt_ms = clock_wall_ms() + 1000; /* tried at every tick */
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
        sheard_msg_problem *p = add(list, "jobs", w->code, "%" PRId64 " %s (%s): %.300s", w->jobs,
                                    w->jobs == 1 ? "job waits" : "jobs wait", w->code, w->message);
        p->since_ms = note != NULL ? note->since_ms : s->started_wall_ms;
        p->count = w->jobs;
        p->attempts = w->attempts;
        p->next_attempt_ms = w->next_ms;
    }
}

static void add_spool(const service *s, problem_list *list) {
    const spool_stats st = spool_get_stats(s->spool);
    spool_ignored first;
    const problem_note *note = problem_note_find(&s->notes, "spool", NULL);
    sheard_msg_problem *p;
    if (st.trouble[0] != '\0') {
        p = add(list, "spool", "io", "the watch folder: %.300s", st.trouble);
        p->since_ms = st.trouble_since_ms;
    } else if (!st.watching) {
        add(list, "spool", "not_watched",
            "the watch folder: the kernel does not announce files there; they are found by "
            "searching it only ([spool] scan_interval)");
    }
    if (note != NULL && st.active > 0) {
        p = add(list, "spool", note->code, "files wait in active/ (%s): %.300s", note->code,
                note->message);
        p->since_ms = note->since_ms;
        p->count = note->count;
    }
    if (spool_get_ignored(s->spool, &first, 1) > 0) {
        p = add(list, "incoming", "ignored_files", "%" PRId64 " %s in incoming/: %.200s: %s",
                st.ignored, st.ignored == 1 ? "file is left lying" : "files are left lying",
                first.name, first.reason);
        p->count = st.ignored;
    }
}

static void add_disks(problem_list *list) {
    for (size_t i = 0; i < list->n_disks; i++) {
        const sheard_msg_disk *d = &list->disks[i];
        if (d->problem != NULL) {
            add(list, "disk", "unusable", "%s, %.200s: %s", d->use, d->path, d->problem);
        } else if (d->same_as == NULL && disk_is_full(d)) {
            add(list, "disk", "disk_full", "%s, %.200s: only %" PRId64 " KiB are free", d->use,
                d->path, d->free_bytes / 1024);
        }
    }
}

static void add_log(problem_list *list) {
    const log_losses log = log_get_losses();
    if (log.untold == 0)
        return;
    sheard_msg_problem *p =
        add(list, "log", "log_stalled", "nobody reads the log: %" PRId64 " lines of it are lost",
            log.untold);
    p->since_ms = log.since_ms;
    p->count = log.untold;
}

static void add_roots(const service *s, problem_list *list) {
    const char *reasons[PROBLEMS_TOLD];
    const size_t n = data_roots_missing(&s->roots, reasons, PROBLEMS_TOLD);
    for (size_t i = 0; i < n; i++)
        add(list, "root", "root_missing", "%s", reasons[i]);
}

problem_list *problem_list_new(const service *s) {
    problem_list *list = calloc(1, sizeof *list);
    if (list == NULL)
        return NULL;
    list->n_disks = disks_get(s, list->disks);
    add_store(s, list);
    add_waiting(s, list);
    add_disks(list);
    if (s->spool != NULL)
        add_spool(s, list);
    add_log(list);
    add_roots(s, list);
    return list;
}
