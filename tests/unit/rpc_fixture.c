/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rpc_fixture.h"

#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* splitmix64 */
uint64_t next_random(uint64_t *seed) {
    uint64_t z = (*seed += UINT64_C(0x9E3779B97F4A7C15));
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static bool coin(uint64_t *seed) {
    return next_random(seed) & 1;
}

static int64_t integer_within(int64_t min, int64_t max, uint64_t *seed) {
    const uint64_t span = (uint64_t)max - (uint64_t)min;
    const uint64_t r = next_random(seed);
    return (int64_t)((uint64_t)min + (span == UINT64_MAX ? r : r % (span + 1)));
}

/* Any finite bits where there are no bounds. */
static double real_within(int64_t min, int64_t max, uint64_t *seed) {
    double x = 0;
    do {
        const uint64_t bits = next_random(seed);
        memcpy(&x, &bits, sizeof x);
    } while (!isfinite(x));
    return max == 0 ? x
                    : (double)min + ldexp((double)(next_random(seed) >> 11), -53) *
                                        ((double)max - (double)min);
}

/* Letters that JSON has to take care of; the last ones are control characters. */
static char *some_text(size_t longest, unsigned flags, uint64_t *seed) {
    static const char *const letters[] = {
        "a", "Z", "0", " ",  "\"", "\\", "/",    "\xC3\xA9", "\xE2\x82\xAC", "\xF0\x9F\x98\x80",
        "'", "{", "}", "\t", "\n", "\r", "\x01", "\x7F"};
    const size_t n_letters = flags & MSG_PLAIN ? 13 : 18;
    const size_t n = 1 + next_random(seed) % 20;
    char *text = malloc(4 * n + 2);
    assert_non_null(text);
    strcpy(text, flags & MSG_ABSOLUTE ? "/" : "x");
    for (size_t i = 0; i < n; i++) {
        const char *letter = letters[next_random(seed) % n_letters];
        if (longest == 0 || strlen(text) + strlen(letter) <= longest)
            strcat(text, letter);
    }
    return text;
}

static char *some_object(uint64_t *seed) {
    char text[200];
    snprintf(text, sizeof text,
             "{\"g1\":%.17g,\"n_used\":%llu,\"deep\":{\"list\":[1,null,\"\\u0001\"]}}",
             real_within(-1, 1, seed), (unsigned long long)(next_random(seed) >> 2));
    return strdup(text);
}

static char *some_settings(uint64_t *seed) {
    static const char *const lines[] = {"interpolation=log-bicubic\n",
                                        "oversample=4\n",
                                        "beta=1.2345678901234567\n",
                                        "beta-ratio=1.25\n",
                                        "zeros=floor\n",
                                        "pedestal=0.1\n",
                                        "psf-threshold=1e-08\n",
                                        "noise-correction=false\n",
                                        "shot-noise=none\n"};
    char text[400] = "";
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        strcat(text, coin(seed) ? lines[i] : "");
    return text[0] != '\0' ? strdup(text) : NULL;
}

static void fill_list(void *message, const msg_member *m, uint64_t *seed) {
    const size_t low = m->flags & MSG_REQUIRED ? 1 : 0;
    const size_t n = low + next_random(seed) % 4;
    const size_t size = msg_item_size(m);
    char *list = n > 0 ? calloc(n, size) : NULL;
    for (size_t i = 0; i < n; i++) {
        if (m->type == MSG_INTS) {
            ((int64_t *)(void *)list)[i] = integer_within(1, INT64_MAX, seed);
        } else if (m->type == MSG_TEXTS) {
            msg_put_pointer(list, i * size, some_text((size_t)m->item_max, m->flags, seed));
        } else {
            fill(list + i * size, m->table, seed);
        }
    }
    msg_put_pointer(message, m->offset, list);
    msg_put_count(message, m, n);
}

static int some_name(const char *const *names, uint64_t *seed) {
    int n = 0;
    while (names[n] != NULL)
        n++;
    return (int)(next_random(seed) % (unsigned)n);
}

static void fill_value(void *at, const msg_member *m, uint64_t *seed) {
    switch (m->type) {
    case MSG_BOOL:
        *(bool *)at = coin(seed);
        break;
    case MSG_INT:
        *(int64_t *)at = m->flags & MSG_NULLABLE && coin(seed)
                             ? m->fallback
                             : integer_within(m->min, m->max, seed);
        break;
    case MSG_REAL:
        *(double *)at = coin(seed) ? real_within(m->min, m->max, seed) : NAN;
        break;
    case MSG_NAME:
        *(int *)at = some_name(m->names, seed);
        break;
    case MSG_TIME:
        *(int64_t *)at = integer_within(1, INT64_C(253402300799999), seed);
        break;
    case MSG_STATES:
        *(unsigned *)at = (unsigned)(next_random(seed) % 64);
        break;
    default:
        break;
    }
}

static void fill_pointer(void *message, const msg_member *m, uint64_t *seed) {
    char *text = m->type == MSG_TEXT       ? some_text((size_t)m->max, m->flags, seed)
                 : m->type == MSG_SETTINGS ? some_settings(seed)
                                           : some_object(seed);
    if (m->type != MSG_MERGED && !(m->flags & MSG_REQUIRED) && coin(seed)) {
        free(text);
        text = NULL;
    }
    msg_put_pointer(message, m->offset, text);
}

static void fill_member(void *message, const msg_member *m, uint64_t *seed) {
    void *at = (char *)message + m->offset;
    switch (m->type) {
    case MSG_TEXT:
    case MSG_RAW:
    case MSG_SETTINGS:
    case MSG_MERGED:
        fill_pointer(message, m, seed);
        break;
    case MSG_INTS:
    case MSG_TEXTS:
    case MSG_OBJECTS:
        fill_list(message, m, seed);
        break;
    case MSG_OBJECT:
        fill(at, m->table, seed);
        if (m->flags & MSG_NULLABLE && !(m->flags & MSG_REQUIRED) &&
            (coin(seed) || !msg_is_there(at, m->table))) {
            msg_deinit(at, m->table);
            msg_init(at, m->table);
        }
        break;
    default:
        fill_value(at, m, seed);
        break;
    }
}

void fill(void *message, const msg_table *table, uint64_t *seed) {
    msg_init(message, table);
    for (size_t i = 0; i < table->n; i++)
        fill_member(message, &table->members[i], seed);
}

static void drop_path(const char **path) {
    free((void *)(uintptr_t)*path);
    *path = NULL;
}

static void one_image(sheard_msg_image *image, bool there, uint64_t *seed) {
    drop_path(&image->path);
    drop_path(&image->extname);
    image->hdu = -1;
    if (!there)
        return;
    image->path = some_text(SHEARD_MSG_PATH_MAX, MSG_ABSOLUTE, seed);
    if (coin(seed)) {
        image->extname = some_text(SHEARD_MSG_EXTNAME_MAX, MSG_PLAIN, seed);
    } else {
        image->hdu = integer_within(-1, SHEARD_MSG_HDU_MAX, seed);
    }
}

static void one_choice(const char **option, const char *choice, uint64_t *seed) {
    drop_path(option);
    *option = coin(seed) ? strdup(choice) : NULL;
}

/* Words of those options that are one of several. */
static void one_exposure(sheard_msg_exposure *e, uint64_t *seed) {
    static const char *const frames[] = {"sky", "sky-east", "pixel"};
    sheard_msg_image *files[] = {&e->image, &e->sources,      &e->psf, &e->weight,
                                 &e->mask,  &e->segmentation, &e->wcs, &e->noise_image};
    for (int i = 0; i < 8; i++)
        one_image(files[i], i < 3 || coin(seed), seed);
    one_choice(&e->weight_kind, "rms", seed);
    one_choice(&e->amplifiers, "8x2", seed);
    one_choice(&e->mask_bad, "bits=6", seed);
    one_choice(&e->columns, "x=XWIN_IMAGE,y=YWIN_IMAGE", seed);
    one_choice(&e->psf_kind, "psfex", seed);
    one_choice(&e->noise, "white", seed);
    if (e->noise_image.path != NULL)
        drop_path(&e->noise);
    one_choice(&e->frame, frames[next_random(seed) % 3], seed);
}

/* The table that is private to the tables of parameters. */
static const msg_table *table_of_exposure(void) {
    const msg_member *m = msg_source.members;
    while (strcmp(m->name, "exposure") != 0)
        m++;
    return m->table;
}

enum kind { FIELD_FILE, IMAGES, EXPOSURE, N_KINDS };

static void one_source(sheard_msg_source *s, uint64_t *seed) {
    sheard_msg_image *images[] = {&s->galaxy, &s->noise, &s->psf, &s->catalog};
    const enum kind kind = (enum kind)(next_random(seed) % N_KINDS);
    for (int i = 0; i < 4; i++)
        one_image(images[i], kind == IMAGES && (i < 3 || coin(seed)), seed);
    drop_path(&s->path);
    if (kind == FIELD_FILE)
        s->path = some_text(SHEARD_MSG_PATH_MAX, MSG_ABSOLUTE, seed);
    if (kind == EXPOSURE) {
        s->stamp_nx = s->stamp_ny = s->stamps = 0;
        one_exposure(&s->exposure, seed);
    } else {
        msg_deinit(&s->exposure, table_of_exposure());
        msg_init(&s->exposure, table_of_exposure());
    }
}

void fill_params(sheard_params *params, int method, uint64_t *seed) {
    memset(params, 0, sizeof *params);
    fill(params, rpc_methods[method].params, seed);
    if (method == SHEARD_METHOD_SUBMIT) {
        one_source(&params->submit.source, seed);
    } else if (method == SHEARD_METHOD_HELLO && params->hello.oldest > params->hello.newest) {
        params->hello.newest = params->hello.oldest;
    } else if (method == SHEARD_METHOD_SUBSCRIBE && params->subscribe.n_jobs == 0 &&
               params->subscribe.n_fields == 0) {
        params->subscribe.all = true;
    }
}

/* ---- Comparing ---- */

static void same_text(const char *name, const char *a, const char *b) {
    if ((a == NULL) != (b == NULL) || (a != NULL && strcmp(a, b) != 0))
        fail_msg("%s: \"%s\" is not \"%s\"", name, a ? a : "(NULL)", b ? b : "(NULL)");
}

static void same_real(const char *name, double a, double b) {
    if (!(isnan(a) && isnan(b)) && memcmp(&a, &b, sizeof a) != 0)
        fail_msg("%s: %.17g is not %.17g", name, a, b);
}

static void same_list(const void *a, const void *b, const msg_member *m) {
    const size_t n = msg_count(a, m);
    const size_t n_b = msg_count(b, m);
    const char *list_a = msg_pointer(a, m->offset);
    const char *list_b = msg_pointer(b, m->offset);
    if (n != n_b)
        fail_msg("%s: %zu elements are not %zu", m->name, n, n_b);
    for (size_t i = 0; i < n; i++) {
        if (m->type == MSG_INTS) {
            assert_memory_equal(list_a + 8 * i, list_b + 8 * i, 8);
        } else if (m->type == MSG_TEXTS) {
            same_text(m->name, msg_pointer(list_a, i * sizeof(char *)),
                      msg_pointer(list_b, i * sizeof(char *)));
        } else {
            assert_same(list_a + i * m->table->size, list_b + i * m->table->size, m->table);
        }
    }
}

static void same_bytes(const char *name, const void *a, const void *b, size_t n) {
    if (memcmp(a, b, n) != 0)
        fail_msg("%s: differs", name);
}

static void same_member(const void *a, const void *b, const msg_member *m) {
    const void *at_a = (const char *)a + m->offset;
    const void *at_b = (const char *)b + m->offset;
    switch (m->type) {
    case MSG_BOOL:
        same_bytes(m->name, at_a, at_b, sizeof(bool));
        break;
    case MSG_REAL:
        same_real(m->name, *(const double *)at_a, *(const double *)at_b);
        break;
    case MSG_NAME:
    case MSG_STATES:
        same_bytes(m->name, at_a, at_b, sizeof(int));
        break;
    case MSG_INT:
    case MSG_TIME:
        same_bytes(m->name, at_a, at_b, sizeof(int64_t));
        break;
    case MSG_INTS:
    case MSG_TEXTS:
    case MSG_OBJECTS:
        same_list(a, b, m);
        break;
    case MSG_OBJECT:
        assert_same(at_a, at_b, m->table);
        break;
    default:
        same_text(m->name, msg_pointer(at_a, 0), msg_pointer(at_b, 0));
        break;
    }
}

void assert_same(const void *a, const void *b, const msg_table *table) {
    for (size_t i = 0; i < table->n; i++)
        same_member(a, b, &table->members[i]);
}
