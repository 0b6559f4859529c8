/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store_fixture.h"

#include "store_audit.h"
#include "store_test.h"
#include "store_vfs.h"

#include "remove_tree.h"
#include "shear/sums.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void fx_init(fixture *f) {
    const char *base = getenv("TMPDIR");
    memset(f, 0, sizeof *f);
    snprintf(f->dir, sizeof f->dir, "%s/sheard-store-XXXXXX", base != NULL ? base : "/tmp");
    assert_non_null(mkdtemp(f->dir));
    snprintf(f->path, sizeof f->path, "%s/state.db", f->dir);
    f->now = 1000000;
}

void fx_deinit(fixture *f) {
    fx_close(f);
    assert_int_equal(remove_tree(f->dir), 0);
}

int fx_setup(void **state) {
    fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    store_vfs_register();
    fx_init(f);
    f->options.vfs = store_vfs_name;
    fx_open(f);
    *state = f;
    return 0;
}

int fx_teardown(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    FX_OK(store_check(f->s, &err));
    FX_OK(store_audit(f->s, &err));
    fx_deinit(f);
    free(f);
    return 0;
}

int64_t fx_leave(fixture *f, int64_t n) {
    shear_error err = {0};
    store_removal next;
    int64_t jobs = 0;
    for (int64_t i = 0; i < n; i++) {
        FX_OK(store_next_removal(f->s, &next, &err));
        const bool none = next.forgotten == 0;
        if (!none) {
            FX_OK(store_remove(f->s, &next, false, &err));
            jobs += next.kept;
        }
        store_removal_deinit(&next);
        if (none)
            break;
    }
    return jobs;
}

int64_t fx_now(fixture *f) {
    return ++f->now;
}

void fx_open(fixture *f) {
    shear_error err = {0};
    FX_OK(store_open(&f->s, f->path, &f->options, fx_now(f), &err));
}

void fx_close(fixture *f) {
    store_close(f->s);
    f->s = NULL;
}

void fx_expect(int wanted, int code, const shear_error *err, const char *call, const char *file,
               int line) {
    if (code != wanted) {
        print_error("%s: %s instead of %s: %s\n", call, store_code_name(code),
                    store_code_name(wanted), code != SHEAR_OK ? err->message : "");
        _fail(file, line);
    }
    /* Every error says what it is. */
    if (code != SHEAR_OK && (err->code != code || err->message[0] == '\0')) {
        print_error("%s: the error is not described (%d '%s')\n", call, err->code, err->message);
        _fail(file, line);
    }
}

/* A small generator (splitmix64), the same everywhere. */
static double uniform(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

char *fx_sums(unsigned seed) {
    shear_error err = {0};
    shear_block_sums block;
    shear_field_sums *sums = NULL;
    char *text = NULL;
    uint64_t state = seed;
    shear_block_sums_init(&block);
    block.n_stamps = block.framed[SHEAR_FRAME_PIXEL] = SHEAR_BLOCK;
    block.n_used = SHEAR_BLOCK - seed % 3;
    block.flagged[0] = seed % 3;
    for (int i = 0; i < SHEAR_N_TERMS; i++) {
        block.hi[i] = 1000.0 * uniform(&state) - 400.0;
        block.lo[i] = 1e-17 * block.hi[i] * uniform(&state);
    }
    block.top = fx_top(seed);
    FX_OK(shear_field_sums_new(&sums, &err));
    shear_field_sums_add(sums, &block);
    FX_OK(shear_field_sums_format(sums, &text, &err));
    shear_field_sums_free(sums);
    return text;
}

shear_influence fx_top(unsigned seed) {
    return (shear_influence){.size = 0.1 + seed * 5 % 7, .stamp = seed * 3 % 16};
}

char *fx_old_sums(unsigned seed) {
    enum { FLAGS = 8, TERMS = 18, ZEROS = 250 };
    const unsigned flagged = seed % 3;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    fprintf(out, "shear-sums 1 %d %u %u", SHEAR_BLOCK, SHEAR_BLOCK - flagged, flagged);
    for (int i = 1; i < FLAGS; i++)
        fputs(" 0", out);
    for (int i = 0; i < TERMS; i++)
        fprintf(out, " %x%0*d", 1000u * seed + (unsigned)i + 1u, (int)ZEROS, 0);
    fclose(out);
    return text;
}

char *fx_join(const char *const *texts, size_t n) {
    shear_error err = {0};
    shear_field_sums *all = NULL;
    char *text = NULL;
    FX_OK(shear_field_sums_new(&all, &err));
    for (size_t i = 0; i < n; i++) {
        shear_field_sums *one = NULL;
        FX_OK(shear_field_sums_parse(&one, texts[i], &err));
        shear_field_sums_join(all, one);
        shear_field_sums_free(one);
    }
    FX_OK(shear_field_sums_format(all, &text, &err));
    shear_field_sums_free(all);
    return text;
}

store_spec fx_spec(fixture *f, const char *field) {
    return (store_spec){.field = field,
                        .source = "/data/a.fits",
                        .settings = "{}",
                        .settings_digest = "d0",
                        .origin = STORE_SOCKET,
                        .owner = 1000,
                        .created_ms = fx_now(f)};
}

int64_t fx_submit(fixture *f, const char *field) {
    shear_error err = {0};
    int64_t id = 0;
    bool known = true;
    const store_spec spec = fx_spec(f, field);
    FX_OK(store_submit(f->s, &spec, 1000000, &id, &known, &err));
    assert_false(known);
    return id;
}

int64_t fx_next(fixture *f) {
    shear_error err = {0};
    store_job job;
    FX_OK(store_next(f->s, fx_now(f), &job, &err));
    const int64_t id = job.id;
    store_job_deinit(&job);
    return id;
}

int64_t fx_running(fixture *f, const char *field, const char *content) {
    shear_error err = {0};
    int64_t duplicate_of = 0;
    const int64_t id = fx_submit(f, field);
    const store_input learned = {field, content, 16};
    assert_int_equal(fx_next(f), id);
    FX_OK(store_set_input(f->s, id, &learned, &duplicate_of, &err));
    return id;
}

int64_t fx_done(fixture *f, const char *field, const char *content, unsigned seed) {
    shear_error err = {0};
    store_finished end;
    const int64_t id = fx_running(f, field, content);
    char *sums = fx_sums(seed);
    const store_work work = {.sums = sums, .elapsed_us = 10, .now_ms = fx_now(f)};
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    free(sums);
    return id;
}

int fx_checkpoint(store *s, int64_t id, int64_t next_block, const char *sums, shear_error *err) {
    const store_progress progress = {.next_block = next_block, .sums = sums};
    return store_checkpoint(s, id, &progress, err);
}

int fx_state(fixture *f, int64_t id) {
    shear_error err = {0};
    store_job job;
    enum store_state state = STORE_QUEUED;
    FX_OK(store_job_get(f->s, id, &job, &err));
    FX_OK(store_job_state(f->s, id, &state, &err));
    assert_int_equal(state, job.state);
    store_job_deinit(&job);
    return (int)state;
}

store_failure fx_failure(fixture *f, int failure_class, int64_t retry_at_ms) {
    return (store_failure){.failure_class = (enum store_class)failure_class,
                           .code = "io",
                           .message = "the disk is full",
                           .advice = "make room",
                           .retry_at_ms = retry_at_ms,
                           .now_ms = fx_now(f)};
}
