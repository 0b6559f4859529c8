/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "quality_text.h"

#include "shear_text.h"

#include <inttypes.h>
#include <math.h>

static void print_level(const struct quality *q, FILE *out) {
    const double percent = -100.0 * q->noise_effect;
    char effect[48] = "";
    if (!isfinite(q->noise_level)) {
        if (q->noise_share == 0.0) {
            return; /* there is none, or it is not taken off */
        }
        shear_text_line(out, "level", "noise as strong as in the noise stamps (not checked)");
        return;
    }
    if (fabs(percent) >= 0.01) {
        snprintf(effect, sizeof effect, ", the sum of w D %+.3g %%", percent);
    }
    shear_text_line(out, "level", "noise %.5g +- %.2g times the noise stamps'%s", q->noise_level,
                    q->noise_level_err, effect);
}

void quality_text_print(const struct quality *q, FILE *out) {
    if (!isfinite(q->n_eff)) {
        return;
    }
    print_level(q, out);
    if (q->top_stamp >= 0 && isfinite(q->top_share)) {
        shear_text_line(out, "influence",
                        "%" PRId64 " stamps count as %.1f equal ones, most of all stamp %" PRId64
                        " with %.3g %%",
                        q->n_used, q->n_eff, q->top_stamp, 100.0 * q->top_share);
    } else {
        shear_text_line(out, "influence", "%" PRId64 " stamps count as %.1f equal ones", q->n_used,
                        q->n_eff);
    }
}
