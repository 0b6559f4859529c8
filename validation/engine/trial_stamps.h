/* SPDX-License-Identifier: GPL-3.0-or-later */
/* studio.h: the stamps of a trial, drawn group by group, and written as field files. */
#ifndef VALIDATION_STUDIO_H
#define VALIDATION_STUDIO_H

#include "engine/trial.h"

struct studio;
/* Room for groups of `most` stamps. `trial` must outlive it. */
int studio_new(struct studio **studio, const struct trial *trial, int most, shear_error *err);
void studio_free(struct studio *studio);

/* Draw stamps [first, first+count) at both signs of the shear, and their noise. */
int studio_draw(struct studio *studio, int64_t first, int count, shear_error *err);
/* Write them at one level and one sign (0: +g) to `path`, flaws and all; what was there is
 * replaced. */
int studio_write(struct studio *studio, const trial_level *level, int sign, const char *path,
                 shear_error *err);

/* The signal-to-noise of stamp number first + k at that level, as if there were no shear. */
double studio_snr(const struct studio *studio, const trial_level *level, int k);
/* What was written last, and the same galaxies without noise, of unit square sum but for the shear;
 * [count][side][side] each. `sign` is that of what was written. */
typedef struct studio_view {
    const double *galaxy, *noise, *bare;
} studio_view;
studio_view studio_look(const struct studio *studio, int sign);

#endif
