/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as a catalog of sources, with options that the bytes choose: opening it, selecting and
 * reading its rows must neither crash nor leak. Like fuzz_field.c, a libFuzzer target or an
 * ordinary test. */
#include "fuzz_field.h"

#include "cards.h"
#include "survey/sources/source_list.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { MOST_TABLES = 3 };

static volatile double sink; /* of what has been read */

/* Read every number, for the sanitizers. */
static double sum_of(const source_list *s) {
    const double *const arrays[] = {s->x, s->y, s->ra, s->dec, s->r_gal, s->weight, s->a, s->theta};
    double sum = 0.0;
    for (int64_t i = 0; i < s->n; i++) {
        for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
            sum += arrays[k] != NULL ? arrays[k][i] : 0.0;
        for (int k = 0; k < s->n_contexts; k++)
            sum += s->context[i * s->n_contexts + k];
        sum += (double)s->id[i] + s->selected[i];
    }
    return sum;
}

static void load(source_catalog *c, int i) {
    static const char *const contexts[] = {"MAG_AUTO", "number"};
    source_list s;
    shear_error err = {0};
    int64_t count = 0;
    double sum = 0.0;
    const char *cards = source_catalog_header(c, i, &count);
    for (int64_t k = 0; k < 80 * count; k++)
        sum += cards[k];
    sum += (double)strlen(source_catalog_chip(c, i));
    for (int n = 0; n <= 2; n += 2) {
        if (source_catalog_load(c, i, contexts, n, NULL, &s, &err) == SHEAR_OK)
            sum += sum_of(&s);
        source_list_deinit(&s);
    }
    sink = sum;
}

static void open_and_load(int fd, const shear_input_part *part, const shear_exposure *exposure) {
    source_catalog *c = NULL;
    shear_error err = {0};
    if (source_catalog_open(&c, part, fd, exposure, &err) == SHEAR_OK) {
        for (int i = 0; i < source_catalog_tables(c) && i < MOST_TABLES; i++)
            load(c, i);
    }
    source_catalog_close(c);
}

/* Let the bytes themselves choose the HDU and the options. */
static void choose(shear_input_part *part, shear_exposure *e, const uint8_t *bytes, size_t size) {
    static const char *const columns[] = {NULL, "x=Y_IMAGE,y=MAG_AUTO", "ra=X_IMAGE,dec=Y_IMAGE",
                                          "a=MAG_AUTO,b=X_IMAGE,theta=Y_IMAGE,flags=NUMBER"};
    static const char *const selects[] = {NULL, "FLAGS < 4 && X_IMAGE/NUMBER > 0",
                                          "NUMBER % 3 == 1 || isnull(Y_IMAGE)",
                                          "sqrt(MAG_AUTO) > (NUMBER & 6) && X_IMAGE^2 < 1e9"};
    static const char *const names[] = {NULL, "OBJECTS", "LDAC_OBJECTS", "CCD1"};
    uint64_t state = size;
    for (size_t i = 0; i < size; i++)
        state = 31 * state + bytes[i];
    part->hdu = (int)fuzz_below(&state, 6) - 1;
    part->extname = names[fuzz_below(&state, sizeof names / sizeof *names)];
    e->columns = columns[fuzz_below(&state, sizeof columns / sizeof *columns)];
    e->select = selects[fuzz_below(&state, sizeof selects / sizeof *selects)];
    e->origin = (int)fuzz_below(&state, 2);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    const int fd = memfd_create("sources", MFD_CLOEXEC);
    if (fd < 0)
        return 0;
    if (write(fd, bytes, size) == (ssize_t)size) {
        shear_input_part part = {.path = "input.cat", .hdu = -1};
        shear_exposure exposure = {.origin = 1};
        open_and_load(fd, &part, &exposure);
        exposure.select = "FLAGS < 4 && X_IMAGE > 0";
        open_and_load(fd, &part, &exposure);
        choose(&part, &exposure, bytes, size);
        open_and_load(fd, &part, &exposure);
    }
    close(fd);
    return 0;
}

#ifdef SHEAR_FUZZ
/* See source_fixture.c. */
const char *__lsan_default_suppressions(void) __attribute__((visibility("default")));
const char *__lsan_default_suppressions(void) {
    return "leak:ffiprs\n";
}
#endif
