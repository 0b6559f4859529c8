/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each method does. Anything that changes the store is answered after its commit. */
#include "service/source.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool peer_is_admin(const service *s, const access_peer *peer) {
    return peer->uid == 0 || access_list_has(s->admins, peer);
}

static void refuse(service *s, server_handle to, int code, const char *message) {
    shear_rpc_error error;
    shear_rpc_fail(&error, code, NULL, "%s", message);
    server_reply_error(s->server, to, &error);
}

static void refuse_new(service *s, server_handle to) {
    refuse(s, to, s->state == SHEAR_SERVER_DRAINING ? SHEAR_RPC_DRAINING : SHEAR_RPC_STOPPING,
           "the service takes no new jobs");
}

static void refuse_store(service *s, server_handle to, int code, const shear_error *err) {
    shear_rpc_error error;
    rpc_from_store(&error, code, err);
    server_reply_error(s->server, to, &error);
}

/* ---- submit, cancel, retry: changes ---- */

/* The change is on disk: reply with the job as it is now. */
static void reply_job(service *s, after *a, int code, const shear_error *err) {
    store_job job = {0};
    shear_error local = {0};
    if (code != SHEAR_OK) {
        refuse_store(s, a->to, code, err);
        return;
    }
    code = store_job_get(s->store, a->job, &job, &local);
    if (code != SHEAR_OK) {
        refuse_store(s, a->to, code, &local);
        return;
    }
    shear_reply reply = {0};
    shear_msg_job *message = a->method == SHEAR_METHOD_SUBMIT   ? &reply.submit.job
                             : a->method == SHEAR_METHOD_CANCEL ? &reply.cancel
                                                                : &reply.retry;
    present_job(s, &job, message);
    reply.submit.known = a->method == SHEAR_METHOD_SUBMIT && a->flag;
    server_reply(s->server, a->to, &reply);
    present_job_free(message);
    publish_job(s, &job);
    if (shear_job_state_is_final(job.state)) {
        jobs_final(s, &job);
    }
    store_job_deinit(&job);
}

/* As reply_job, but the reply comes when the job has ended. */
static void reply_when_ended(service *s, after *a, int code, const shear_error *err) {
    if (code != SHEAR_OK) {
        refuse_store(s, a->to, code, err);
    } else {
        waits_add(s, a->to, SHEAR_METHOD_SUBMIT, a->flag, &a->job, 1, NAN);
    }
}

static void answer_later(service *s, void (*run)(service *, after *, int, const shear_error *),
                         server_handle to, int method, int64_t job, bool flag) {
    after *a = group_after(s, run);
    if (a == NULL) {
        refuse(s, to, SHEAR_RPC_OUT_OF_MEMORY,
               "out of memory for a reply; the request may have been carried out");
        return;
    }
    a->to = to;
    a->method = method;
    a->job = job;
    a->flag = flag;
}

static void do_submit(service *s, const server_request *r) {
    const shear_msg_submit *submit = &r->request->params.submit;
    shear_rpc_error error;
    int64_t id = 0;
    bool known = false;
    const submission sub = {
        .submit = submit, .peer = *r->peer, .origin = STORE_SOCKET, .key = submit->key};
    if (s->config.access.submit_groups.n > 0 && !access_list_has(s->submitters, &sub.peer) &&
        !peer_is_admin(s, r->peer)) {
        refuse(s, r->handle, SHEAR_RPC_NOT_OWNER,
               "you are in none of the groups that may submit jobs ([access] submit_groups)");
    } else if (s->state != SHEAR_SERVER_RUNNING) {
        refuse_new(s, r->handle);
    } else if (submit_job(s, &sub, &id, &known, &error) != SHEAR_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
    } else {
        answer_later(s, submit->wait ? reply_when_ended : reply_job, r->handle, SHEAR_METHOD_SUBMIT,
                     id, known);
    }
}

