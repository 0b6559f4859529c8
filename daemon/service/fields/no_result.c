/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Why a field has no result, and whose contribution it is. g = sum w N / sum w D needs two stamps
 * and a sum of w D above 0: one file of absurd pixels can take that away from all the others. */
#include "service/inner.h"

#include "sheard/no_shear.h"

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
    const char *brief = sheard_no_shear_brief(r);
    return brief != NULL ? brief : "there is no result";
}

/* Smaller is worse, and what is no number at all the worst. */
static bool is_worse(double a, double b) {
    return isnan(a) ? !isnan(b) : a < b;
}

static int look_at(service *s, const store_contribution *c, field_reason *r, shear_error *err) {
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
        if (to_blame && (r->contribution == 0 || is_worse(own.sum_d, r->worst_d))) {
            free(r->checksum);
            r->contribution = c->id;
            r->job = c->job;
            r->checksum = strdup(c->content);
            r->worst_d = own.sum_d;
        }
    }
    shear_field_sums_free(sums);
    free(text);
    return code;
}

/* False: there are no more, or they cannot be read. */
static bool look_at_some(service *s, const store_field *f, field_reason *r) {
    enum { SOME = 32 }; /* a millisecond */
    store_contribution_page page = {0};
    shear_error ignored;
    int code =
        store_contributions(s->store, f->name, f->settings_digest, r->seen, SOME, &page, &ignored);
    for (size_t i = 0; code == SHEAR_OK && i < page.n; i++) {
        code = look_at(s, &page.items[i], r, &ignored);
        r->seen = page.items[i].id;
    }
    const bool more = code == SHEAR_OK && page.more;
    store_contribution_page_deinit(&page);
    return more;
}

/* As its owner calls it. NULL: the job is forgotten. */
static char *file_of(service *s, int64_t id) {
    store_job job = {0};
    sheard_msg_source source = {0};
    shear_error ignored;
    sheard_rpc_error error;
    char *name = NULL;
    if (store_job_get(s->store, id, &job, &ignored) == SHEAR_OK) {
        const bool parsed = sheard_source_parse(&source, job.source, &error) == SHEARD_RPC_OK;
        const char *path = spooled_is_own(&job)  ? job.dropped
                           : source.path != NULL ? source.path
                                                 : source.galaxy.path;
        name = path != NULL ? strdup(path) : NULL;
        if (parsed) {
            sheard_source_deinit(&source);
        }
    }
    store_job_deinit(&job);
    return name;
}

static char *text_of(const field_reason *r) {
    char *text = NULL;
    int n = 0;
    if (r->n_used < 2) {
        n = asprintf(&text, "%s: %" PRId64 " of %" PRId64, r->brief, r->n_used, r->n_stamps);
    } else if (r->contribution != 0) {
        n = asprintf(&text, "%s (the sum of w D is %.3g): job %" PRId64 "%s%s alone brings %.3g",
                     r->brief, r->sum_d, r->job, r->file != NULL ? ", " : "",
                     r->file != NULL ? r->file : "", r->worst_d);
    } else {
        n = asprintf(&text, "%s", r->brief);
    }
    return n > 0 ? text : NULL;
}

void reason_begin(const store_field *f, const shear_result *result, field_reason *out) {
    *out = (field_reason){.brief = reason_brief(f, result),
                          .n_stamps = result->n_stamps,
                          .n_used = result->n_used,
                          .sum_d = result->sum_d};
    out->done = out->brief == NULL;
}

bool reason_look(service *s, const store_field *f, field_reason *r) {
    const bool blames = f->jobs > 0 && r->n_used >= 2;
    if (r->done || (blames && look_at_some(s, f, r))) {
        return r->done;
    }
    r->file = r->contribution != 0 ? file_of(s, r->job) : NULL;
    r->text = text_of(r);
    r->done = true;
    return true;
}

void reason_deinit(field_reason *r) {
    free(r->text);
    free(r->file);
    free(r->checksum);
    *r = (field_reason){.done = true};
}
