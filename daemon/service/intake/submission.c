/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/intake/submission.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "service/core/clock.h"
#include "service/core/parts.h"
#include "service/jobs/job_source.h"
#include "service/jobs/rpc_errors.h"

static void digest(const void *bytes, size_t n, char *hex, size_t size) {
    char sum[SHEAR_CHECKSUM_SIZE];
    shear_bytes_checksum(bytes, n, sum);
    snprintf(hex, size, "%s", sum);
}

/* Store the job. `groups` are the peer's, as text; NULL: the file is the service's own. */
static int put(service *s, const submission *sub, const sheard_msg_source *named,
               const char *groups, const shear_settings *settings, int64_t *id, bool *known,
               sheard_rpc_error *error) {
    char text[SHEARD_MSG_SETTINGS_SIZE];
    char hex[33];
    CLEANUP(release_free) char *source = NULL;
    shear_error err = {0};
    if (sheard_settings_write(settings, text, sizeof text, &err) != SHEAR_OK ||
        sheard_settings_digest(settings, digest, hex, sizeof hex, &err) != SHEAR_OK) {
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_SETTING, NULL, "%s", err.message);
    }
    TRY(sheard_source_text(&source, named, error));
    const store_spec spec = {.field = sub->submit->field,
                             .source = source,
                             .settings = text,
                             .settings_digest = hex,
                             .key = sub->key,
                             .dropped = sub->dropped,
                             .origin = sub->origin,
                             .priority = (int)sub->submit->priority,
                             .force = sub->submit->force,
                             .owner = sub->peer.uid,
                             .gid = sub->peer.gid,
                             .groups = groups,
                             .created_ms = clock_wall_ms()};
    TRY(rpc_error_from_store(error, group_begin(&s->group, &err), &err));
    const int code = store_submit(s->store, &spec, s->config.limits.queue, id, known, &err);
    return rpc_error_from_store(error, code, &err);
}

/* Check that the peer may read the files, by opening them, and store the job. */
static int put_clients(service *s, const submission *sub, const shear_settings *settings,
                       int64_t *id, bool *known, sheard_rpc_error *error) {
    CLEANUP(source_files_deinit) source_files files = SOURCE_FILES_NONE;
    CLEANUP(release_free) char *groups = NULL;
    shear_error err = {0};
    const int code = source_files_open(s, &sub->peer, &sub->submit->source, &files, &err);
    if (code != SHEAR_OK) {
        rpc_error_from_access(error, code, &err);
        if (files.part >= 0) {
            sheard_source_parameter(&sub->submit->source, files.part, "path", error->parameter,
                                    sizeof error->parameter);
        } else {
            snprintf(error->parameter, sizeof error->parameter, "path");
        }
        return error->code;
    }
    if (access_peer_groups_text(&sub->peer, &groups, &err) != SHEAR_OK)
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "%s", err.message);
    return put(s, sub, &files.named, groups, settings, id, known, error);
}

int submission_store(service *s, const submission *sub, int64_t *id, bool *known,
                     sheard_rpc_error *error) {
    shear_settings settings = s->config.measure;
    shear_error err = {0};
    if (sheard_settings_apply(&settings, sub->submit->settings, &err) != SHEAR_OK)
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_SETTING, err.advice, "%s", err.message);
    if (sub->submit->priority > 0 && !permissions_may_give_priority(&s->permissions, &sub->peer)) {
        sheard_rpc_fail(error, SHEARD_RPC_PRIORITY_NOT_ALLOWED, NULL,
                        "'priority': you may give 0 and below, not %lld ([access] priority_users, "
                        "priority_groups)",
                        (long long)sub->submit->priority);
        text_set(error->parameter, sizeof error->parameter, "priority");
        return error->code;
    }
    if (sub->source != NULL) {
        const sheard_msg_source own = {.path = sub->source};
        return put(s, sub, &own, NULL, &settings, id, known, error);
    }
    return put_clients(s, sub, &settings, id, known, error);
}
