/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/field_report.h"

#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/active_jobs.h"
#include "sheard/account.h"
#include "sheard/advice.h"
#include "sheard/report.h"

#include <math.h>

/* Parse the account of a contribution. If it is missing (the job was retired before there were
 * accounts) or cannot be read, use what the contribution itself has. */
static void read_account(const store_contribution *c, sheard_account *account) {
    shear_error ignored;
    if (c->account == NULL || sheard_account_parse(account, c->account, &ignored) != SHEAR_OK) {
        *account = (sheard_account){.file = {.checksum = c->content,
                                             .n_stamps = c->n_stamps,
                                             .n_used = c->n_used,
                                             .seconds = (double)NAN}};
    }
}

/* Return the first job from j on whose file is being measured for the field, or NULL. */
static const active_job *next_of(const active_job *j, const store_field *f) {
    while (j != NULL &&
           (j->checksum[0] == '\0' || !active_job_is_of(j, f->name, f->settings_digest))) {
        j = j->next;
    }
    return j;
}

/* Get the account of the first file that was counted, for its plan; if none was, the plan of a file
 * that is being measured. */
static int first_plan(const service *s, const store_field *f, sheard_account *first,
                      shear_error *err) {
    CLEANUP(store_contribution_page_deinit) store_contribution_page page = {0};
    *first = (sheard_account){.texts = NULL};
    if (f->jobs == 0) {
        const active_job *j = next_of(s->jobs->first, f);
        if (j != NULL) {
            first->plan = j->plan;
            first->file.plan = &first->plan;
        }
        return SHEAR_OK;
    }
    TRY(store_contributions(s->store, f->name, f->settings_digest, 0, 1, &page, err));
    if (page.n == 0)
        return SHEAR_OK;
    read_account(&page.items[0], first);
    first->file.checksum = NULL; /* it may belong to the page */
    return SHEAR_OK;
}

/* Get the truth that all files share, including those that are being measured. */
static int shared_truth(const service *s, const store_field *f, store_truth *truth,
                        shear_error *err) {
    bool any = f->jobs > 0;
    *truth = (store_truth){.known = false};
    if (any)
        TRY(store_field_truth(s->store, f->name, f->settings_digest, truth, err));
    for (const active_job *j = s->jobs->first; (j = next_of(j, f)) != NULL; j = j->next) {
        const shear_field_info *info = &j->info;
        if (!any) {
            *truth = (store_truth){info->has_truth, info->sim_g1, info->sim_g2};
            any = true;
        } else {
            truth->known = truth->known && info->has_truth && info->sim_g1 == truth->g1 &&
                           info->sim_g2 == truth->g2;
        }
    }
    return SHEAR_OK;
}

/* Return the path of the file whose stamp counts most, malloc'd, or NULL if it is not known. */
static char *find_top_file(const service *s, const store_field *f, const shear_result *r) {
    CLEANUP(release_free) char *text = NULL;
    CLEANUP(sheard_account_deinit) sheard_account account = {0};
    shear_influence top = {.stamp = -1};
    shear_error ignored;
    if (f->jobs == 0) {
        const active_job *j = next_of(s->jobs->first, f);
        return j != NULL && r->top_stamp >= 0 ? strdup(j->path) : NULL;
    }
    if (store_field_top(s->store, f->name, f->settings_digest, &top, &text, &ignored) != SHEAR_OK ||
        top.stamp != r->top_stamp || top.size != r->top_size || /* that stamp is of a running job */
        text == NULL || sheard_account_parse(&account, text, &ignored) != SHEAR_OK) {
        return NULL;
    }
    return account.file.path != NULL ? strdup(account.file.path) : NULL;
}

/* Warnings about the field and its files' PSFs. */
typedef struct warning_list {
    sheard_advice_list advice;
    char others[SHEARD_ADVICE_SIZE];
    const char *lines[SHEARD_ADVICES + 1]; /* [n] */
    size_t n;
} warning_list;

static void say(warning_list *w, const shear_result *result, const sheard_account *first,
                const char *top_file, const sheard_report_file *files, size_t n) {
    sheard_advice_all(&w->advice, result, first->file.plan, top_file);
    memcpy(w->lines, w->advice.lines, w->advice.n * sizeof *w->lines);
    w->n = w->advice.n;
    if (sheard_advice_other_psfs(files, n, first->file.path, w->others, sizeof w->others) != NULL)
        w->lines[w->n++] = w->others;
}

/* The accounts of what was counted, and the list of their files. */
typedef struct listed {
    sheard_account *accounts; /* [n], owned */
    sheard_report_file *files;
    size_t n;
} listed;

static void listed_deinit(listed *l) {
    for (size_t i = 0; i < l->n; i++)
        sheard_account_deinit(&l->accounts[i]);
    free(l->accounts);
    free(l->files);
}

static int listed_init(listed *l, const store_contribution_page *counted, shear_error *err) {
    *l = (listed){.accounts = calloc(counted->n + 1, sizeof *l->accounts),
                  .files = calloc(counted->n + 1, sizeof *l->files)};
    if (l->accounts == NULL || l->files == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the files of a field");
    for (; l->n < counted->n; l->n++) {
        read_account(&counted->items[l->n], &l->accounts[l->n]);
        l->files[l->n] = l->accounts[l->n].file;
    }
    return SHEAR_OK;
}

int field_report(const service *s, const store_field *f, const shear_settings *settings,
                 const shear_result *result, const store_contribution_page *counted, char **text,
                 shear_error *err) {
    CLEANUP(sheard_account_deinit) sheard_account first = {0};
    CLEANUP(listed_deinit) listed files = {0};
    warning_list said;
    store_truth truth;
    TRY(listed_init(&files, counted, err));
    TRY(shared_truth(s, f, &truth, err));
    TRY(first_plan(s, f, &first, err));
    CLEANUP(release_free) char *top_file = find_top_file(s, f, result);
    say(&said, result, &first, f->jobs > 1 ? top_file : NULL, files.files, files.n);
    const sheard_report report = {.field = f->name,
                                  .result = result,
                                  .settings = settings,
                                  .plan = first.file.plan,
                                  .files = files.files,
                                  .n_files = files.n,
                                  .top_file = top_file,
                                  .has_truth = truth.known,
                                  .true_g1 = truth.g1,
                                  .true_g2 = truth.g2,
                                  .warnings = said.lines,
                                  .n_warnings = said.n,
                                  .seconds = 1e-6 * (double)f->elapsed_us};
    return sheard_report_json(text, &report, err);
}
