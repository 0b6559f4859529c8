/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Why a field has no result, and whose contribution it is. g = sum w N / sum w D needs two stamps
 * and a sum of w D above 0: one file of absurd pixels can take that away from all the others. */
#include "service/inner.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *reason_brief(const store_field *f, const shear_result *r) {
    if (r->valid) {
        return NULL;
    }
    if (f->jobs == 0 && r->n_stamps == 0) {
        return "nothing is counted yet";
    }
    if (r->n_used < 2) {
        return "fewer than two usable stamps";
    }
    if (!(r->sum_d > 0.0 && isfinite(r->sum_d))) {
        return "the sum of w D is not positive";
    }
    return shear_estimator_is_symmetric(r->estimator) ? "the stamps' symmetry has no solution"
                                                      : "the sums have no finite solution";
}

typedef struct worst {
    int64_t id, job;
    char *checksum;
    double sum_d;
} worst;

/* Smaller is worse, and what is no number at all the worst. */
static bool is_worse(double a, double b) {
    return isnan(a) ? !isnan(b) : a < b;
}

static int look_at(service *s, const store_contribution *c, worst *w, shear_error *err) {
    shear_field_sums *sums = NULL;
    shear_result own;
    char *text = NULL;
    int code = store_contribution_sums(s->store, c->id, &text, err);
    if (code == SHEAR_OK) {
        code = shear_field_sums_parse(&sums, text, err);
    }
    if (code == SHEAR_OK) {
        shear_field_result(sums, &own);
        const bool to_blame = own.n_used > 0 && !(own.sum_d > 0.0 && isfinite(own.sum_d));
        if (to_blame && (w->id == 0 || is_worse(own.sum_d, w->sum_d))) {
            free(w->checksum);
            *w = (worst){
                .id = c->id, .job = c->job, .checksum = strdup(c->content), .sum_d = own.sum_d};
        }
    }
    shear_field_sums_free(sums);
    free(text);
    return code;
}

/* All contributions, page by page. */
static int find_worst(service *s, const store_field *f, worst *w, shear_error *err) {
    int64_t last = 0;
    bool more = true;
    int code = SHEAR_OK;
    while (code == SHEAR_OK && more) {
        store_contribution_page page = {0};
        code = store_contributions(s->store, f->name, f->settings_digest, last, STORE_PAGE_MAX,
                                   &page, err);
        for (size_t i = 0; code == SHEAR_OK && i < page.n; i++) {
            code = look_at(s, &page.items[i], w, err);
            last = page.items[i].id;
        }
        more = page.more;
        store_contribution_page_deinit(&page);
    }
    return code;
}

/* As its owner calls it. NULL: the job is forgotten. */
static char *file_of(service *s, int64_t id) {
    store_job job = {0};
    shear_msg_source source = {0};
    shear_error ignored;
    shear_rpc_error error;
    char *name = NULL;
    if (store_job_get(s->store, id, &job, &ignored) == SHEAR_OK) {
        const bool parsed = shear_source_parse(&source, job.source, &error) == SHEAR_RPC_OK;
        const char *path = spooled_is_own(&job)  ? job.dropped
                           : source.path != NULL ? source.path
                                                 : source.galaxy.path;
        name = path != NULL ? strdup(path) : NULL;
        if (parsed) {
            shear_source_deinit(&source);
        }
    }
    store_job_deinit(&job);
    return name;
}

static char *text_of(const char *brief, const shear_result *r, const worst *w, const char *file) {
    char *text = NULL;
    int n = 0;
    if (r->n_used < 2) {
        n = asprintf(&text, "%s: %" PRId64 " of %" PRId64, brief, r->n_used, r->n_stamps);
    } else if (w->id != 0) {
        n = asprintf(&text, "%s (%.3g): job %" PRId64 "%s%s alone brings %.3g", brief, r->sum_d,
                     w->job, file != NULL ? ", " : "", file != NULL ? file : "", w->sum_d);
    } else {
        n = asprintf(&text, "%s", brief);
    }
    return n > 0 ? text : NULL;
}

void reason_find(service *s, const store_field *f, const shear_result *result, field_reason *out) {
    shear_error ignored;
    worst w = {0};
    const char *brief = reason_brief(f, result);
    *out = (field_reason){0};
    if (brief == NULL) {
        return;
    }
    if (f->jobs > 0 && result->n_used >= 2) {
        find_worst(s, f, &w, &ignored);
    }
    *out = (field_reason){.job = w.job, .contribution = w.id, .checksum = w.checksum};
    out->file = w.id != 0 ? file_of(s, w.job) : NULL;
    out->text = text_of(brief, result, &w, out->file);
}
