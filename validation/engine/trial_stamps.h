/* SPDX-License-Identifier: GPL-3.0-or-later */
/* trial_stamps.h: the stamps of a trial, drawn group by group, and written as field files. */
#ifndef VALIDATION_TRIAL_STAMPS_H
#define VALIDATION_TRIAL_STAMPS_H

#include "engine/trial.h"

typedef struct trial_stamps trial_stamps;
/* Holds groups of `most` stamps. The trial must outlive it. */
trial_stamps *trial_stamps_new(const trial *t, int most);
void trial_stamps_free(trial_stamps *s);

/* Draw stamps [first, first+count) at both signs of the shear, and their noise. */
void trial_stamps_draw(trial_stamps *s, int64_t first, int count);
/* Write them at one level and one sign (0: +g) to `path`, flaws and all; what was there is
 * replaced. */
void trial_stamps_write(trial_stamps *s, const trial_level *level, int sign, const char *path);

/* The signal-to-noise of stamp number first + k at that level, as if there were no shear. */
double trial_stamps_snr(const trial_stamps *s, const trial_level *level, int k);
/* What was written last, and the same galaxies without noise, of unit square sum but for the shear;
 * [count][side][side] each. `sign` is that of what was written. */
typedef struct trial_stamps_view {
    const double *galaxy, *noise, *bare;
} trial_stamps_view;
trial_stamps_view trial_stamps_look(const trial_stamps *s, int sign);

#endif
