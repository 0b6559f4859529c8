/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chip_counts.h: how many stamps of each chip are bright, and how many of them are sharper than
 * their PSF (docs/method.md, section 5.1), while an exposure is measured. A field file is one chip.
 */
#pragma once

#include "local/warnings.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/work.h"

typedef struct counted_chip {
    int64_t first, end; /* numbers of its stamps */
    int64_t n_bright, n_sharp;
    char name[160];
} counted_chip;

typedef struct chip_counts {
    counted_chip *chips; /* [n], owned */
    int n;
} chip_counts;

/* Begin with zeros for the chips of an open field; `path` is what a chip without a name is called.
 * Call chip_counts_deinit after an error, too. */
int chip_counts_init(chip_counts *t, const shear_field *field, const char *path, shear_error *err);
void chip_counts_deinit(chip_counts *t);
/* Return a sink that counts the rows; borrows the counts. */
shear_sink chip_counts_sink(chip_counts *t);
/* Return how many chips have a PSF that is too broad, and write into line what is said of the first
 * one, and its name into name. `r` and `plan`: of all chips. */
int chip_counts_broad(const chip_counts *t, const shear_result *r, const shear_plan_info *plan,
                      char *line, size_t size, const char **name);
