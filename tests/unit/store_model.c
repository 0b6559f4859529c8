/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store_model.h"

static model_job *find(model *m, int64_t id) {
    return id >= 1 && id <= m->n_jobs && m->jobs[id].kept ? &m->jobs[id] : NULL;
}

static int find_in(model *m, int64_t id, int state, model_job **job) {
    *job = find(m, id);
    return *job == NULL ? STORE_NOT_FOUND : (*job)->state != state ? STORE_WRONG_STATE : SHEAR_OK;
}

static bool has_room(const model *m) {
    int64_t n = 0;
    for (int64_t id = 1; id <= m->n_jobs; id++)
        n += m->jobs[id].kept && m->jobs[id].state <= STORE_WAITING;
    return n < m->max_unfinished;
}

static void move(model *m, model_job *job, int state, int64_t now_ms) {
    job->state = state;
    job->cancel_asked = false;
    job->not_before_ms = 0;
    job->finished_ms = state >= STORE_DONE ? now_ms : 0;
    m->totals.failed += state == STORE_FAILED;
    m->totals.cancelled += state == STORE_CANCELLED;
    if (state == STORE_DONE || state == STORE_CANCELLED)
        job->checkpoint = MODEL_NONE;
}

int model_submit(model *m, const model_job *spec, int64_t *id, bool *known) {
    *id = 0;
    *known = false;
    for (int64_t i = 1; i <= m->n_jobs && spec->key != MODEL_NONE; i++) {
        const model_job *job = &m->jobs[i];
        if (job->kept && job->owner == spec->owner && job->key == spec->key) {
            const bool same = job->asked == spec->asked && job->settings == spec->settings &&
                              job->priority == spec->priority && job->force == spec->force;
            *known = same;
            *id = same ? i : 0;
            return same ? SHEAR_OK : STORE_KEY_REUSED;
        }
    }
    if (!has_room(m))
        return STORE_QUEUE_FULL;
    *id = ++m->n_jobs;
    m->jobs[*id] = *spec;
    m->jobs[*id].kept = true;
    m->jobs[*id].field = spec->asked;
    m->jobs[*id].content = MODEL_NONE;
    m->jobs[*id].checkpoint = MODEL_NONE;
    m->totals.submitted++;
    return SHEAR_OK;
}

int64_t model_next(model *m, int64_t now_ms) {
    int64_t best = 0;
    for (int64_t id = 1; id <= m->n_jobs; id++) {
        model_job *job = &m->jobs[id];
        if (job->kept && job->state == STORE_WAITING && job->not_before_ms <= now_ms)
            move(m, job, STORE_QUEUED, now_ms);
        if (job->kept && job->state == STORE_QUEUED &&
            (best == 0 || job->priority > m->jobs[best].priority)) {
            best = id;
        }
    }
    if (best != 0) {
        model_job *job = &m->jobs[best];
        move(m, job, STORE_RUNNING, now_ms);
        job->attempts++;
        job->attempt++;
        job->started_ms = now_ms;
        m->totals.attempts++;
    }
    return best;
}

static int64_t counted_before(const model *m, const model_job *job) {
    for (int64_t i = 0; i < m->n_contributions && !job->force; i++) {
        const model_contribution *c = &m->contributions[i];
        if (job->field != MODEL_NONE && job->content != MODEL_NONE && c->field == job->field &&
            c->settings == job->settings && c->content == job->content) {
            return c->job;
        }
    }
    return 0;
}

int model_learn(model *m, int64_t id, int field, int content, int64_t *duplicate_of) {
    model_job *job = NULL;
    const int code = find_in(m, id, STORE_RUNNING, &job);
    *duplicate_of = 0;
    if (code == SHEAR_OK) {
        if (content != MODEL_NONE && job->content != MODEL_NONE && content != job->content)
            job->checkpoint = MODEL_NONE;
        job->field = field != MODEL_NONE ? field : job->field;
        job->content = content != MODEL_NONE ? content : job->content;
        *duplicate_of = counted_before(m, job);
    }
    return code;
}

