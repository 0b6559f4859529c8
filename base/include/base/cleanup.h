/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/cleanup.h: release local variables when their block ends, however it is left.
 *
 *     CLEANUP(release_free) char *text = malloc(n);      // an owned pointer
 *     CLEANUP(release_fd) int fd = open(path, O_RDONLY); // negative: none
 *     CLEANUP(cards_deinit) cards c = {0};               // deinit functions take the address
 *
 * A local must be initialised where it is declared: to NULL, -1 or an empty struct if nothing is
 * owned yet. Locals are released in reverse order. Use CLEANUP_TAKE for a pointer that is returned
 * or given away:
 *
 *     return CLEANUP_TAKE(text);
 *
 * and TRY for a call whose error ends the function:
 *
 *     TRY(read_header(t, f, err)); */
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* (`unused`: clang would warn of a variable that is only there to be released.) */
#define CLEANUP(release) __attribute__((cleanup(release), unused))

/* Define TYPE_release(TYPE **), for CLEANUP(TYPE_release) TYPE *p, from a free function that
 * accepts NULL:
 *
 *     CLEANUP_DEFINE(plan, plan_free) */
/* clang-format off */
#define CLEANUP_DEFINE(type, free_function)                                                        \
    static inline __attribute__((unused)) void type##_release(type **p) { /* NOLINT(bugprone-macro-parentheses) */ \
        free_function(*p);                                                                         \
    }
/* clang-format on */

/* Return the value of a pointer variable and set the variable to NULL. */
#define CLEANUP_TAKE(pointer)                                                                      \
    __extension__({                                                                                \
        __typeof__(pointer) cleanup_taken_ = (pointer);                                            \
        (pointer) = NULL;                                                                          \
        cleanup_taken_;                                                                            \
    })

/* Return the code of `call`, an int or an enum, from this function if it is not 0 (OK). */
#define TRY(call)                                                                                  \
    do {                                                                                           \
        const __typeof__(call) try_code_ = (call);                                                 \
        if (try_code_ != 0)                                                                        \
            return try_code_;                                                                      \
    } while (0)

/* Free any pointer variable; p is its address. */
static inline void release_free(void *p) {
    void *owned = NULL;
    memcpy(&owned, p, sizeof owned);
    free(owned);
}

static inline void release_fd(const int *fd) {
    if (*fd >= 0)
        close(*fd);
}

static inline void release_file(FILE **file) {
    if (*file != NULL)
        fclose(*file);
}
