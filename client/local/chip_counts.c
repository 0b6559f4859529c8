/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/chip_counts.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "shear/chip.h"
#include "sheard/advice.h"

#include <stdlib.h>

int chip_counts_init(chip_counts *t, const shear_field *field, const char *path, shear_error *err) {
    const int chips = shear_field_chips(field);
    *t = (chip_counts){.n = chips > 0 ? chips : 1};
    t->chips = calloc((size_t)t->n, sizeof *t->chips);
    if (t->chips == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    t->chips[0].end = shear_field_get_info(field)->n_stamps;
    text_set(t->chips[0].name, sizeof t->chips[0].name, path);
    for (int i = 0; i < chips; i++) {
        shear_chip chip;
        counted_chip *c = &t->chips[i];
        TRY(shear_field_get_chip(field, i, &chip, err));
        c->first = chip.first;
        c->end = chip.first + chip.n_stamps;
        text_set(c->name, sizeof c->name, chip.name[0] != '\0' ? chip.name : path);
    }
    return SHEAR_OK;
}

void chip_counts_deinit(chip_counts *t) {
    free(t->chips);
    *t = (chip_counts){0};
}

/* Return the chip of a stamp. Those without stamps share their `first` with the next one. */
static counted_chip *chip_of(const chip_counts *t, int64_t stamp) {
    int low = 0;
    int high = t->n - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        low = stamp < t->chips[middle].end ? low : middle + 1;
        high = stamp < t->chips[middle].end ? middle : high;
    }
    return &t->chips[low];
}

static int count(void *self, int64_t first, int n, const shear_row *rows, const shear_block *block,
                 shear_error *err) {
    (void)block;
    (void)err;
    for (int i = 0; i < n; i++) {
        counted_chip *c = chip_of(self, first + i);
        c->n_bright += shear_row_is_bright(&rows[i]) ? 1 : 0;
        c->n_sharp += shear_row_is_sharp(&rows[i]) ? 1 : 0;
    }
    return SHEAR_OK;
}

shear_sink chip_counts_sink(chip_counts *t) {
    return (shear_sink){.self = t, .write = count};
}

int chip_counts_broad(const chip_counts *t, const shear_result *r, const shear_plan_info *plan,
                      char *line, size_t size, const char **name) {
    char other[SHEARD_ADVICE_SIZE];
    int n = 0;
    for (int i = 0; i < t->n; i++) {
        const counted_chip *c = &t->chips[i];
        if (sheard_advice_broad_psf_of(c->n_bright, c->n_sharp, r, plan, n == 0 ? line : other,
                                       n == 0 ? size : sizeof other) != NULL) {
            *name = n == 0 ? c->name : *name;
            n++;
        }
    }
    return n;
}
