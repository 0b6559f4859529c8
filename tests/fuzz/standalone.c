/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_field and fuzz_exposure without libFuzzer:
 *   fuzz_field FILE...            each file once
 *   fuzz_field --mutants N [M]    mutants N to M (or 0 to N) of a set of small good files, always
 *                                 the same ones
 *   fuzz_field --corpus DIRECTORY the good files themselves, to begin a libFuzzer run with
 * A mutant that crashes is named on standard error; --mutants with its number alone repeats it. */
#include "cards.h"
#include "fits_fixture.h"
#include "fuzz_field.h"
#include "seeds.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SECONDS = 20 };

typedef fuzz_bytes bytes;

/* The draw depends on the mutant's number only. */
static uint64_t state;
static size_t below(size_t n) {
    return fuzz_below(&state, n);
}

static void mutate_bytes(bytes b) {
    static const unsigned char extremes[] = {0, 1, 0x7f, 0x80, 0xff, ' '};
    const size_t at = below(b.size);
    switch (below(3)) {
    case 0:
        b.data[at] ^= (unsigned char)(1u << below(8));
        break;
    case 1:
        b.data[at] = (unsigned char)fuzz_draw(&state);
        break;
    default:
        for (size_t k = 0; k < 1 + below(8) && at + k < b.size; k++)
            b.data[at + k] = extremes[below(sizeof extremes)];
    }
}

static void mutate(bytes *b) {
    const size_t rounds = 1 + below(4);
    for (size_t i = 0; i < rounds && b->size > 0; i++) {
        switch (below(8)) {
        case 0:
            b->size = below(b->size + 1);
            break;
        case 1: { /* one block over another */
            const size_t n = b->size / FUZZ_BLOCK;
            memmove(b->data + below(n) * FUZZ_BLOCK, b->data + below(n) * FUZZ_BLOCK,
                    n > 0 ? FUZZ_BLOCK : 0);
            break;
        }
        case 2:
        case 3:
        case 4:
            fuzz_mutate_card(b->data, b->size, &state);
            break;
        default:
            mutate_bytes(*b);
        }
    }
}

static volatile sig_atomic_t current;

/* Says which mutant it was; then the default action. */
static void on_signal(int number) {
    char text[64] = "fuzz: died at mutant ";
    size_t n = strlen(text);
    char digits[16];
    int k = 0;
    int value = current;
    do {
        digits[k++] = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    while (k > 0)
        text[n++] = digits[--k];
    text[n++] = '\n';
    if (write(STDERR_FILENO, text, n) < 0)
        _exit(1);
    signal(number, SIG_DFL);
    raise(number);
}

static int open_descriptors(void) {
    int n = 0;
    for (int fd = 0; fd < 64; fd++)
        n += fcntl(fd, F_GETFD) >= 0;
    return n;
}

static int run_mutants(const bytes seeds[FUZZ_SEEDS], int from, int to) {
    unsigned char *copy = malloc(1 << 20);
    const int descriptors = open_descriptors();
    int failed = copy == NULL;
    for (int i = from; i < to && failed == 0; i++) {
        const bytes *seed = &seeds[i % FUZZ_SEEDS];
        current = i;
        state = (uint64_t)i;
        bytes b = {copy, seed->size};
        memcpy(copy, seed->data, seed->size);
        if (i >= FUZZ_SEEDS) { /* the first ones are the good files themselves */
            mutate(&b);
        }
        alarm(SECONDS);
        LLVMFuzzerTestOneInput(b.data, b.size);
        alarm(0);
        if (open_descriptors() != descriptors) {
            fprintf(stderr, "fuzz: mutant %d left a descriptor open\n", i);
            failed = 1;
        }
    }
    free(copy);
    return failed;
}

static int run_file(const char *path) {
    size_t size = 0;
    unsigned char *data = fixture_load(path, &size);
    LLVMFuzzerTestOneInput(data, size);
    free(data);
    return 0;
}

static int run_seeds(const char *option, int argc, char **argv) {
    bytes seeds[FUZZ_SEEDS];
    if (fixture_setup(NULL) != 0)
        return 1;
    bool good = true;
    const int corpus = strcmp(option, "--corpus") == 0;
    for (int i = 0; i < FUZZ_SEEDS; i++) {
        const char *path = fixture_path("good.fits");
        seeds[i] = fuzz_seed(i);
        fixture_save(path, seeds[i].data, seeds[i].size);
        good = good && fuzz_seed_is_good(path); /* or nothing is tried */
        if (corpus != 0 && argc > 0) {
            char out[600];
            snprintf(out, sizeof out, "%s/seed-%d.fits", argv[0], i);
            fixture_save(out, seeds[i].data, seeds[i].size);
        }
    }
    const int first = argc > 0 ? (int)strtol(argv[0], NULL, 10) : 300;
    const int last = argc > 1 ? (int)strtol(argv[1], NULL, 10) : first + 1;
    const int rc = !good ? 1
                   : corpus != 0
                       ? 0
                       : run_mutants(seeds, argc > 1 ? first : 0, argc > 1 ? last : first);
    for (int i = 0; i < FUZZ_SEEDS; i++)
        free(seeds[i].data);
    fixture_teardown(NULL);
    return rc;
}

int main(int argc, char **argv) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        signal(signals[i], on_signal);
    if (argc > 1 && strncmp(argv[1], "--", 2) == 0)
        return run_seeds(argv[1], argc - 2, argv + 2);
    int rc = 0;
    for (int i = 1; i < argc; i++)
        rc |= run_file(argv[i]);
    return rc;
}
