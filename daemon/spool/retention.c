/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool/retention.h"

#include "base/array.h"
#include "spool/internal.h"
#include "spool/report.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const int64_t ns_per_s = 1000000000;
static const int64_t ns_per_ms = 1000000;

void retention_init(retention *w) {
    *w = (retention){.folder = N_FOLDERS};
}

void retention_deinit(retention *w) {
    assert(w->n == 0 || w->items != NULL);
    for (size_t i = 0; i < w->n; i++)
        free(w->items[i].name);
    free(w->items);
    folder_list_close(&w->dir);
    retention_init(w);
}

static bool is_idle(const retention *w) {
    return w->folder == N_FOLDERS;
}

void retention_begin(retention *w) {
    if (is_idle(w))
        w->folder = DONE;
}

static const sheard_keep *limits(const spool *s) {
    return s->retention.folder == DONE ? &s->tuning.done : &s->tuning.failed;
}

/* ---- reading ---- */

static int64_t to_ns(struct timespec t) {
    return (int64_t)t.tv_sec * ns_per_s + t.tv_nsec;
}

static bool append(retention *w, const char *name, const struct stat *st) {
    char *copy = ARRAY_RESERVE(w->items, w->capacity, w->n + 1) ? strdup(name) : NULL;
    if (copy == NULL)
        return false;
    /* The file's status change is its move to this folder, and later than its modification. The
     * report's modification time, if there is a report, is used instead. */
    w->items[w->n++] = (ended_file){.name = copy,
                                    .inode = st->st_ino,
                                    .modified_ns = to_ns(st->st_mtim),
                                    .ended_ns = to_ns(st->st_ctim),
                                    .bytes = st->st_size};
    return true;
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const ended_file *)a)->name, ((const ended_file *)b)->name);
}

static int by_time(const void *a, const void *b) {
    const ended_file *x = a;
    const ended_file *y = b;
    return x->ended_ns != y->ended_ns ? (x->ended_ns > y->ended_ns) - (x->ended_ns < y->ended_ns)
                                      : by_name(a, b);
}

/* A name sorts before the name of its report. So a report is recognised before it could be taken
 * for a job file that has a report of its own. */
static void pair_with_reports(retention *w) {
    for (size_t i = 0; i < w->n; i++) {
        char name[NAME_REPORT_SIZE];
        ended_file *item = &w->items[i];
        name_report(name, item->name);
        const ended_file key = {.name = name};
        ended_file *report =
            item->is_report ? NULL : bsearch(&key, w->items, w->n, sizeof key, by_name);
        if (report != NULL) {
            report->is_report = true;
            item->has_report = true;
            item->bytes += report->bytes;
            item->ended_ns = report->modified_ns;
        }
    }
}

static void sort_out(retention *w) {
    size_t kept = 0;
    if (w->n == 0)
        return;
    qsort(w->items, w->n, sizeof *w->items, by_name);
    pair_with_reports(w);
    for (size_t i = 0; i < w->n; i++) {
        if (w->items[i].is_report) {
            free(w->items[i].name);
        } else {
            w->bytes += w->items[i].bytes;
            w->items[kept++] = w->items[i];
        }
    }
    w->n = kept;
    qsort(w->items, w->n, sizeof *w->items, by_time);
}

static void end_folder(retention *w) {
    const enum folder next = w->folder + 1;
    retention_deinit(w);
    w->folder = next;
}

static void end_reading(retention *w) {
    folder_list_close(&w->dir);
    w->dir = NULL;
    sort_out(w);
    if (w->n == 0)
        end_folder(w);
}

/* Add a file that this service has, or could have, put there; others are neither counted nor
 * removed. Return false if out of memory. */
static bool read_name(spool *s, const char *name) {
    struct stat st;
    const enum name_status status = name_validate(name);
    if ((status != NAME_GOOD && status != NAME_LONG) ||
        folder_stat(&s->folders, s->retention.folder, name, &st) != 0 || !S_ISREG(st.st_mode)) {
        return true;
    }
    return append(&s->retention, name, &st);
}

static void read_some(spool *s) {
    retention *w = &s->retention;
    for (int i = 0; i < SPOOL_STEP_NAMES; i++) {
        const struct dirent *entry = readdir(w->dir);
        if (entry == NULL) {
            end_reading(w);
            return;
        }
        if (!read_name(s, entry->d_name)) {
            report_line(s, SPOOL_WARNING, "%s/%s: out of memory while looking for old files",
                        s->folders.path, folder_name(w->folder));
            end_folder(w);
            return;
        }
    }
}

/* ---- removing ---- */

static bool too_much(const retention *w, const sheard_keep *keep, int64_t now_ns) {
    if (w->next == w->n)
        return false;
    const int64_t age_ms = (now_ns - w->items[w->next].ended_ns) / ns_per_ms;
    return (keep->max_age_ms > 0 && age_ms > keep->max_age_ms) ||
           (keep->max_count > 0 && (int64_t)(w->n - w->next) > keep->max_count) ||
           (keep->max_bytes > 0 && w->bytes > keep->max_bytes);
}

/* Remove the file first, so that no file is ever without its report. */
static void remove_item(spool *s, const ended_file *item) {
    const enum folder folder = s->retention.folder;
    const int fd = s->folders.fd[folder];
    struct stat st;
    if (folder_stat(&s->folders, folder, item->name, &st) != 0 || st.st_ino != item->inode) {
        return; /* somebody else has removed it, and a newer file may have the name */
    }
    if (unlinkat(fd, item->name, 0) != 0) {
        report_line(s, SPOOL_WARNING, "%s/%s/%s: cannot be removed: %s", s->folders.path,
                    folder_name(folder), item->name, strerror(errno));
        return;
    }
    s->stats.removed++;
    if (item->has_report) {
        char report[NAME_REPORT_SIZE];
        name_report(report, item->name);
        unlinkat(fd, report, 0);
    }
}

static bool remove_some(spool *s) {
    retention *w = &s->retention;
    const int64_t now_ns = s->call.now_ms(s->call.context) * ns_per_ms;
    for (int i = 0; i < SPOOL_STEP_FILES && too_much(w, limits(s), now_ns); i++) {
        remove_item(s, &w->items[w->next]);
        w->bytes -= w->items[w->next].bytes;
        w->next++;
    }
    if (!too_much(w, limits(s), now_ns))
        end_folder(w);
    return !is_idle(w);
}

bool retention_step(spool *s) {
    retention *w = &s->retention;
    if (is_idle(w))
        return false;
    if (w->dir != NULL) {
        read_some(s);
        return true;
    }
    if (w->items != NULL)
        return remove_some(s);
    const sheard_keep *keep = limits(s);
    const bool limited = keep->max_age_ms > 0 || keep->max_count > 0 || keep->max_bytes > 0;
    w->dir = limited ? folder_list(&s->folders, w->folder) : NULL;
    if (w->dir == NULL)
        end_folder(w);
    return !is_idle(w);
}
