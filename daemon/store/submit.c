/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Submit jobs, once per idempotency key, and retry them. */
#include "store/job.h"

#include "base/cleanup.h"
#include "store/operation.h"
#include "store/row.h"

#include <inttypes.h>
#include <string.h>

static int check_spec(const store_spec *p, shear_error *err) {
    const text_rule rules[] = {
        {"field's name", p->field, STORE_FIELD_MAX, true},
        {"source", p->source, STORE_SOURCE_MAX, false},
        {"settings", p->settings, STORE_SETTINGS_MAX, false},
        {"settings digest", p->settings_digest, STORE_DIGEST_MAX, false},
        {"idempotency key", p->key, STORE_KEY_MAX, true},
        {"dropped file's name", p->dropped, STORE_PATH_MAX, true},
    };
    TRY(query_check_texts(rules, sizeof rules / sizeof rules[0], err));
    if (p->groups != NULL && strlen(p->groups) > STORE_GROUPS_MAX) { /* may be empty */
        return shear_fail(err, STORE_BAD_TEXT, NULL, "the list of groups has more than %d bytes",
                          STORE_GROUPS_MAX);
    }
    return SHEAR_OK;
}

/* The parameters that SQL_KEY_FIND and SQL_JOB_ADD have in common. */
#define REQUEST(p)                                                                                 \
    query_int((p)->owner), query_text((p)->key), query_text((p)->source),                          \
        query_text((p)->settings_digest), query_text((p)->field), query_int((p)->origin),          \
        query_int((p)->priority), query_int((p)->force)

/* A job that was found, and whether it is the one that is asked for. */
typedef struct found_job {
    int64_t id; /* 0: none */
    bool same;
} found_job;
static const row_type found_type =
    ROW_TYPE(found_job, ROW_MEMBER(found_job, id), ROW_MEMBER(found_job, same));

/* Find the job with this owner's key; *id is 0 if there is none. */
static int find_key(store *s, const store_spec *p, int64_t *id, shear_error *err) {
    found_job found = {0};
    *id = 0;
    if (p->key != NULL)
        TRY(row_get(QUERY(s, SQL_KEY_FIND, REQUEST(p)), &found_type, &found, NULL, err));
    if (found.id != 0 && !found.same) {
        return shear_fail(err, STORE_KEY_REUSED, "use a new key for a new request",
                          "the idempotency key '%s' belongs to another request (job %" PRId64 ")",
                          p->key, found.id);
    }
    *id = found.id;
    return SHEAR_OK;
}

static int keep_settings(store *s, const store_spec *p, shear_error *err) {
    enum { NEW = -1 };
    int64_t same = NEW;
    const parameter digest = query_text(p->settings_digest);
    const parameter settings = query_text(p->settings);
    TRY(query_number(QUERY(s, SQL_SETTINGS_FIND, digest, settings), NEW, &same, err));
    if (same == 0) {
        return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                          "the settings digest %s already stands for other settings",
                          p->settings_digest);
    }
    return same != NEW ? SHEAR_OK : query_run(QUERY(s, SQL_SETTINGS_ADD, digest, settings), err);
}

/* Find or add the groups; *number is 0 if they are not known. */
static int keep_credentials(store *s, const store_spec *p, int64_t *number, shear_error *err) {
    const parameter gid = query_int(p->gid);
    const parameter groups = query_text(p->groups);
    *number = 0;
    if (p->groups == NULL)
        return SHEAR_OK;
    TRY(query_number(QUERY(s, SQL_CREDENTIALS_FIND, gid, groups), 0, number, err));
    if (*number != 0)
        return SHEAR_OK;
    TRY(query_run(QUERY(s, SQL_CREDENTIALS_ADD, gid, groups), err));
    *number = sqlite3_last_insert_rowid(s->db);
    return SHEAR_OK;
}

static int add_job(store *s, const store_spec *p, int64_t *id, shear_error *err) {
    int64_t credentials = 0;
    TRY(keep_credentials(s, p, &credentials, err));
    TRY(query_run(QUERY(s, SQL_JOB_ADD, REQUEST(p), query_int(p->created_ms),
                        query_int(credentials), query_text(p->dropped)),
                  err));
    *id = sqlite3_last_insert_rowid(s->db);
    return SHEAR_OK;
}

static int submit(store *s, const store_spec *p, int64_t max_unfinished, int64_t *id, bool *known,
                  shear_error *err) {
    TRY(find_key(s, p, id, err));
    *known = *id != 0;
    if (*known)
        return SHEAR_OK;
    TRY(job_check_capacity(s, max_unfinished, err));
    TRY(keep_settings(s, p, err));
    return add_job(s, p, id, err);
}

int store_submit(store *s, const store_spec *spec, int64_t max_unfinished, int64_t *id, bool *known,
                 shear_error *err) {
    *id = 0;
    *known = false;
    TRY(check_spec(spec, err));
    int code = OPERATION(s, submit(s, spec, max_unfinished, id, known, err), err);
    if (code != SHEAR_OK) {
        *id = 0;
        *known = false;
    }
    return code;
}

static int find_dropped(store *s, uint32_t owner, const char *key, const char *dropped, int64_t *id,
                        shear_error *err) {
    found_job found;
    TRY(row_get(QUERY(s, SQL_DROPPED_FIND, query_int(owner), query_text(key)), &found_type, &found,
                NULL, err));
    *id = found.id;
    if (found.id == 0 || found.same)
        return SHEAR_OK;
    /* the job of an older version */
    return query_run(QUERY(s, SQL_DROPPED_SET, query_int(found.id), query_text(dropped)), err);
}

int store_find_dropped(store *s, uint32_t owner, const char *key, const char *dropped, int64_t *id,
                       shear_error *err) {
    const text_rule rule = {"dropped file's name", dropped, STORE_PATH_MAX, false};
    *id = 0;
    TRY(query_check_texts(&rule, 1, err));
    int code = OPERATION(s, find_dropped(s, owner, key, dropped, id, err), err);
    *id = code == SHEAR_OK ? *id : 0;
    return code;
}

int store_set_disposal(store *s, int64_t id, const char *place, const char *fingerprint,
                       shear_error *err) {
    const text_rule rules[] = {{"place of a dropped file", place, STORE_PATH_MAX, false},
                               {"mark of a dropped file", fingerprint, STORE_PATH_MAX, true}};
    TRY(query_check_texts(rules, sizeof rules / sizeof rules[0], err));
    return OPERATION(s,
                     query_run(QUERY(s, SQL_JOB_SET_DISPOSAL, query_int(id), query_text(place),
                                     query_text(fingerprint)),
                               err),
                     err);
}

static int retry(store *s, int64_t id, int64_t max_unfinished, shear_error *err) {
    CLEANUP(job_row_deinit) job_row job = {0};
    TRY(job_row_get(s, id, &job, err));
    if (job.state != STORE_FAILED && job.state != STORE_CANCELLED)
        return job_wrong_state(&job, "failed or cancelled", err);
    TRY(job_check_capacity(s, max_unfinished, err));
    return query_run_id(s, SQL_JOB_RETRY, id, err);
}

int store_retry(store *s, int64_t id, int64_t max_unfinished, shear_error *err) {
    return OPERATION(s, retry(s, id, max_unfinished, err), err);
}
