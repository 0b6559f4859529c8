/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/store_fixture.h: a store in a directory of its own, and what its tests do over and
 * over. */
#pragma once

#include "store/store.h"

#include "shear/sums.h"

typedef struct fixture {
    char dir[256];
    char path[300];
    store *s;
    store_options options;
    int64_t now; /* the clock: every use of fx_now moves it */
} fixture;

/* A new directory, no store yet; and everything gone again. */
void fx_init(fixture *f);
void fx_deinit(fixture *f);
/* Open (again); fails the test where that is not possible. */
void fx_open(fixture *f);
void fx_close(fixture *f);
int64_t fx_now(fixture *f);

/* The test fails, with the error's message, where `code` is not SHEAR_OK, or not `wanted`. */
#define FX_OK(call)           fx_expect(SHEAR_OK, (call), &err, #call, __FILE__, __LINE__)
#define FX_CODE(wanted, call) fx_expect((wanted), (call), &err, #call, __FILE__, __LINE__)
void fx_expect(int wanted, int code, const shear_error *err, const char *call, const char *file,
               int line);

/* Exact sums of one made-up block; the same seed gives the same text. Malloc'd. */
char *fx_sums(unsigned seed);
/* The stamp that counts most in them: few sizes, so that some seeds have the same. */
shear_influence fx_top(unsigned seed);
/* Sums as version 0.1 wrote them. Malloc'd. */
char *fx_old_sums(unsigned seed);
/* The exact join of n texts. Malloc'd. */
char *fx_join(const char *const *texts, size_t n);

/* A plain request: owner 1000, settings "{}", origin socket, created now. */
store_spec fx_spec(fixture *f, const char *field);
int64_t fx_submit(fixture *f, const char *field);
/* Submit, start (it must be the next one) and learn. */
int64_t fx_running(fixture *f, const char *field, const char *content);
/* The same, and finish with fx_sums(seed). */
int64_t fx_done(fixture *f, const char *field, const char *content, unsigned seed);
/* Checkpoint blocks [0, next_block), without terms. */
int fx_checkpoint(store *s, int64_t id, int64_t next_block, const char *sums, shear_error *err);
/* Start the next job; 0 where there is none. */
int64_t fx_next(fixture *f);
int fx_state(fixture *f, int64_t id);
/* At most n steps of what is to leave of forgotten fields; returns how many jobs were retracted. */
int64_t fx_leave(fixture *f, int64_t n);
store_failure fx_failure(fixture *f, int failure_class, int64_t retry_at_ms);
