/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of a field, from what the store keeps of its files: the same that `shearctl measure`
 * writes of them. */
#include "service/inner.h"

#include "sheard/account.h"
#include "sheard/advice.h"
#include "sheard/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An account that is not there (of a job that was retired before there were accounts), or cannot be
 * read, leaves what the contribution itself says. */
static void read_account(const store_contribution *c, sheard_account *account) {
    shear_error ignored;
    if (c->account == NULL || sheard_account_parse(account, c->account, &ignored) != SHEAR_OK) {
        *account = (sheard_account){.file = {.checksum = c->content,
                                             .n_stamps = c->n_stamps,
                                             .n_used = c->n_used,
                                             .seconds = (double)NAN}};
    }
}

static bool is_of(const active_job *j, const store_field *f) {
    return !j->ended && j->checksum[0] != '\0' && j->field != NULL &&
           strcmp(j->field, f->name) == 0 && strcmp(j->digest, f->settings_digest) == 0;
}

/* The plan of the first file that was counted, or else of one that is being measured. */
static int first_plan(service *s, const store_field *f, sheard_account *first, shear_error *err) {
    store_contribution_page page = {0};
    int code = SHEAR_OK;
    *first = (sheard_account){.texts = NULL};
    if (f->jobs > 0) {
        code = store_contributions(s->store, f->name, f->settings_digest, 0, 1, &page, err);
    }
    if (code == SHEAR_OK && page.n > 0) {
        read_account(&page.items[0], first);
    }
    store_contribution_page_deinit(&page);
    first->file.checksum = NULL; /* it may have been the page's */
    for (const active_job *j = s->active; j != NULL && f->jobs == 0 && first->file.plan == NULL;
         j = j->next) {
        if (is_of(j, f)) {
            first->plan = j->plan;
            first->file.plan = &first->plan;
        }
    }
    return code;
}

/* The truth that all files share, those that are being measured included. */
static int shared_truth(service *s, const store_field *f, store_truth *truth, shear_error *err) {
    bool any = f->jobs > 0;
    int code = SHEAR_OK;
    *truth = (store_truth){.known = false};
    if (any) {
        code = store_field_truth(s->store, f->name, f->settings_digest, truth, err);
    }
    for (const active_job *j = s->active; j != NULL; j = j->next) {
        const shear_field_info *info = &j->info;
        if (!is_of(j, f)) {
            continue;
        }
        if (!any) {
            *truth = (store_truth){info->has_truth, info->sim_g1, info->sim_g2};
            any = true;
        } else {
            truth->known = truth->known && info->has_truth && info->sim_g1 == truth->g1 &&
                           info->sim_g2 == truth->g2;
        }
    }
    return code;
}

/* The path of the file whose stamp counts most: of what was counted, or of the one that is being
 * measured. NULL: not known. The caller's. */
static char *find_top_file(service *s, const store_field *f, const shear_result *r) {
    shear_influence top = {.stamp = -1};
    char *account_text = NULL;
    char *path = NULL;
    sheard_account account;
    shear_error ignored;
    if (f->jobs == 0) {
        const active_job *j = s->active;
        for (; j != NULL && !is_of(j, f); j = j->next) {
        }
        return j != NULL && r->top_stamp >= 0 ? strdup(j->path) : NULL;
    }
    const int code =
        store_field_top(s->store, f->name, f->settings_digest, &top, &account_text, &ignored);
    const bool is_it = code == SHEAR_OK && top.stamp == r->top_stamp &&
                       top.size == r->top_size; /* not of a job that runs */
    if (is_it && account_text != NULL &&
        sheard_account_parse(&account, account_text, &ignored) == SHEAR_OK) {
        path = account.file.path != NULL ? strdup(account.file.path) : NULL;
        sheard_account_deinit(&account);
    }
    free(account_text);
    return path;
}

/* What is said of the field, and of its files' PSFs. */
typedef struct warnings_said {
    sheard_advice_list advice;
    char others[SHEARD_ADVICE_SIZE];
    const char *lines[SHEARD_ADVICES + 1]; /* [n] */
    size_t n;
} warnings_said;

static void say(warnings_said *w, const shear_result *result, const sheard_account *first,
                const char *top_file, const sheard_report_file *files, size_t n) {
    sheard_advice_all(&w->advice, result, first->file.plan, top_file);
    memcpy(w->lines, w->advice.lines, w->advice.n * sizeof *w->lines);
    w->n = w->advice.n;
    if (sheard_advice_other_psfs(files, n, first->file.path, w->others, sizeof w->others) != NULL) {
        w->lines[w->n++] = w->others;
    }
}

static int write_report(const store_field *f, const shear_settings *settings,
                        const shear_result *result, const sheard_account *first,
                        const store_truth *truth, const char *top_file,
                        const sheard_report_file *files, size_t n, char **text, shear_error *err) {
    warnings_said said;
    say(&said, result, first, f->jobs > 1 ? top_file : NULL, files, n);
    const sheard_report report = {.field = f->name,
                                  .result = result,
                                  .settings = settings,
                                  .plan = first->file.plan,
                                  .files = files,
                                  .n_files = n,
                                  .top_file = top_file,
                                  .has_truth = truth->known,
                                  .true_g1 = truth->g1,
                                  .true_g2 = truth->g2,
                                  .warnings = said.lines,
                                  .n_warnings = said.n,
                                  .seconds = 1e-6 * (double)f->elapsed_us};
    return sheard_report_json(text, &report, err);
}

/* The accounts of what was counted, and their files. */
typedef struct listed {
    sheard_account *accounts; /* [n] */
    sheard_report_file *files;
    size_t n;
} listed;

static void listed_deinit(listed *l) {
    for (size_t i = 0; i < l->n; i++) {
        sheard_account_deinit(&l->accounts[i]);
    }
    free(l->accounts);
    free(l->files);
}

static int listed_init(listed *l, const store_contribution_page *counted, shear_error *err) {
    *l = (listed){.accounts = calloc(counted->n + 1, sizeof *l->accounts),
                  .files = calloc(counted->n + 1, sizeof *l->files)};
    if (l->accounts == NULL || l->files == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the files of a field");
    }
    for (; l->n < counted->n; l->n++) {
        read_account(&counted->items[l->n], &l->accounts[l->n]);
        l->files[l->n] = l->accounts[l->n].file;
    }
    return SHEAR_OK;
}

int field_report(service *s, const store_field *f, const shear_settings *settings,
                 const shear_result *result, const store_contribution_page *counted, char **text,
                 shear_error *err) {
    sheard_account first;
    store_truth truth;
    listed files;
    int code = listed_init(&files, counted, err);
    if (code == SHEAR_OK) {
        code = shared_truth(s, f, &truth, err);
    }
    if (code == SHEAR_OK) {
        code = first_plan(s, f, &first, err);
        if (code == SHEAR_OK) {
            char *top_file = find_top_file(s, f, result);
            code = write_report(f, settings, result, &first, &truth, top_file, files.files, files.n,
                                text, err);
            free(top_file);
        }
        sheard_account_deinit(&first);
    }
    listed_deinit(&files);
    return code;
}