/* Owners and administrators only. Where not, the reply has been given. */
static bool may_change(service *s, const server_request *r, int64_t id) {
    store_job job = {0};
    shear_error err = {0};
    const int code = store_job_get(s->store, id, &job, &err);
    const bool mine = job.owner == r->peer->uid || peer_is_admin(s, r->peer);
    store_job_deinit(&job);
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
    } else if (!mine) {
        refuse(s, r->handle, SHEAR_RPC_NOT_OWNER, "the job belongs to somebody else");
    }
    return code == SHEAR_OK && mine;
}

static void do_cancel(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    int state = 0;
    if (!may_change(s, r, id)) {
        return;
    }
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_cancel(s->store, id, wall_ms(), &state, &err);
    }
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    if (state == STORE_RUNNING) {
        engine_stop_job(s->engine, id);
    }
    answer_later(s, reply_job, r->handle, SHEAR_METHOD_CANCEL, id, false);
}

/* The files of a job that is to be tried again are opened, as at its submission, and closed. Where
 * they cannot be, the reply has been given. */
static bool may_open(service *s, const server_request *r, int64_t id) {
    store_job job = {0};
    source_opened o;
    shear_error err = {0};
    shear_rpc_error error;
    int code = store_job_get(s->store, id, &job, &err);
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return false;
    }
    if (job.state == STORE_FAILED || job.state == STORE_CANCELLED) { /* else wrong_state, below */
        code = source_open_for_job(s, &job, &o, &err);
        source_opened_deinit(&o);
    }
    if (code != SHEAR_OK) {
        rpc_from_access(&error, code, &err);
        server_reply_error(s->server, r->handle, &error);
    }
    store_job_deinit(&job);
    return code == SHEAR_OK;
}

static void do_retry(service *s, const server_request *r) {
    const int64_t id = r->request->params.id.id;
    shear_error err = {0};
    if (!may_change(s, r, id)) {
        return;
    }
    if (s->state != SHEAR_SERVER_RUNNING) {
        refuse_new(s, r->handle);
        return;
    }
    if (!may_open(s, r, id)) {
        return;
    }
    int code = group_begin(s, &err);
    if (code == SHEAR_OK) {
        code = store_retry(s->store, id, s->config.limits.queue, &err);
    }
    if (code != SHEAR_OK) {
        refuse_store(s, r->handle, code, &err);
        return;
    }
    answer_later(s, reply_job, r->handle, SHEAR_METHOD_RETRY, id, false);
}

/* ---- looking ---- */

static void do_hello(service *s, const server_request *r) {
    const shear_msg_hello *hello = &r->request->params.hello;
    if (hello->oldest > SHEAR_PROTOCOL_VERSION || hello->newest < SHEAR_PROTOCOL_OLDEST) {
        refuse(s, r->handle, SHEAR_RPC_UNSUPPORTED_VERSION,
               "client and service speak no common version of the protocol");
        return;
    }
    shear_reply reply = {.hello = {.protocol = SHEAR_PROTOCOL_VERSION,
                                   .oldest = SHEAR_PROTOCOL_OLDEST,
                                   .newest = SHEAR_PROTOCOL_VERSION,
                                   .server = "sheard " SHEARD_VERSION,
                                   .uid = r->peer->uid,
                                   .admin = peer_is_admin(s, r->peer)}};
    reply.hello.methods = shear_method_names(&reply.hello.n_methods);
    reply.hello.limits = status_limits(s);
    server_reply(s->server, r->handle, &reply);
}

static void do_job(service *s, const server_request *r) {
    store_job job = {0};
    store_attempts attempts = {0};
    shear_error err = {0};
    const int64_t id = r->request->params.id.id;
    int code = store_job_get(s->store, id, &job, &err);
    if (code == SHEAR_OK) {
        code = store_attempts_get(s->store, id, &attempts, &err);
    }
    shear_msg_attempt *history = code == SHEAR_OK ? calloc(attempts.n + 1, sizeof *history) : NULL;
    if (history == NULL) {
        refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        for (size_t i = 0; i < attempts.n; i++) {
            const store_attempt *a = &attempts.attempts[i];
            history[i] = (shear_msg_attempt){.number = a->number,
                                             .started_ms = a->started_ms,
                                             .ended_ms = a->ended_ms,
                                             .ending = a->ending,
                                             .job_class = a->failure_class,
                                             .code = a->code,
                                             .message = a->message};
        }
        shear_reply reply = {.job = {.history = history, .n_history = attempts.n}};
        present_job(s, &job, &reply.job.job);
        server_reply(s->server, r->handle, &reply);
        present_job_free(&reply.job.job);
    }
    free(history);
    store_attempts_deinit(&attempts);
    store_job_deinit(&job);
}