int model_checkpoint(model *m, int64_t id, int64_t next_block) {
    model_job *job = NULL;
    const int code = find_in(m, id, STORE_RUNNING, &job);
    if (code == SHEAR_OK && job->content == MODEL_NONE)
        return STORE_WRONG_STATE;
    if (code == SHEAR_OK)
        job->checkpoint = next_block;
    return code;
}

int model_finish(model *m, int64_t id, bool sums, int64_t now_ms, store_finished *end) {
    model_job *job = NULL;
    const int code = find_in(m, id, STORE_RUNNING, &job);
    *end = (store_finished){0};
    if (code != SHEAR_OK)
        return code;
    if (job->cancel_asked) {
        move(m, job, STORE_CANCELLED, now_ms);
        *end = (store_finished){.state = STORE_CANCELLED};
        return SHEAR_OK;
    }
    const int64_t of = counted_before(m, job);
    if (job->field == MODEL_NONE || job->content == MODEL_NONE || (of == 0 && !sums))
        return STORE_WRONG_STATE;
    move(m, job, STORE_DONE, now_ms);
    job->outcome = of != 0 ? STORE_DUPLICATE : STORE_COUNTED;
    job->duplicate_of = of;
    *end = (store_finished){STORE_DONE, (enum store_outcome)job->outcome, of};
    m->totals.duplicates += of != 0;
    m->totals.counted += of == 0;
    if (of == 0) {
        m->contributions[m->n_contributions++] =
            (model_contribution){id, job->field, job->settings, job->content};
    }
    return SHEAR_OK;
}

int model_fail(model *m, int64_t id, int failure_class, int64_t retry_at_ms, int64_t now_ms,
               enum store_state *state) {
    model_job *job = NULL;
    const int code = find_in(m, id, STORE_RUNNING, &job);
    *state = STORE_QUEUED;
    if (code == SHEAR_OK) {
        *state = job->cancel_asked  ? STORE_CANCELLED
                 : retry_at_ms >= 0 ? STORE_WAITING
                                    : STORE_FAILED;
        move(m, job, (int)*state, now_ms);
        job->not_before_ms = *state == STORE_WAITING ? retry_at_ms : 0;
        job->failures++;
        m->totals.failures[failure_class]++;
    }
    return code;
}

int model_put_back(model *m, int64_t id, bool interrupted, int64_t now_ms,
                   enum store_state *state) {
    model_job *job = NULL;
    const int code = find_in(m, id, STORE_RUNNING, &job);
    *state = STORE_QUEUED;
    if (code == SHEAR_OK) {
        *state = job->cancel_asked ? STORE_CANCELLED : STORE_QUEUED;
        move(m, job, (int)*state, now_ms);
        job->interrupted += interrupted && *state == STORE_QUEUED;
        m->totals.interrupted += interrupted;
    }
    return code;
}

int model_cancel(model *m, int64_t id, int64_t now_ms, enum store_state *state) {
    model_job *job = find(m, id);
    *state = STORE_QUEUED;
    if (job == NULL)
        return STORE_NOT_FOUND;
    if (job->state == STORE_DONE || job->state == STORE_FAILED || job->state == STORE_RETRACTED)
        return STORE_WRONG_STATE;
    if (job->state == STORE_RUNNING) {
        job->cancel_asked = true;
    } else if (job->state != STORE_CANCELLED) {
        move(m, job, STORE_CANCELLED, now_ms);
    }
    *state = (enum store_state)job->state;
    return SHEAR_OK;
}

int model_retry(model *m, int64_t id) {
    model_job *job = find(m, id);
    if (job == NULL)
        return STORE_NOT_FOUND;
    if (job->state != STORE_FAILED && job->state != STORE_CANCELLED)
        return STORE_WRONG_STATE;
    if (!has_room(m))
        return STORE_QUEUE_FULL;
    move(m, job, STORE_QUEUED, 0);
    job->attempts = 0;
    job->failures = 0;
    job->interrupted = 0;
    return SHEAR_OK;
}

