/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The names of the store's states and codes. */
#include "store/store.h"

static const char *name_in(const char *const *names, int n, int value) {
    return value >= 0 && value < n ? names[value] : "unknown";
}
#define NAME_IN(names, value) name_in(names, (int)(sizeof(names) / sizeof(names)[0]), (int)(value))

const char *store_code_name(int code) {
    static const char *const names[] = {"queue_full", "key_reused", "not_found", "wrong_state",
                                        "bad_text",   "locked",     "newer"};
    return code < STORE_QUEUE_FULL ? shear_code_name(code)
                                   : NAME_IN(names, code - STORE_QUEUE_FULL);
}

const char *store_state_name(enum store_state state) {
    static const char *const names[] = {"queued", "running",   "waiting",  "done",
                                        "failed", "cancelled", "retracted"};
    return NAME_IN(names, state);
}

bool store_state_is_final(enum store_state state) {
    return state >= STORE_DONE && state < STORE_N_STATES;
}

bool store_is_transient(int code) {
    return code == SHEAR_E_IO || code == SHEAR_E_FULL || code == SHEAR_E_NOMEM;
}
