/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_field without libFuzzer:
 *   fuzz_field FILE...            each file once
 *   fuzz_field --mutants N [M]    mutants N to M (or 0 to N) of a set of small good field files,
 * always the same ones fuzz_field --corpus DIRECTORY the good files themselves, to begin a
 * libFuzzer run with A mutant that crashes is named on standard error; --mutants with its number
 * alone repeats it. */
#include "fits_fixture.h"
#include "fuzz_field.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEEDS = 9, BLOCK = 2880, CARD = 80, SECONDS = 20 };

typedef struct bytes {
    unsigned char *data;
    size_t size;
} bytes;

/* splitmix64: the draw depends on the mutant's number only. */
static uint64_t state;
static uint64_t draw(void) {
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}
static size_t below(size_t n) {
    return n == 0 ? 0 : (size_t)(draw() % n);
}

static void write_seed(int i, const char *path) {
    static const struct {
        int algorithm, bitpix;
    } packed[] = {{RICE_1, 16}, {GZIP_2, -32}, {PLIO_1, 16}, {HCOMPRESS_1, 16}, {RICE_1, -32}};
    shear_field_spec s = fixture_spec();
    if (i == 1 || i == 8) {
        s.layout = SHEAR_LAYOUT_MOSAIC;
        s.n_psf = 4;
        s.columns = SHEAR_COL_PSF_ID | SHEAR_COL_ID | SHEAR_COL_X | SHEAR_COL_FLAGS;
    }
    if (i == 2) {
        s.bitpix = -64;
        s.n_psf = s.n_stamps;
        s.columns = SHEAR_COL_WEIGHT;
    }
    if (i < 3) {
        fixture_write(path, &s);
    } else if (i < 8) {
        const fixture_image image = {.bitpix = packed[i - 3].bitpix,
                                     .axes = {13, 9},
                                     .compression = packed[i - 3].algorithm,
                                     .lossy = i == 7,
                                     .tile = {13, 9, 1}};
        fixture_write_like(path, &image, 5);
    } else {
        const char *plain = fixture_path("plain.fits");
        fixture_write(plain, &s);
        fixture_gzip(plain, path);
    }
}

/* A card of some header: they are all at multiples of 80, and mostly letters. */
static unsigned char *any_card(bytes b) {
    for (int tries = 0; tries < 1000; tries++) {
        unsigned char *card = b.data + below(b.size / CARD) * CARD;
        if (card[8] == '=' && card[0] >= 'A' && card[0] <= 'Z') {
            return card;
        }
    }
    return b.data;
}

static void mutate_card(bytes b) {
    static const char *const values[] = {"0",
                                         "-1",
                                         "1",
                                         "2",
                                         "3",
                                         "7",
                                         "255",
                                         "1000",
                                         "65536",
                                         "2147483647",
                                         "2147483648",
                                         "-2147483648",
                                         "4294967296",
                                         "100000000",
                                         "9223372036854775807",
                                         "-9223372036854775808",
                                         "1E308",
                                         "1E-320",
                                         "NaN",
                                         "T",
                                         "F",
                                         "'NONE'",
                                         "'RICE_1'",
                                         "'GZIP_1'",
                                         "'PLIO_1'",
                                         "'HCOMPRESS_1'",
                                         "'1PB'",
                                         "'1QD'",
                                         "'1000000000D'",
                                         "'GALAXY'",
                                         "'COMPRESSED_DATA'",
                                         "'BINTABLE'",
                                         "'",
                                         "",
                                         "/"};
    unsigned char *card = any_card(b);
    if (b.size < CARD) {
        return;
    }
    if (below(4) == 0) { /* another card's content, or another keyword's name */
        memcpy(card, any_card(b), below(2) == 0 ? CARD : 8);
        return;
    }
    char text[CARD + 1];
    snprintf(text, sizeof text, " %-69s", values[below(sizeof values / sizeof values[0])]);
    memcpy(card + 9, text, CARD - 10);
}