/* Take it out; the order of the others stays. The job may have been retired. */
static void take_back(model *m, int64_t at) {
    model_job *job = &m->jobs[m->contributions[at].job];
    job->state = STORE_RETRACTED;
    job->outcome = STORE_NO_OUTCOME;
    for (int64_t i = at; i + 1 < m->n_contributions; i++)
        m->contributions[i] = m->contributions[i + 1];
    m->n_contributions--;
    m->totals.retracted++;
}

int model_retract(model *m, int64_t id) {
    const model_job *job = find(m, id);
    if (job == NULL)
        return STORE_NOT_FOUND;
    if (job->state == STORE_RETRACTED)
        return SHEAR_OK;
    for (int64_t i = 0; i < m->n_contributions; i++) {
        if (m->contributions[i].job == id) {
            take_back(m, i);
            return SHEAR_OK;
        }
    }
    return STORE_WRONG_STATE;
}

static bool is_pending(const model *m, int field, int settings) {
    for (int64_t id = 1; id <= m->n_jobs; id++) {
        const model_job *job = &m->jobs[id];
        if (job->kept && job->state <= STORE_WAITING && job->field == field &&
            (settings == MODEL_NONE || job->settings == settings)) {
            return true;
        }
    }
    return false;
}

static int64_t forget_row(model *m, int field, int settings, model_forgotten *out) {
    int64_t n = 0;
    for (int64_t i = m->n_contributions - 1; i >= 0; i--) {
        const model_contribution *c = &m->contributions[i];
        if (c->field == field && c->settings == settings) {
            out->jobs += m->jobs[c->job].kept;
            take_back(m, i);
            n++;
        }
    }
    out->contributions += n;
    out->rows += n > 0;
    return n;
}

int model_forget(model *m, int field, int settings, model_forgotten *out) {
    enum { SETTINGS = 2 };
    *out = (model_forgotten){0};
    for (int pass = 0; pass < 2; pass++) { /* all or nothing: first whether it may be */
        for (int s = 0; s < SETTINGS; s++) {
            bool counted = false;
            for (int64_t i = 0; i < m->n_contributions; i++)
                counted |= m->contributions[i].field == field && m->contributions[i].settings == s;
            if (!counted || (settings != MODEL_NONE && settings != s))
                continue;
            if (pass == 0 && is_pending(m, field, settings))
                return STORE_WRONG_STATE;
            if (pass == 1)
                forget_row(m, field, s, out);
        }
    }
    return out->rows > 0 ? SHEAR_OK : STORE_NOT_FOUND;
}

/* The finished job that goes first, and how many there are. */
static model_job *oldest(model *m, int64_t *n) {
    model_job *first = NULL;
    *n = 0;
    for (int64_t id = 1; id <= m->n_jobs; id++) {
        model_job *job = &m->jobs[id];
        if (job->kept && job->state >= STORE_DONE) {
            first = first == NULL || job->finished_ms < first->finished_ms ? job : first;
            (*n)++;
        }
    }
    return first;
}

int64_t model_retire(model *m, const store_retention *rule) {
    int64_t gone = 0;
    int64_t n = 0;
    for (model_job *job = oldest(m, &n); job != NULL && gone < rule->batch; job = oldest(m, &n)) {
        if (job->finished_ms >= rule->finished_before_ms && (rule->keep < 0 || n <= rule->keep))
            break;
        job->kept = false;
        gone++;
    }
    m->totals.retired += gone;
    return gone;
}

void model_restart(model *m, int64_t now_ms) {
    enum store_state state = STORE_QUEUED;
    for (int64_t id = 1; id <= m->n_jobs; id++) {
        if (m->jobs[id].kept && m->jobs[id].state == STORE_RUNNING)
            model_put_back(m, id, true, now_ms, &state);
    }
}
