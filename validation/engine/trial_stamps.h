/* SPDX-License-Identifier: GPL-3.0-or-later */
/* trial_stamps.h: the stamps of a trial, drawn by group and written as field files. */
#pragma once

#include "engine/trial.h"

typedef struct trial_stamps trial_stamps;
/* Create stamps for groups of at most `most` stamps. The trial must outlive them. */
trial_stamps *trial_stamps_new(const trial *t, int most);
void trial_stamps_free(trial_stamps *s);

/* Draw stamps [first, first+count) at both signs of the shear, and their noise. */
void trial_stamps_draw(trial_stamps *s, int64_t first, int count);
/* Write the stamps with their flaws at one level and one sign (0: +g) to `path`, replacing an
 * existing file. */
void trial_stamps_write(trial_stamps *s, const trial_level *level, int sign, const char *path);

/* Return the signal-to-noise of stamp number first + k at that level, without shear. */
double trial_stamps_snr(const trial_stamps *s, const trial_level *level, int k);
/* The last written stamps, and the same galaxies without noise, whose sum of squares is 1 without
 * shear; [count][side][side] each. `sign` is that of the written stamps. */
typedef struct trial_stamps_view {
    const double *galaxy, *noise, *bare;
} trial_stamps_view;
trial_stamps_view trial_stamps_look(const trial_stamps *s, int sign);
