/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "random.h"

#include <Random123/philox.h>
#include <string.h>

static uint64_t next(random_state *s) {
    if (s->next == 4) {
        philox4x64_ctr_t counter = {{s->index, s->item, s->block++, 0}};
        philox4x64_key_t key = {{s->seed, s->stream}};
        philox4x64_ctr_t out = philox4x64(counter, key);
        memcpy(s->out, out.v, sizeof s->out);
        s->next = 0;
    }
    return s->out[s->next++];
}

static void restart(random_state *s) {
    s->block = 0;
    s->next = 4;
}

/* Seed as GSL does: stream 0, which no mock uses. */
static void set(void *state, unsigned long seed) {
    random_state *s = state;
    *s = (random_state){.seed = seed};
    restart(s);
}

/* Return 32 bits: unsigned long may have no more. */
static unsigned long get(void *state) {
    return (unsigned long)(next(state) >> 32);
}

/* Return a number in [0, 1) with 53 random bits. */
static double get_double(void *state) {
    return (double)(next(state) >> 11) * 0x1p-53;
}

static const gsl_rng_type philox = {.name = "philox4x64-10",
                                    .max = 0xffffffffUL,
                                    .min = 0,
                                    .size = sizeof(random_state),
                                    .set = set,
                                    .get = get,
                                    .get_double = get_double};

void random_begin(random_sequence *r, uint64_t seed, int stream, uint64_t index, uint64_t item) {
    r->rng = (gsl_rng){.type = &philox, .state = &r->state};
    r->state =
        (random_state){.seed = seed, .stream = (uint64_t)stream, .index = index, .item = item};
    restart(&r->state);
}

void random_item(random_sequence *r, uint64_t item) {
    r->state.item = item;
    restart(&r->state);
}
