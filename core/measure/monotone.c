/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/monotone.h"

#include <assert.h>
#include <math.h>

enum { MAX_STEPS = 60 };

double monotone_find_root(double (*function)(void *context, double x), void *context, double low,
                          double high, double tolerance) {
    double at_low = function(context, low);
    double at_high = function(context, high);
    assert(low < high && at_low > 0.0 && at_high <= 0.0);
    double x = low;
    for (int i = 0, side = 0; i < MAX_STEPS && high - low > tolerance; i++) {
        const double before = x;
        const double margin = 1e-3 * (high - low);
        x = (low * at_high - high * at_low) / (at_high - at_low);
        x = fmax(low + margin, fmin(high - margin, x));
        if (fabs(x - before) < tolerance)
            break;
        const double at = function(context, x);
        if (at > 0.0) {
            low = x;
            at_low = at;
            at_high *= side > 0 ? 0.5 : 1.0;
            side = 1;
        } else {
            high = x;
            at_high = at;
            at_low *= side < 0 ? 0.5 : 1.0;
            side = -1;
        }
    }
    return x;
}
