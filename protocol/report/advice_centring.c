/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of positions at which there are no galaxies, in words. */
#include "sheard/advice.h"

#include "report/advice_say.h"

#include <inttypes.h>
#include <math.h>

static const double origin_px = 0.4; /* how exactly an error of the origin is a pixel */

/* Return whether the light is a pixel away in columns and rows: 1 or -1; 0: it is not. */
static int origin_error(const shear_centring *c) {
    const double sign = c->x > 0.0 ? 1.0 : -1.0;
    return fabs(c->x - sign) < origin_px && fabs(c->y - sign) < origin_px ? (int)sign : 0;
}

const char *sheard_advice_positions(const shear_centring *c, char *buf, size_t size) {
    if (shear_centring_is_lost(c)) {
        return advice_say(
            buf, size,
            "there is light near %" PRId64 " of %" PRId64
            " positions only, as by chance: are they of this image, in these columns (--columns), "
            "and is it the catalog of this chip?",
            c->found, c->looked_at);
    }
    if (!shear_centring_is_off(c))
        return NULL;
    const int origin = origin_error(c);
    return advice_say(
        buf, size,
        "the light of %" PRId64 " galaxies is (%+.2f, %+.2f) px from their positions: %s", c->found,
        c->x, c->y,
        origin > 0   ? "do these count from 0? give --origin 0"
        : origin < 0 ? "do these count from 1? give --origin 1"
                     : "are these of another image, trimmed or resampled, or in other "
                       "columns (--columns)?");
}

const char *sheard_advice_centring(const shear_result *r, const shear_plan_info *plan, char *buf,
                                   size_t size) {
    (void)r;
    return sheard_advice_positions(&plan->centring, buf, size);
}
