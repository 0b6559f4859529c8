/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/codes.h: error codes, states and limits of the store. */
#pragma once

#include "shear/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct store store;

enum store_code {
    STORE_QUEUE_FULL = 100, /* there are as many unfinished jobs as the caller allows */
    STORE_KEY_REUSED,       /* the owner has used this idempotency key for another request */
    STORE_NOT_FOUND,        /* no such job, field or checkpoint */
    STORE_WRONG_STATE,      /* the job's state does not allow this */
    STORE_BAD_TEXT, /* a text is longer than its limit, or empty where that is not allowed */
    STORE_LOCKED,   /* another process owns this database */
    STORE_NEWER     /* a newer version of the service wrote this database */
};

/* Sizes in bytes without the final NUL, except for the last two. */
enum {
    STORE_FIELD_MAX = 255,
    STORE_DIGEST_MAX = 128, /* settings digest, content checksum */
    STORE_KEY_MAX = 128,
    STORE_SOURCE_MAX = 65536,
    STORE_GROUPS_MAX = 1 << 20,
    STORE_SETTINGS_MAX = 65536,
    STORE_RESULT_MAX = 262144,
    STORE_ACCOUNT_MAX = 131072, /* of a contribution */
    STORE_PATH_MAX = 4096,      /* catalog */
    STORE_CODE_MAX = 64,
    STORE_MESSAGE_MAX = 1024,
    STORE_ADVICE_MAX = 1024,
    STORE_SUMS_MAX = 65536,
    STORE_PAGE_MAX = 1000,   /* records per page; larger limits are reduced to this */
    STORE_ATTEMPTS_KEPT = 64 /* the last attempts of each job */
};

/* The numbers of these enums are stored in the database: never change them. */
enum store_state {
    STORE_QUEUED = 0,
    STORE_RUNNING = 1,
    STORE_WAITING = 2, /* for its retry; this state and those above are unfinished */
    STORE_DONE = 3,
    STORE_FAILED = 4,
    STORE_CANCELLED = 5,
    STORE_RETRACTED = 6, /* was counted, and its contribution was retracted */
    STORE_N_STATES = 7
};
enum store_outcome {
    STORE_NO_OUTCOME = 0,
    STORE_COUNTED = 1,
    STORE_DUPLICATE = 2
}; /* of a done job */
enum store_origin { STORE_SPOOL = 0, STORE_SOCKET = 1 };
enum store_class { STORE_NO_CLASS = 0, STORE_TRANSIENT = 1, STORE_DATA = 2, STORE_BUG = 3 };
enum store_attempt_outcome {
    STORE_ATTEMPT_OPEN = 0,
    STORE_ATTEMPT_DONE = 1,
    STORE_ATTEMPT_FAILED = 2,
    STORE_ATTEMPT_CANCELLED = 3,
    STORE_ATTEMPT_RELEASED = 4,   /* put back into the queue by the service */
    STORE_ATTEMPT_INTERRUPTED = 5 /* the service died */
};

/* Return stable lower-case names ("queue_full", "running", ...), or "unknown" for any other number.
 * Never NULL. */
const char *store_code_name(int code); /* or of enum shear_code */
const char *store_state_name(enum store_state state);
/* Return false for the unfinished states. */
bool store_state_is_final(enum store_state state);

/* Return true if the same call may succeed later: the disk is full, an I/O error, out of memory. */
bool store_is_transient(int code);
