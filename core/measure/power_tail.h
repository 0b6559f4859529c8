/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure/power_tail.h: |W|^2 of stars at wave numbers where noise is as strong. */
#pragma once

/* Replace power[ny][nx], with k = 0 in the middle and its noise subtracted, from the first ring of
 * modes on of which more than a sixth are negative, as where noise scatters by as much as there is
 * power, by exp(a - b k^(5/3)); a and b are from the rings before it. Power without noise is left
 * as it is. (A root of positive noise would be a spike on the PSF's peak.) */
void power_tail_fill(double *power, int nx, int ny);