static void mutate_bytes(bytes b) {
    static const unsigned char extremes[] = {0, 1, 0x7f, 0x80, 0xff, ' '};
    const size_t at = below(b.size);
    switch (below(3)) {
    case 0:
        b.data[at] ^= (unsigned char)(1u << below(8));
        break;
    case 1:
        b.data[at] = (unsigned char)draw();
        break;
    default:
        for (size_t k = 0; k < 1 + below(8) && at + k < b.size; k++) {
            b.data[at + k] = extremes[below(sizeof extremes)];
        }
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
            const size_t n = b->size / BLOCK;
            memmove(b->data + below(n) * BLOCK, b->data + below(n) * BLOCK, n > 0 ? BLOCK : 0);
            break;
        }
        case 2:
        case 3:
        case 4:
            mutate_card(*b);
            break;
        default:
            mutate_bytes(*b);
        }
    }
}

static volatile sig_atomic_t current;

/* Says which mutant it was; then the default action. */
static void on_signal(int number) {
    char text[64] = "fuzz_field: died at mutant ";
    size_t n = strlen(text);
    char digits[16];
    int k = 0;
    int value = current;
    do {
        digits[k++] = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    while (k > 0) {
        text[n++] = digits[--k];
    }
    text[n++] = '\n';
    if (write(STDERR_FILENO, text, n) < 0) {
        _exit(1);
    }
    signal(number, SIG_DFL);
    raise(number);
}

static int open_descriptors(void) {
    int n = 0;
    for (int fd = 0; fd < 64; fd++) {
        n += fcntl(fd, F_GETFD) >= 0;
    }
    return n;
}

static int run_mutants(const bytes seeds[SEEDS], int from, int to) {
    unsigned char *copy = malloc(1 << 20);
    const int descriptors = open_descriptors();
    int failed = copy == NULL;
    for (int i = from; i < to && !failed; i++) {
        const bytes *seed = &seeds[i % SEEDS];
        current = i;
        state = (uint64_t)i;
        bytes b = {copy, seed->size};
        memcpy(copy, seed->data, seed->size);
        if (i >= SEEDS) { /* the first ones are the good files themselves */
            mutate(&b);
        }
        alarm(SECONDS);
        LLVMFuzzerTestOneInput(b.data, b.size);
        alarm(0);
        if (open_descriptors() != descriptors) {
            fprintf(stderr, "fuzz_field: mutant %d left a descriptor open\n", i);
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

/* What is mutated must be good to begin with, or nothing is tried. */
static bool is_good(const char *path) {
    shear_field *field = NULL;
    shear_error err = {0};
    if (shear_field_open(&field, path, &err) != SHEAR_OK) {
        fprintf(stderr, "fuzz_field: %s\n", err.message);
    }
    shear_field_close(field);
    return err.code == SHEAR_OK;
}

static int run_seeds(const char *option, int argc, char **argv) {
    bytes seeds[SEEDS];
    if (fixture_setup(NULL) != 0) {
        return 1;
    }
    bool good = true;
    const int corpus = strcmp(option, "--corpus") == 0;
    for (int i = 0; i < SEEDS; i++) {
        const char *path = fixture_path("seed.fits");
        write_seed(i, path);
        seeds[i].data = fixture_load(path, &seeds[i].size);
        good = good && is_good(path);
        if (corpus && argc > 0) {
            char out[600];
            snprintf(out, sizeof out, "%s/seed-%d.fits", argv[0], i);
            fixture_save(out, seeds[i].data, seeds[i].size);
        }
    }
    const int first = argc > 0 ? (int)strtol(argv[0], NULL, 10) : 300;
    const int last = argc > 1 ? (int)strtol(argv[1], NULL, 10) : first + 1;
    const int rc = !good    ? 1
                   : corpus ? 0
                            : run_mutants(seeds, argc > 1 ? first : 0, argc > 1 ? last : first);
    for (int i = 0; i < SEEDS; i++) {
        free(seeds[i].data);
    }
    fixture_teardown(NULL);
    return rc;
}

int main(int argc, char **argv) {
    static const int signals[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        signal(signals[i], on_signal);
    }
    if (argc > 1 && strncmp(argv[1], "--", 2) == 0) {
        return run_seeds(argv[1], argc - 2, argv + 2);
    }
    int rc = 0;
    for (int i = 1; i < argc; i++) {
        rc |= run_file(argv[i]);
    }
    return rc;
}
