/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/no_result.h"

#include "base/cleanup.h"
#include "service/jobs/spooled_file.h"
#include "sheard/messages.h"
#include "sheard/no_shear.h"
#include "sheard/rpc.h"

#include <inttypes.h>
#include <math.h>

const char *no_result_brief(const store_field *f, const shear_result *r) {
    if (r->valid)
        return NULL;
    if (f->jobs == 0 && r->n_stamps == 0)
        return "nothing is counted yet";
    const char *brief = sheard_no_shear_brief(r);
    return brief != NULL ? brief : "there is no result";
}

/* Smaller is worse, and NaN is worst. */
static bool is_worse(double a, double b) {
    return isnan(a) ? !isnan(b) : a < b;
}

static int look_at(no_result *r, store *s, const store_contribution *c, shear_error *err) {
    CLEANUP(release_free) char *text = NULL;
    shear_field_sums *sums = NULL;
    shear_result own;
    TRY(store_contribution_sums(s, c->id, &text, err));
    TRY(shear_field_sums_parse(&sums, text, err));
    shear_field_result(sums, &own);
    shear_field_sums_free(sums);
    const bool to_blame = own.n_used > 0 && !(own.sum_d > 0.0 && isfinite(own.sum_d));
    if (to_blame && (r->contribution == 0 || is_worse(own.sum_d, r->worst_d))) {
        free(r->checksum);
        r->contribution = c->id;
        r->job = c->job;
        r->checksum = strdup(c->content);
        r->worst_d = own.sum_d;
    }
    return SHEAR_OK;
}

/* Examine the next contributions. False: there are no more, or they cannot be read. */
static bool look_at_some(no_result *r, store *s, const store_field *f) {
    enum { SOME = 32 }; /* takes about a millisecond */
    CLEANUP(store_contribution_page_deinit) store_contribution_page page = {0};
    shear_error ignored;
    if (store_contributions(s, f->name, f->settings_digest, r->seen, SOME, &page, &ignored) !=
        SHEAR_OK) {
        return false;
    }
    for (size_t i = 0; i < page.n; i++) {
        r->seen = page.items[i].id;
        if (look_at(r, s, &page.items[i], &ignored) != SHEAR_OK)
            return false;
    }
    return page.more;
}

/* Return the file's name as its owner knows it, malloc'd, or NULL: the job was retired, or out of
 * memory. */
static char *file_of(store *s, int64_t id) {
    CLEANUP(store_job_deinit) store_job job = {0};
    CLEANUP(sheard_source_deinit) sheard_msg_source source = {0};
    shear_error ignored;
    sheard_rpc_error error;
    if (store_job_get(s, id, &job, &ignored) != SHEAR_OK)
        return NULL;
    if (spooled_file_is_field(&job))
        return strdup(job.dropped);
    (void)sheard_source_parse(&source, job.source, &error); /* empty on an error */
    const char *path = source.path != NULL ? source.path : source.galaxy.path;
    return path != NULL ? strdup(path) : NULL;
}

static char *text_of(const no_result *r) {
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

void no_result_begin(no_result *r, const store_field *f, const shear_result *result) {
    *r = (no_result){.brief = no_result_brief(f, result),
                     .n_stamps = result->n_stamps,
                     .n_used = result->n_used,
                     .sum_d = result->sum_d};
    r->done = r->brief == NULL;
}

bool no_result_look(no_result *r, store *s, const store_field *f) {
    const bool blames = f->jobs > 0 && r->n_used >= 2;
    if (r->done)
        return true;
    if (blames && look_at_some(r, s, f))
        return false;
    r->file = r->contribution != 0 ? file_of(s, r->job) : NULL;
    r->text = text_of(r);
    r->done = true;
    return true;
}

void no_result_deinit(no_result *r) {
    free(r->text);
    free(r->file);
    free(r->checksum);
    *r = (no_result){.done = true};
}