static void do_jobs(service *s, const server_request *r) {
    const shear_msg_jobs *p = &r->request->params.jobs;
    store_job_page page = {0};
    shear_error err = {0};
    char cursor[32];
    char *end = NULL;
    store_job_filter filter = {.states = p->states,
                               .field = p->field,
                               .by_owner = p->owner >= 0,
                               .owner = (uint32_t)(p->owner >= 0 ? p->owner : 0)};
    filter.before = p->cursor != NULL ? strtoll(p->cursor, &end, 10) : 0;
    if (p->cursor != NULL && (*end != '\0' || filter.before <= 0)) {
        refuse(s, r->handle, SHEAR_RPC_BAD_CURSOR, "the cursor is none of this service");
        return;
    }
    const int code = store_jobs(s->store, &filter, (size_t)p->limit, &page, &err);
    shear_msg_job *jobs = code == SHEAR_OK ? calloc(page.n + 1, sizeof *jobs) : NULL;
    if (jobs == NULL) {
        refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        for (size_t i = 0; i < page.n; i++) {
            present_job(s, &page.jobs[i], &jobs[i]);
            jobs[i].result = NULL;
        }
        snprintf(cursor, sizeof cursor, "%" PRId64, page.n > 0 ? page.jobs[page.n - 1].id : 0);
        const shear_reply reply = {
            .jobs = {.jobs = jobs, .n_jobs = page.n, .cursor = page.more ? cursor : NULL}};
        server_reply(s->server, r->handle, &reply);
        for (size_t i = 0; i < page.n; i++) {
            present_job_free(&jobs[i]);
        }
    }
    free(jobs);
    store_job_page_deinit(&page);
}

static int list_contributions(service *s, const shear_msg_field *p, shear_msg_field_row *row,
                              store_contribution_page *page, shear_error *err) {
    if (p->limit == 0 || row->jobs == 0) {
        return SHEAR_OK;
    }
    const int code =
        store_contributions(s->store, p->field, row->digest, p->after, (size_t)p->limit, page, err);
    shear_msg_contribution *list = code == SHEAR_OK ? calloc(page->n + 1, sizeof *list) : NULL;
    for (size_t i = 0; list != NULL && i < page->n; i++) {
        const store_contribution *c = &page->items[i];
        list[i] = (shear_msg_contribution){.id = c->id,
                                           .job = c->job,
                                           .checksum = c->content,
                                           .n_stamps = c->n_stamps,
                                           .n_used = c->n_used,
                                           .counted_ms = c->counted_ms};
    }
    row->contributions = list;
    row->n_contributions = list != NULL ? page->n : 0;
    row->more = page->more;
    return code;
}

static void do_field(service *s, const server_request *r) {
    const shear_msg_field *p = &r->request->params.field;
    store_field_page page = {0};
    shear_error err = {0};
    int code = store_field_get(s->store, p->field, &page, &err);
    if (code == STORE_NOT_FOUND) {
        refuse(s, r->handle, SHEAR_RPC_NO_SUCH_FIELD, err.message);
        return;
    }
    if (code == SHEAR_OK) {
        code = present_begun(s, p->field, &page, &err);
    }
    shear_msg_field_row *rows = code == SHEAR_OK ? calloc(page.n + 1, sizeof *rows) : NULL;
    store_contribution_page *lists = rows != NULL ? calloc(page.n + 1, sizeof *lists) : NULL;
    size_t n = 0;
    for (size_t i = 0; lists != NULL && i < page.n && code == SHEAR_OK; i++) {
        if (p->digest == NULL || strcmp(p->digest, page.fields[i].settings_digest) == 0) {
            code = present_field(s, &page.fields[i], &rows[n], &err);
            if (code == SHEAR_OK) {
                code = list_contributions(s, p, &rows[n], &lists[n], &err);
                n++;
            }
        }
    }
    if (lists == NULL || code != SHEAR_OK) {
        refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        const shear_reply reply = {
            .field = {.field = p->field, .mixed = page.n > 1, .rows = rows, .n_rows = n}};
        server_reply(s->server, r->handle, &reply);
    }
    for (size_t i = 0; i < n; i++) {
        free((shear_msg_contribution *)rows[i].contributions);
        store_contribution_page_deinit(&lists[i]);
        present_field_free(&rows[i]);
    }
    free(rows);
    free(lists);
    store_field_page_deinit(&page);
}

