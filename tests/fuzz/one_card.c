/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One card of a good field file is changed, in all ways in turn, and the file is opened and read.
 *   one_card --all              every mutant
 *   one_card --sample N [SEED]  N of them, always the same ones
 *   one_card --one MUTANT       one alone, by its number
 * Two laws: nothing crashes; and what is still accepted gives the numbers that the good file gives,
 * unless the card is one that says what the numbers are (decides()).
 * Mutants run in batches, each in a child of its own: a crash is that of the mutant which the child
 * has noted down in shared memory, and the rest of the batch goes on in another child. */
#include "cards.h"
#include "fits_fixture.h"
#include "seeds.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xxhash.h>

enum { MAX_CARDS = 4000, KEY = 8, BATCH = 500, SECONDS = 20, EXTRA = 3 };
enum { MAX_BLOCK_BYTES = 64 << 20 };

/* A card of a seed. */
typedef struct place {
    int seed, hdu;
    size_t offset;
    char key[KEY + 1], next[KEY + 1]; /* and of the card behind it */
    char name[KEY + 1];               /* EXTNAME of the HDU, "" = primary */
    bool packed;                      /* the HDU is a compressed image */
} place;

static fuzz_bytes seeds[FUZZ_SEEDS];
static uint64_t good[FUZZ_SEEDS]; /* digests */
static place places[MAX_CARDS];
static int n_places;

/* ---- reading ---- */

static void add(XXH64_state_t *h, const void *values, size_t bytes) {
    if (values != NULL)
        XXH64_update(h, values, bytes);
}

static bool add_stamps(XXH64_state_t *h, shear_field *field, const shear_field_info *info) {
    enum { CHUNK = 4 };
    shear_block *b = NULL;
    if (info->n_stamps > 1000 || shear_block_bytes(info, CHUNK) > MAX_BLOCK_BYTES ||
        shear_block_new(&b, info, CHUNK, NULL) != SHEAR_OK) {
        return false;
    }
    const size_t stamp = (size_t)info->geometry.nx * (size_t)info->geometry.ny * sizeof(double);
    bool read = true;
    for (int64_t i = 0; i < info->n_stamps && read; i += CHUNK) {
        const int n = info->n_stamps - i < CHUNK ? (int)(info->n_stamps - i) : CHUNK;
        read = shear_field_read(field, i, n, b, NULL) == SHEAR_OK;
        add(h, b->galaxy, (size_t)n * stamp);
        add(h, b->noise, (size_t)n * stamp);
        add(h, b->id, (size_t)n * sizeof *b->id);
        add(h, b->x, (size_t)n * sizeof *b->x);
        add(h, b->ra, (size_t)n * sizeof *b->ra);
        add(h, b->weight, (size_t)n * sizeof *b->weight);
        add(h, b->r_gal, (size_t)n * sizeof *b->r_gal);
        add(h, b->mask, (size_t)n * sizeof *b->mask);
    }
    shear_block_free(b);
    return read;
}

static bool add_psf(XXH64_state_t *h, shear_field *field, const shear_field_info *info) {
    bool read = info->n_psf <= 1000 && shear_psf_bytes(info) <= MAX_BLOCK_BYTES;
    double *psf = read ? calloc(1, shear_psf_bytes(info)) : NULL;
    for (int64_t i = 0; i < info->n_psf && read; i++) {
        read = psf != NULL && shear_field_read_psf(field, i, psf, NULL) == SHEAR_OK;
        add(h, psf, shear_psf_bytes(info));
    }
    free(psf);
    return read;
}

static void add_info(XXH64_state_t *h, const shear_field_info *info) {
    add(h, info->name, strlen(info->name));
    add(h, &info->pixscale, sizeof info->pixscale);
    add(h, &info->sim_g1, sizeof info->sim_g1);
    add(h, &info->sim_g2, sizeof info->sim_g2);
    add(h, &info->geometry.psf_oversample, sizeof info->geometry.psf_oversample);
    add(h, &info->n_stamps, sizeof info->n_stamps);
}

/* Of all that the file says; 0 where it is refused. */
static uint64_t digest(const uint8_t *bytes, size_t size) {
    const int fd = memfd_create("field", MFD_CLOEXEC);
    shear_field *field = NULL;
    XXH64_state_t *h = XXH64_createState();
    uint64_t out = 0;
    XXH64_reset(h, 0);
    if (write(fd, bytes, size) == (ssize_t)size &&
        shear_field_open_fd(&field, fd, "input.fits", NULL) == SHEAR_OK) {
        const shear_field_info *info = shear_field_get_info(field);
        add_info(h, info);
        out = add_stamps(h, field, info) && add_psf(h, field, info) ? XXH64_digest(h) | 1u : 0;
    }
    shear_field_close(field);
    XXH64_freeState(h);
    close(fd);
    return out;
}

