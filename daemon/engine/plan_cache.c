/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One lock guards the list. No plan is made and no PSF is read while it is held. If two threads
 * lack the same plan at the same time, both make it, and the later one uses that of the earlier
 * one. */
#include "engine/plan_cache.h"

#include "base/cleanup.h"
#include "base/thread.h"

#include <assert.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/queue.h>

typedef struct key {
    char *bytes;
    size_t n;
} key;

typedef struct kept_plan {
    TAILQ_ENTRY(kept_plan) link;
    key key;
    shear_plan *plan;
    int64_t bytes;
    bool counted; /* in the statistics; idle plans always are */
    int users;
} kept_plan;

struct plan_cache {
    pthread_mutex_t lock;
    TAILQ_HEAD(plan_list_head, kept_plan) list; /* most recently used first */
    int64_t max_count, max_bytes;
    plan_cache_statistics statistics;
};

/* ---- keys ---- */

static void write_model(FILE *out, const shear_psf_model *m) {
    fprintf(out, "%d;%d;%d;%d;%a;%d;%a;", m->nx, m->ny, m->terms, m->axes, m->step, m->lanczos,
            m->smoothed_px);
    fwrite(m->samples, sizeof *m->samples, (size_t)m->terms * (size_t)m->nx * (size_t)m->ny, out);
}

/* Make a key of all that a plan depends on: equal keys mean equal plans. The caller frees it, also
 * after a failure. */
static bool key_make(key *k, const shear_plan_request *request) {
    const shear_geometry *g = &request->geometry;
    size_t n_settings = 0;
    const shear_setting_def *table = shear_settings_table(&n_settings);
    const size_t n_psf =
        request->psf != NULL ? (size_t)g->psf_nx * (size_t)g->psf_ny * sizeof *request->psf : 0;
    FILE *out = open_memstream(&k->bytes, &k->n);
    if (out == NULL)
        return false;
    for (size_t i = 0; i < n_settings; i++) {
        char value[64];
        fprintf(out, "%s;",
                shear_settings_format(request->settings, &table[i], value, sizeof value));
    }
    fprintf(out, "%d;%d;%d;%d;%a;%d;%a;%a;", g->nx, g->ny, g->psf_nx, g->psf_ny, g->psf_oversample,
            request->has_r_gal, request->psf != NULL ? 0.0 : request->r_psf_px, request->core_px);
    fwrite(request->psf != NULL ? (const void *)request->psf : "", 1, n_psf, out);
    fprintf(out, "%d;%a;%d;", request->frame, request->pixel_scale, request->n_models);
    for (int i = 0; i < request->n_models; i++)
        write_model(out, &request->models[i]);
    if (request->n_models > 0) {
        fprintf(out, "%d;", request->model);
        fwrite(request->terms, sizeof *request->terms, (size_t)request->models[0].terms, out);
    }
    const shear_centring *c = &request->centring;
    fprintf(out, "%" PRId64 ";%" PRId64 ";%a;%a;%a;%a;", c->looked_at, c->found, c->x, c->y,
            c->x_err, c->y_err);
    fprintf(out, "%d;%d;", request->n_psfs, request->n_unusable);
    for (int i = 0; i < request->n_psfs; i++)
        fwrite(&request->psfs[i], 1, sizeof request->psfs[i], out);
    return fclose(out) == 0;
}

static void key_deinit(key *k) {
    free(k->bytes);
}

/* ---- under the lock ---- */

static kept_plan *find(plan_cache *p, const key *k) {
    kept_plan *kept = NULL;
    TAILQ_FOREACH(kept, &p->list, link) {
        if (kept->key.n == k->n && memcmp(kept->key.bytes, k->bytes, k->n) == 0)
            return kept;
    }
    return NULL;
}

static void use(plan_cache *p, kept_plan *kept) {
    kept->users++;
    TAILQ_REMOVE(&p->list, kept, link);
    TAILQ_INSERT_HEAD(&p->list, kept, link);
}

static void kept_free(kept_plan *kept) {
    if (kept != NULL) {
        shear_plan_free(kept->plan);
        key_deinit(&kept->key);
    }
    free(kept);
}

CLEANUP_DEFINE(kept_plan, kept_free)

