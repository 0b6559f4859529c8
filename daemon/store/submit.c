/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Submit jobs, once per idempotency key, and retry them. */
#include "store/job.h"

#include "base/cleanup.h"
#include "store/operation.h"

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

/* Bind the parameters that SQL_KEY_FIND and SQL_JOB_ADD have in common. */
static query query_spec(store *s, enum sql which, const store_spec *p) {
    query q = query_on(s, which);
    query_int(&q, p->owner);
    query_text(&q, p->key);
    query_text(&q, p->source);
    query_text(&q, p->settings_digest);
    query_text(&q, p->field);
    query_int(&q, p->origin);
    query_int(&q, p->priority);
    query_int(&q, p->force);
    return q;
}

/* Find the job with this owner's key; *id is 0 if there is none. */
static int find_key(store *s, const store_spec *p, int64_t *id, shear_error *err) {
    bool row = false;
    *id = 0;
    if (p->key == NULL)
        return SHEAR_OK;
    CLEANUP(query_end) query q = query_spec(s, SQL_KEY_FIND, p);
    const int code = query_step(&q, &row, err);
    if (!row)
        return code;
    const int64_t found = query_get_int(&q);
    if (query_get_int(&q) == 0) {
        return shear_fail(err, STORE_KEY_REUSED, "use a new key for a new request",
                          "the idempotency key '%s' belongs to another request (job %" PRId64 ")",
                          p->key, found);
    }
    *id = found;
    return SHEAR_OK;
}

static int keep_settings(store *s, const store_spec *p, shear_error *err) {
    bool row = false;
    query find = query_on(s, SQL_SETTINGS_FIND);
    query_text(&find, p->settings_digest);
    query_text(&find, p->settings);
    const int code = query_step(&find, &row, err);
    const bool same = row && query_get_int(&find) != 0;
    query_end(&find);
    if (code != SHEAR_OK || same)
        return code;
    if (row) {
        return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                          "the settings digest %s already stands for other settings",
                          p->settings_digest);
    }
    query add = query_on(s, SQL_SETTINGS_ADD);
    query_text(&add, p->settings_digest);
    query_text(&add, p->settings);
    return query_run(&add, err);
}

/* Find or add the groups; *number is 0 if they are not known. */
static int keep_credentials(store *s, const store_spec *p, int64_t *number, shear_error *err) {
    *number = 0;
    if (p->groups == NULL)
        return SHEAR_OK;
    query find = query_on(s, SQL_CREDENTIALS_FIND);
    query_int(&find, p->gid);
    query_text(&find, p->groups);
    int code = query_number(&find, 0, number, err);
    if (code != SHEAR_OK || *number != 0)
        return code;
    query add = query_on(s, SQL_CREDENTIALS_ADD);
    query_int(&add, p->gid);
    query_text(&add, p->groups);
    code = query_run(&add, err);
    *number = code == SHEAR_OK ? sqlite3_last_insert_rowid(s->db) : 0;
    return code;
}

static int add_job(store *s, const store_spec *p, int64_t *id, shear_error *err) {
    int64_t credentials = 0;
    TRY(keep_credentials(s, p, &credentials, err));
    query q = query_spec(s, SQL_JOB_ADD, p);
    query_int(&q, p->created_ms);
    query_int(&q, credentials);
    query_text(&q, p->dropped);
    int code = query_run(&q, err);
    *id = code == SHEAR_OK ? sqlite3_last_insert_rowid(s->db) : 0;
    return code;
}

static int submit(store *s, const store_spec *p, int64_t max_unfinished, int64_t *id, bool *known,
                  shear_error *err) {
    int code = find_key(s, p, id, err);
    *known = *id != 0;
    if (code != SHEAR_OK || *known)
        return code;
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
    bool row = false;
    query find = query_on(s, SQL_DROPPED_FIND);
    query_int(&find, owner);
    query_text(&find, key);
    const int code = query_step(&find, &row, err);
    *id = row ? query_get_int(&find) : 0;
    const bool named = row && query_get_int(&find) != 0;
    query_end(&find);
    if (code != SHEAR_OK || *id == 0 || named)
        return code;
    query name = query_on(s, SQL_DROPPED_SET); /* the job of an older version */
    query_int(&name, *id);
    query_text(&name, dropped);
    return query_run(&name, err);
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

static int set_disposal(store *s, int64_t id, const char *place, const char *fingerprint,
                        shear_error *err) {
    query q = query_on(s, SQL_JOB_SET_DISPOSAL);
    query_int(&q, id);
    query_text(&q, place);
    query_text(&q, fingerprint);
    return query_run(&q, err);
}

int store_set_disposal(store *s, int64_t id, const char *place, const char *fingerprint,
                       shear_error *err) {
    const text_rule rules[] = {{"place of a dropped file", place, STORE_PATH_MAX, false},
                               {"mark of a dropped file", fingerprint, STORE_PATH_MAX, true}};
    TRY(query_check_texts(rules, sizeof rules / sizeof rules[0], err));
    return OPERATION(s, set_disposal(s, id, place, fingerprint, err), err);
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
