/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/job_source.h"

#include <stdlib.h>
#include <string.h>

int rpc_from_store(sheard_rpc_error *error, int code, const shear_error *err) {
    static const struct {
        int store, rpc;
    } table[] = {
        {STORE_QUEUE_FULL, SHEARD_RPC_QUEUE_FULL},  {STORE_KEY_REUSED, SHEARD_RPC_KEY_REUSED},
        {STORE_NOT_FOUND, SHEARD_RPC_NO_SUCH_JOB},  {STORE_WRONG_STATE, SHEARD_RPC_WRONG_STATE},
        {STORE_BAD_TEXT, SHEARD_RPC_BAD_PARAMETER}, {SHEAR_E_IO, SHEARD_RPC_STORE_FAILED},
        {SHEAR_E_FULL, SHEARD_RPC_DISK_FULL},       {SHEAR_E_NOMEM, SHEARD_RPC_OUT_OF_MEMORY}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (table[i].store == code) {
            return sheard_rpc_fail(error, table[i].rpc, NULL, "%s", err->message);
        }
    }
    return sheard_rpc_fail(error, SHEARD_RPC_INTERNAL, NULL, "%s", err->message);
}

int rpc_from_access(sheard_rpc_error *error, int code, const shear_error *err) {
    int rpc = SHEARD_RPC_IO;
    switch (code) {
    case ACCESS_E_PATH:
        rpc = SHEARD_RPC_BAD_PARAMETER;
        break;
    case ACCESS_E_OUTSIDE:
        rpc = SHEARD_RPC_OUTSIDE_ROOTS;
        break;
    case ACCESS_E_NOT_FOUND:
        rpc = SHEARD_RPC_NO_SUCH_FILE;
        break;
    case ACCESS_E_DENIED:
    case ACCESS_E_SERVICE:
        rpc = SHEARD_RPC_NOT_READABLE;
        break;
    case SOURCE_E_TOO_LARGE:
        rpc = SHEARD_RPC_FILE_TOO_LARGE;
        break;
    case ACCESS_E_ROOT:
        rpc = SHEARD_RPC_ROOT_MISSING;
        break;
    case ACCESS_E_NOT_REGULAR:
        rpc = SHEARD_RPC_NOT_REGULAR;
        break;
    default:
        break;
    }
    return sheard_rpc_fail(error, rpc, err->advice[0] != '\0' ? err->advice : NULL, "%s",
                           err->message);
}

static void digest(const void *bytes, size_t n, char *hex, size_t size) {
    char sum[SHEAR_CHECKSUM_SIZE];
    shear_bytes_checksum(bytes, n, sum);
    snprintf(hex, size, "%s", sum);
}

/* May the peer have these files measured? They are opened, and closed again. */
static int check_files(service *s, const submission *sub, source_files *files,
                       sheard_rpc_error *error) {
    shear_error err = {0};
    int part = -1;
    const int code = source_files_open(s, &sub->peer, &sub->submit->source, files, &part, &err);
    if (code == SHEAR_OK) {
        return SHEARD_RPC_OK;
    }
    rpc_from_access(error, code, &err);
    snprintf(error->parameter, sizeof error->parameter, "%s%spath",
             part >= 0 ? shear_part_name(part) : "", part >= 0 ? "." : "");
    return error->code;
}

/* `groups`: of the peer, as text; NULL for the service's own files. */
static int into_store(service *s, const submission *sub, const sheard_msg_source *named,
                      const char *groups, const shear_settings *settings, int64_t *id, bool *known,
                      sheard_rpc_error *error) {
    char text[SHEARD_MSG_SETTINGS_SIZE];
    char hex[33];
    char *source = NULL;
    shear_error err = {0};
    int code = sheard_settings_write(settings, text, sizeof text, &err);
    if (code == SHEAR_OK) {
        code = sheard_settings_digest(settings, digest, hex, sizeof hex, &err);
    }
    if (code != SHEAR_OK) {
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_SETTING, NULL, "%s", err.message);
    }
    if (sheard_source_text(&source, named, error) != SHEARD_RPC_OK) {
        return error->code;
    }
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
                             .created_ms = wall_ms()};
    code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_submit(s->store, &spec, s->config.limits.queue, id, known, &err);
    }
    free(source);
    return code == SHEAR_OK ? SHEARD_RPC_OK : rpc_from_store(error, code, &err);
}

static bool may_hurry(const service *s, const access_peer *peer) {
    return peer_is_admin(s, peer) || access_list_has(s->hurried, peer);
}

int submit_job(service *s, const submission *sub, int64_t *id, bool *known,
               sheard_rpc_error *error) {
    shear_settings settings = s->config.measure;
    shear_error err = {0};
    source_files files = {.fds = {-1, -1, -1, -1}};
    char *groups = NULL;
    if (sheard_settings_apply(&settings, sub->submit->settings, &err) != SHEAR_OK) {
        return sheard_rpc_fail(error, SHEARD_RPC_BAD_SETTING, err.advice, "%s", err.message);
    }
    if (sub->submit->priority > 0 && !may_hurry(s, &sub->peer)) {
        sheard_rpc_fail(error, SHEARD_RPC_PRIORITY_NOT_ALLOWED, NULL,
                        "'priority': you may give 0 and below, not %lld ([access] priority_users, "
                        "priority_groups)",
                        (long long)sub->submit->priority);
        snprintf(error->parameter, sizeof error->parameter, "priority");
        return error->code;
    }
    if (sub->source != NULL) {
        const sheard_msg_source own = {.path = sub->source};
        return into_store(s, sub, &own, NULL, &settings, id, known, error);
    }
    int code = check_files(s, sub, &files, error);
    if (code == SHEARD_RPC_OK && access_peer_groups_text(&sub->peer, &groups, &err) != SHEAR_OK) {
        code = sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL, "%s", err.message);
    }
    if (code == SHEARD_RPC_OK) {
        code = into_store(s, sub, &files.named, groups, &settings, id, known, error);
    }
    free(groups);
    source_files_deinit(&files);
    return code;
}