/* ---- mutants ---- */

static void key_of(const uint8_t *card, char key[KEY + 1]) {
    int n = KEY;
    while (n > 0 && card[n - 1] == ' ')
        n--;
    memcpy(key, card, (size_t)n);
    key[n] = '\0';
}

static bool is_header(const fuzz_bytes *b, size_t at) {
    return at + FUZZ_BLOCK <= b->size &&
           (memcmp(b->data + at, "SIMPLE  =", 9) == 0 || memcmp(b->data + at, "XTENSION=", 9) == 0);
}

static void list_header(int seed, int hdu, size_t at) {
    const fuzz_bytes *b = &seeds[seed];
    const int first = n_places;
    char name[KEY + 1] = "";
    bool packed = false;
    for (size_t i = at; i + FUZZ_CARD <= b->size && n_places < MAX_CARDS; i += FUZZ_CARD) {
        place *p = &places[n_places++];
        *p = (place){.seed = seed, .hdu = hdu, .offset = i};
        key_of(b->data + i, p->key);
        if (strcmp(p->key, "EXTNAME") == 0)
            sscanf((const char *)b->data + i + 10, "'%8[A-Z]", name);
        packed = packed || strcmp(p->key, "ZIMAGE") == 0;
        if (strcmp(p->key, "END") == 0)
            break;
        key_of(b->data + i + FUZZ_CARD, p->next);
    }
    for (int i = first; i < n_places; i++) {
        memcpy(places[i].name, name, sizeof name);
        places[i].packed = packed;
    }
}

static void list_places(void) {
    for (int i = 0; i < FUZZ_SEEDS; i++) {
        int hdu = 0;
        for (size_t at = 0; at < seeds[i].size; at += FUZZ_BLOCK) {
            if (is_header(&seeds[i], at))
                list_header(i, hdu++, at);
        }
    }
}

static int n_ways(void) {
    return fuzz_n_values + EXTRA;
}

static void name_of(int mutant, char *out, size_t size) {
    static const char *const extra[EXTRA] = {"(gone)", "(twice)", "(swapped)"};
    const place *p = &places[mutant / n_ways()];
    const int way = mutant % n_ways();
    snprintf(out, size, "%d: %s, HDU %d (%s), %s = %s", mutant, fuzz_seed_name(p->seed), p->hdu,
             p->name, p->key, way < fuzz_n_values ? fuzz_values[way] : extra[way - fuzz_n_values]);
}

static void apply(int mutant, uint8_t *data) {
    uint8_t *card = data + places[mutant / n_ways()].offset;
    uint8_t kept[FUZZ_CARD];
    memcpy(kept, card, sizeof kept);
    const int way = mutant % n_ways() - fuzz_n_values;
    if (way < 0) {
        fuzz_set_value(card, fuzz_values[mutant % n_ways()]);
    } else if (way == 0) {
        memset(card, ' ', FUZZ_CARD);
    } else {
        if (way == 2)
            memcpy(card, card + FUZZ_CARD, FUZZ_CARD);
        memcpy(card + FUZZ_CARD, kept, FUZZ_CARD);
    }
}

/* ---- the law ---- */

static bool among(const char *key, const char *const *list) {
    for (; *list != NULL; list++) {
        const size_t n = strlen(*list);
        if ((*list)[n - 1] == '*' ? strncmp(key, *list, n - 1) == 0 : strcmp(key, *list) == 0)
            return true;
    }
    return false;
}

/* Does the keyword say what the numbers are, so that another value means other numbers? What says
 * how they are packed is not of these, but for the kind of gzip: shuffled bytes look like others.
 */
static bool decides(const place *p, const char *key) {
    static const char *const primary[] = {"FIELD",  "PIXSCALE", "SIM_G1",
                                          "SIM_G2", "OVERSAMP", NULL};
    static const char *const images[] = {"BSCALE",  "BZERO",  "BLANK",    "ZBLANK",
                                         "ZSCALE",  "ZZERO",  "ZDITHER0", "ZQUANTIZ",
                                         "STAMPN*", "NSTAMP", "OVERSAMP", NULL};
    static const char *const plain[] = {"BITPIX", "NAXIS*", NULL};
    static const char *const catalog[] = {"T*", "NAXIS*", "EXTNAME", NULL};
    if (p->hdu == 0)
        return among(key, primary);
    if (strcmp(p->name, "CATALOG") == 0)
        return among(key, catalog);
    if (strcmp(p->name, "GALAXY") != 0 && strcmp(p->name, "NOISE") != 0 &&
        strcmp(p->name, "PSF") != 0) {
        return false;
    }
    const bool gzip = strstr(fuzz_seed_name(p->seed), "gzip") != NULL;
    const bool smooth = strstr(fuzz_seed_name(p->seed), "hcompress") != NULL;
    return among(key, images) || (!p->packed && among(key, plain)) ||
           (gzip && strcmp(key, "ZCMPTYPE") == 0) || (smooth && strcmp(key, "ZVAL2") == 0);
}