/* A cursor of fields is the digest (32 hex digits), a blank and the name of the last one. */
static bool read_cursor(const char *cursor, char *digest, const char **name) {
    const char *blank = cursor != NULL ? strchr(cursor, ' ') : NULL;
    const size_t n = blank != NULL ? (size_t)(blank - cursor) : 0;
    if (n == 0 || n > STORE_DIGEST_MAX) {
        return false;
    }
    memcpy(digest, cursor, n);
    digest[n] = '\0';
    *name = blank + 1;
    return true;
}

static void do_fields(service *s, const server_request *r) {
    const shear_msg_fields *p = &r->request->params.fields;
    store_field_page page = {0};
    shear_error err = {0};
    char digest[STORE_DIGEST_MAX + 1];
    char cursor[SHEAR_MSG_CURSOR_MAX];
    store_field_filter filter = {.prefix = p->prefix};
    if (p->cursor != NULL) {
        if (!read_cursor(p->cursor, digest, &filter.after_name)) {
            refuse(s, r->handle, SHEAR_RPC_BAD_CURSOR, "the cursor is none of this service");
            return;
        }
        filter.after_digest = digest;
    }
    const int code = store_fields(s->store, &filter, (size_t)p->limit, &page, &err);
    shear_msg_summary *list = code == SHEAR_OK ? calloc(page.n + 1, sizeof *list) : NULL;
    if (list == NULL) {
        refuse_store(s, r->handle, code != SHEAR_OK ? code : SHEAR_E_NOMEM, &err);
    } else {
        for (size_t i = 0; i < page.n; i++) {
            present_summary(&page.fields[i], &list[i]);
            list[i].mixed =
                (i > 0 && strcmp(page.fields[i - 1].name, page.fields[i].name) == 0) ||
                (i + 1 < page.n && strcmp(page.fields[i + 1].name, page.fields[i].name) == 0);
        }
        if (page.n > 0) {
            const store_field *last = &page.fields[page.n - 1];
            snprintf(cursor, sizeof cursor, "%s %s", last->settings_digest, last->name);
        }
        const shear_reply reply = {
            .fields = {.fields = list, .n_fields = page.n, .cursor = page.more ? cursor : NULL}};
        server_reply(s->server, r->handle, &reply);
    }
    free(list);
    store_field_page_deinit(&page);
}

/* Where one of the jobs is unknown, the reply has been given. */
static bool are_known(service *s, const server_request *r, const int64_t *ids, size_t n) {
    for (size_t i = 0; i < n; i++) {
        store_job job = {0};
        shear_error err = {0};
        const int code = store_job_get(s->store, ids[i], &job, &err);
        store_job_deinit(&job);
        if (code != SHEAR_OK) {
            refuse_store(s, r->handle, code, &err);
            return false;
        }
    }
    return true;
}

static void do_wait(service *s, const server_request *r) {
    const shear_msg_wait *p = &r->request->params.wait;
    if (are_known(s, r, p->ids, p->n_ids)) {
        waits_add(s, r->handle, SHEAR_METHOD_WAIT, false, p->ids, p->n_ids, p->timeout_s);
    }
}