/* Free idle plans, the least recently used first, until the rest is within the limits. */
static void shrink(plan_cache *p, int64_t max_count, int64_t max_bytes) {
    kept_plan *next = NULL;
    for (kept_plan *kept = TAILQ_LAST(&p->list, plan_list_head); kept != NULL; kept = next) {
        next = TAILQ_PREV(kept, plan_list_head, link);
        if (p->statistics.count <= max_count && p->statistics.bytes <= max_bytes)
            return;
        if (kept->users == 0) {
            TAILQ_REMOVE(&p->list, kept, link);
            p->statistics.count--;
            p->statistics.bytes -= kept->bytes;
            kept_free(kept);
        }
    }
}

static kept_plan *find_plan(plan_cache *p, const shear_plan *plan) {
    kept_plan *kept = TAILQ_FIRST(&p->list);
    while (kept->plan != plan)
        kept = TAILQ_NEXT(kept, link);
    assert(kept->users > 0);
    return kept;
}

/* Add a plan to the statistics, unless it is already part of them. */
static void count(plan_cache *p, kept_plan *kept) {
    if (!kept->counted) {
        kept->counted = true;
        p->statistics.count++;
        p->statistics.bytes += kept->bytes;
    }
}

/* ---- public functions ---- */

plan_cache *plan_cache_new(int64_t max_count, int64_t max_bytes) {
    plan_cache *p = calloc(1, sizeof *p);
    if (p != NULL) {
        pthread_mutex_init(&p->lock, NULL);
        TAILQ_INIT(&p->list);
        p->max_count = max_count;
        p->max_bytes = max_bytes;
    }
    return p;
}

void plan_cache_limit(plan_cache *p, int64_t max_count, int64_t max_bytes) {
    LOCKED(&p->lock);
    p->max_count = max_count;
    p->max_bytes = max_bytes;
    shrink(p, p->max_count, p->max_bytes);
}

void plan_cache_free(plan_cache *p) {
    if (p == NULL)
        return;
    plan_cache_limit(p, 0, 0);
    pthread_mutex_destroy(&p->lock);
    free(p);
}

/* Make a plan and keep it, unless another thread has kept an equal one meanwhile. */
static int make(plan_cache *p, key *k, const shear_plan_request *request, const shear_plan **plan,
                shear_error *err) {
    CLEANUP(kept_plan_release) kept_plan *fresh = calloc(1, sizeof *fresh);
    if (fresh == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a plan");
    TRY(shear_plan_new(&fresh->plan, request, err));
    fresh->key = *k;
    *k = (key){0};
    fresh->bytes = shear_plan_bytes(fresh->plan) + (int64_t)fresh->key.n;
    LOCKED(&p->lock);
    kept_plan *kept = find(p, &fresh->key);
    if (kept == NULL) {
        kept = CLEANUP_TAKE(fresh);
        TAILQ_INSERT_HEAD(&p->list, kept, link);
    }
    use(p, kept);
    *plan = kept->plan;
    return SHEAR_OK;
}

static const shear_plan *acquire_kept(plan_cache *p, const key *k) {
    LOCKED(&p->lock);
    kept_plan *kept = find(p, k);
    if (kept != NULL)
        use(p, kept);
    p->statistics.hits += kept != NULL;
    p->statistics.misses += kept == NULL;
    return kept != NULL ? kept->plan : NULL;
}

int plan_cache_acquire(plan_cache *p, const shear_plan_request *request, const shear_plan **plan,
                       shear_error *err) {
    CLEANUP(key_deinit) key k = {0};
    *plan = NULL;
    if (!key_make(&k, request))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a plan");
    *plan = acquire_kept(p, &k);
    return *plan != NULL ? SHEAR_OK : make(p, &k, request, plan, err);
}

int64_t plan_cache_shrink_to(plan_cache *p, int64_t bytes) {
    LOCKED(&p->lock);
    shrink(p, INT64_MAX, bytes);
    return p->statistics.bytes;
}

void plan_cache_count(plan_cache *p, const shear_plan *plan) {
    LOCKED(&p->lock);
    count(p, find_plan(p, plan));
    shrink(p, p->max_count, p->max_bytes);
}

void plan_cache_release(plan_cache *p, const shear_plan *plan) {
    if (plan == NULL)
        return;
    LOCKED(&p->lock);
    kept_plan *kept = find_plan(p, plan);
    count(p, kept);
    kept->users--;
    shrink(p, p->max_count, p->max_bytes);
}

plan_cache_statistics plan_cache_get_statistics(plan_cache *p) {
    LOCKED(&p->lock);
    return p->statistics;
}
