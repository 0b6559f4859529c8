/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/must.h"

#include "engine/progress.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

_Thread_local shear_error must_error;

/* End the program. If several threads fail at once, the first one does it. */
static _Noreturn void end(int code) {
    static atomic_flag ending = ATOMIC_FLAG_INIT;
    while (atomic_flag_test_and_set(&ending))
        pause();
    progress_end();
    fprintf(stderr, "shear-paper: error: %s\n", must_error.message);
    if (must_error.advice[0] != '\0')
        fprintf(stderr, "  %s\n", must_error.advice);
    exit(code == SHEAR_E_SETTING ? EXIT_CODE_USAGE : EXIT_CODE_OTHER);
}

void must(int code) {
    if (code != SHEAR_OK)
        end(code);
}

void must_fail(int code, const char *advice, const char *format, ...) {
    char message[sizeof must_error.message];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    end(shear_fail(&must_error, code, advice, "%s", message));
}

void *must_allocate(size_t n, size_t size, const char *what) {
    void *made = calloc(n > 0 ? n : 1, size);
    if (made == NULL)
        must_fail(SHEAR_E_NOMEM, NULL, "out of memory for %s", what);
    return made;
}

void must_allocate_arrays(size_t n, double **const arrays[], size_t size, const char *what) {
    double *first = must_allocate(n * size, sizeof *first, what);
    for (size_t i = 0; i < n; i++)
        *arrays[i] = first + i * size;
}