/* Of jobs that are final already nothing will be told. */
static void leave_final(service *s, uint64_t connection, const shear_msg_subscribe *what,
                        shear_msg_subscribed *now) {
    for (size_t i = 0; i < what->n_jobs; i++) {
        store_job job = {0};
        shear_error ignored;
        shear_rpc_error error;
        if (store_job_get(s->store, what->jobs[i], &job, &ignored) == SHEAR_OK &&
            shear_job_state_is_final(job.state)) {
            const shear_msg_subscribe one = {.jobs = &what->jobs[i], .n_jobs = 1};
            server_unsubscribe(s->server, connection, &one, now, &error);
        }
        store_job_deinit(&job);
    }
}

static void do_subscribe(service *s, const server_request *r, bool add) {
    shear_rpc_error error;
    shear_reply reply = {0};
    const uint64_t connection = r->handle.connection;
    const shear_msg_subscribe *what = &r->request->params.subscribe;
    if (add && !are_known(s, r, what->jobs, what->n_jobs)) {
        return;
    }
    const int code =
        add ? server_subscribe(s->server, connection, what, &reply.subscribe, &error)
            : server_unsubscribe(s->server, connection, what, &reply.unsubscribe, &error);
    if (code != SHEAR_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
    } else {
        if (add) {
            leave_final(s, connection, what, &reply.subscribe);
        }
        server_reply(s->server, r->handle, &reply);
    }
}

/* ---- administration ---- */

static void do_reload(service *s, const server_request *r) {
    shear_rpc_error error;
    shear_reply reply = {0};
    if (life_reload(s, &reply.reload, &error) != SHEAR_RPC_OK) {
        server_reply_error(s->server, r->handle, &error);
    } else {
        server_reply(s->server, r->handle, &reply);
    }
    free((void *)reply.reload.changed);
    free((void *)reply.reload.restart);
}

static void do_stop(service *s, const server_request *r) {
    if (r->request->method == SHEAR_METHOD_DRAIN) {
        life_drain_queue(s);
    } else if (r->request->params.shutdown.mode == SHEAR_SHUTDOWN_NOW) {
        life_stop_now(s);
    } else {
        life_drain(s, r->request->params.shutdown.timeout_s);
    }
    const shear_reply reply = {.drain = life_left(s)};
    server_reply(s->server, r->handle, &reply);
    if (r->request->method == SHEAR_METHOD_DRAIN) {
        life_announce(s);
    }
}

void methods_request(void *context, const server_request *r) {
    service *s = context;
    const int method = r->request->method;
    if (shear_method_needs_admin(method) && !peer_is_admin(s, r->peer)) {
        refuse(s, r->handle, SHEAR_RPC_NOT_ADMIN,
               "only administrators may do this ([access] admin_users, admin_groups)");
        return;
    }
    switch (method) {
    case SHEAR_METHOD_HELLO:
        do_hello(s, r);
        break;
    case SHEAR_METHOD_SUBMIT:
        do_submit(s, r);
        break;
    case SHEAR_METHOD_JOB:
        do_job(s, r);
        break;
    case SHEAR_METHOD_JOBS:
        do_jobs(s, r);
        break;
    case SHEAR_METHOD_WAIT:
        do_wait(s, r);
        break;
    case SHEAR_METHOD_CANCEL:
        do_cancel(s, r);
        break;
    case SHEAR_METHOD_RETRY:
        do_retry(s, r);
        break;
    case SHEAR_METHOD_FIELD:
        do_field(s, r);
        break;
    case SHEAR_METHOD_FIELDS:
        do_fields(s, r);
        break;
    case SHEAR_METHOD_SUBSCRIBE:
    case SHEAR_METHOD_UNSUBSCRIBE:
        do_subscribe(s, r, method == SHEAR_METHOD_SUBSCRIBE);
        break;
    case SHEAR_METHOD_STATUS:
        status_reply(s, r->handle);
        break;
    case SHEAR_METHOD_METRICS:
        metrics_reply(s, r->handle);
        break;
    case SHEAR_METHOD_RELOAD:
        do_reload(s, r);
        break;
    default:
        do_stop(s, r);
        break;
    }
}
