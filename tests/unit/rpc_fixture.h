/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rpc_fixture.h: messages filled at random through their tables, and compared through them. */
#pragma once

#include "message/table.h"
#include "rpc/methods.h"

#include <stdint.h>

/* The next of a sequence that `seed` begins. */
uint64_t next_random(uint64_t *seed);

/* Every member something that a client may send, in memory of its own (msg_deinit frees it). */
void fill(void *message, const msg_table *table, uint64_t *seed);
/* As fill, with one kind of source where the message is a submit. */
void fill_params(sheard_params *params, int method, uint64_t *seed);

/* Fails the test where two messages differ, by the member's name. */
void assert_same(const void *a, const void *b, const msg_table *table);
