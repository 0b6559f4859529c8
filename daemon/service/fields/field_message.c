/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/field_message.h"

#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/fields/field_report.h"
#include "service/fields/field_result.h"

#include <math.h>

/* Return [page->n] contributions, malloc'd, or NULL if out of memory. */
static sheard_msg_contribution *contributions_of(const store_contribution_page *page) {
    sheard_msg_contribution *list = calloc(page->n + 1, sizeof *list);
    for (size_t i = 0; list != NULL && i < page->n; i++) {
        const store_contribution *c = &page->items[i];
        list[i] = (sheard_msg_contribution){.id = c->id,
                                            .job = c->job,
                                            .checksum = c->content,
                                            .n_stamps = c->n_stamps,
                                            .n_used = c->n_used,
                                            .counted_ms = c->counted_ms};
    }
    return list;
}

int field_to_message(service *s, const store_field *f, int64_t since,
                     const store_contribution_page *counted, sheard_msg_field_row *out,
                     no_result *why, shear_error *err) {
    CLEANUP(field_result_deinit) field_result now = {.jobs = 0};
    CLEANUP(release_free) char *report = NULL;
    shear_settings settings;
    TRY(sheard_settings_read(&settings, f->settings, err));
    TRY(field_result_now(s, f, &settings, since, &now, err));
    TRY(field_report(s, f, &settings, &now.result, counted, &report, err));
    sheard_msg_contribution *contributions = contributions_of(counted);
    if (contributions == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a page");
    no_result_begin(why, f, &now.result);
    *out = (sheard_msg_field_row){.report = CLEANUP_TAKE(report),
                                  .digest = f->settings_digest,
                                  .jobs = now.jobs,
                                  .unfinished = f->unfinished,
                                  .partial = f->unfinished > 0,
                                  .running = CLEANUP_TAKE(now.running),
                                  .n_running = now.n_running,
                                  .contributions = contributions,
                                  .n_contributions = counted->n,
                                  .more = counted->more,
                                  .files_left_out = f->jobs - (int64_t)counted->n,
                                  .updated_ms = f->updated_ms};
    return SHEAR_OK;
}

void field_message_deinit(sheard_msg_field_row *out) {
    free((char *)out->report);
    free((int64_t *)out->running);
    free((sheard_msg_contribution *)out->contributions);
    *out = (sheard_msg_field_row){0};
}

void field_to_summary(service *s, const store_field *f, int64_t since, sheard_msg_summary *out) {
    int64_t jobs = f->jobs;
    shear_result r = {.n_stamps = f->n_stamps, .n_used = f->n_used};
    if (f->sums == NULL ||
        field_result_counted(s, f, since, &r, &jobs, &(shear_error){0}) != SHEAR_OK) {
        r.g1 = r.g2 = r.g1_err = r.g2_err = NAN;
    }
    *out = (sheard_msg_summary){.field = f->name,
                                .digest = f->settings_digest,
                                .g1 = r.g1,
                                .g1_err = r.g1_err,
                                .g2 = r.g2,
                                .g2_err = r.g2_err,
                                .n_stamps = r.n_stamps,
                                .n_used = r.n_used,
                                .jobs = jobs,
                                .unfinished = f->unfinished,
                                .partial = f->unfinished > 0,
                                .updated_ms = f->updated_ms,
                                .reason = no_result_brief(f, &r)};
}

void field_message_publish(service *s, const store_field *f, bool mixed, int64_t since) {
    sheard_notice_params params = {0};
    field_to_summary(s, f, since, &params.field_changed.field);
    params.field_changed.field.mixed = mixed;
    server_publish(s->server, SHEARD_NOTICE_FIELD_CHANGED, 0, f->name, &params);
}
