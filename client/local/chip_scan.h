/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chip_scan.h: what `shearctl validate` finds on each chip of an exposure, while all stamps are
 * scanned in their order. */
#pragma once

#include "local/warnings.h"
#include "sheard/validation_report.h"

typedef struct chip_scan {
    shear_field *field;        /* borrowed */
    sheard_chip_report *chips; /* [n], owned */
    int n;                     /* 0: the field is no exposure */
    int current;               /* the chip that is being scanned; -1: none yet */
    double *dx, *dy;           /* [stamps of a chip] distances of light from positions; owned */
    int64_t looked_at, found;  /* on the current chip */
    double distortion_min, distortion_max;
} chip_scan;

/* Describe the chips, also in the report; they remain the scan's. Nothing needs to be scanned for a
 * field that is no exposure. Call chip_scan_deinit after an error, too. */
int chip_scan_init(chip_scan *s, shear_field *field, sheard_validation_report *v, shear_error *err);
void chip_scan_deinit(chip_scan *s);
/* Add stamp `i` of a block, the next one of the field, with its flags, and its row, if it has been
 * measured, or NULL. */
int chip_scan_add(chip_scan *s, const shear_block *block, int i, unsigned flags,
                  const shear_row *row, shear_error *err);
/* Finish the last chip, and complete the report. */
int chip_scan_finish(chip_scan *s, sheard_validation_report *v, shear_error *err);

/* Write how to call a chip: its EXTNAME, or "of HDU 3". Return buf. */
const char *chip_scan_name(const sheard_chip_report *r, char *buf, size_t size);
/* Warn of what is doubtful. `input`: as it was opened. */
void chip_scan_warn(const sheard_validation_report *v, const shear_input *input, warning_list *w);