static bool obeys(int mutant, uint64_t found) {
    const place *p = &places[mutant / n_ways()];
    const bool two = mutant % n_ways() >= fuzz_n_values;
    return found == 0 || found == good[p->seed] || decides(p, p->key) ||
           (two && decides(p, p->next));
}

/* ---- running ---- */

static volatile int *current; /* shared: index into the list of the mutant that is being run */
static volatile int *broken;  /* shared: mutants that broke the second law */
static volatile int *accepted;

static void run_one(int mutant) {
    const fuzz_bytes *seed = &seeds[places[mutant / n_ways()].seed];
    uint8_t *copy = malloc(seed->size);
    memcpy(copy, seed->data, seed->size);
    apply(mutant, copy);
    const uint64_t found = digest(copy, seed->size);
    *accepted += found != 0;
    if (!obeys(mutant, found)) {
        char name[200];
        name_of(mutant, name, sizeof name);
        fprintf(stderr, "one_card: accepted, with other numbers: %s\n", name);
        (*broken)++;
    }
    free(copy);
}

/* Run list[from..to) in a child; the number of the first that was not run. */
static int run_batch(const int *list, int from, int to, int *crashes) {
    const pid_t child = fork();
    if (child == 0) {
        for (int i = from; i < to; i++) {
            *current = i;
            alarm(SECONDS);
            run_one(list[i]);
        }
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return to;
    char name[200];
    name_of(list[*current], name, sizeof name);
    fprintf(stderr, "one_card: CRASH (%s %d): %s\n", WIFSIGNALED(status) ? "signal" : "exit",
            WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status), name);
    (*crashes)++;
    return *current + 1;
}

static int run(const int *list, int n) {
    int crashes = 0;
    int *shared = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    current = shared;
    broken = shared + 1;
    accepted = shared + 2;
    for (int i = 0; i < n;)
        i = run_batch(list, i, i + BATCH < n ? i + BATCH : n, &crashes);
    printf("one_card: %d mutants, %d accepted, %d crashes, %d with other numbers\n", n, *accepted,
           crashes, *broken);
    return crashes + *broken > 0;
}

static bool prepare(void) {
    bool sound = true;
    for (int i = 0; i < FUZZ_SEEDS; i++) {
        seeds[i] = fuzz_seed(i);
        good[i] = digest(seeds[i].data, seeds[i].size);
        if (good[i] == 0) {
            fprintf(stderr, "one_card: seed %s is refused\n", fuzz_seed_name(i));
            sound = false;
        }
    }
    list_places();
    return sound;
}

/* What the arguments ask for, into list; how many. */
static int choose(int argc, char **argv, int *list, int all) {
    const char *option = argc > 1 ? argv[1] : "";
    const long first = argc > 2 ? strtol(argv[2], NULL, 10) : 0;
    const bool sample = strcmp(option, "--sample") == 0;
    uint64_t state = sample && argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    if (!sample && strcmp(option, "--all") != 0) {
        list[0] = (int)first;
        return first >= 0 && first < all ? 1 : 0;
    }
    const int n = sample && first < all ? (int)first : all;
    for (int i = 0; i < n; i++)
        list[i] = sample ? (int)fuzz_below(&state, (size_t)all) : i;
    return n;
}

int main(int argc, char **argv) {
    if (fixture_setup(NULL) != 0)
        return 1;
    int failed = prepare() ? 0 : 1;
    const int all = n_places * n_ways();
    int *list = calloc((size_t)all + 1, sizeof *list);
    const int n = choose(argc, argv, list, all);
    if (failed == 0 && n == 0) {
        fprintf(stderr, "usage: one_card --all | --sample N [SEED] | --one MUTANT\n");
        failed = 2;
    }
    failed = failed != 0 ? failed : run(list, n);
    free(list);
    for (int i = 0; i < FUZZ_SEEDS; i++)
        free(seeds[i].data);
    fixture_teardown(NULL);
    return failed;
}
