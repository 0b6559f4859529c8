/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fft/pass.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <stdbool.h>

enum { MAX_RADIX = 8 };

/* Three passes of radix 4 are a little faster than two of radix 8; four of radix 4 are slower than
 * three of radices 8 and 4: 64 = 4 4 4, 256 = 8 8 4. Odd radices come last, without twiddles. */
int fft_pass_radix(int n) {
    int twos = 0;
    while (n % (2 << twos) == 0)
        twos++;
    if (twos == 0)
        return n % 5 == 0 ? 5 : n % 3 == 0 ? 3 : 1;
    return twos == 1 ? 2 : twos % 2 == 1 || twos > 6 ? 8 : 4;
}

/* A complex number in one lane. */
typedef struct cx {
    double re, im;
} cx;

static SHEAR_INLINE cx add(cx a, cx b) {
    return (cx){a.re + b.re, a.im + b.im};
}

static SHEAR_INLINE cx sub(cx a, cx b) {
    return (cx){a.re - b.re, a.im - b.im};
}

static SHEAR_INLINE cx scale(double f, cx a) {
    return (cx){f * a.re, f * a.im};
}

static SHEAR_INLINE cx minus_i(cx a) { /* times -i */
    return (cx){a.im, -a.re};
}

/* Short transforms, in place and in natural order. */
typedef void short_dft(cx *z);

static SHEAR_INLINE void dft2(cx *z) {
    const cx sum = add(z[0], z[1]);
    z[1] = sub(z[0], z[1]);
    z[0] = sum;
}

static SHEAR_INLINE void dft4(cx *z) {
    const cx sum_even = add(z[0], z[2]);
    const cx dif_even = sub(z[0], z[2]);
    const cx sum_odd = add(z[1], z[3]);
    const cx dif_odd = minus_i(sub(z[1], z[3]));
    z[0] = add(sum_even, sum_odd);
    z[1] = add(dif_even, dif_odd);
    z[2] = sub(sum_even, sum_odd);
    z[3] = sub(dif_even, dif_odd);
}

static SHEAR_INLINE void dft3(cx *z) {
    const double half_root3 = 0.86602540378443864676;
    const cx sum = add(z[1], z[2]);
    const cx rotated = scale(half_root3, minus_i(sub(z[1], z[2])));
    const cx middle = sub(z[0], scale(0.5, sum));
    z[0] = add(z[0], sum);
    z[1] = add(middle, rotated);
    z[2] = sub(middle, rotated);
}

static SHEAR_INLINE void dft5(cx *z) {
    const double c1 = 0.30901699437494742410; /* cos and sin of 72 and 144 degrees */
    const double c2 = -0.80901699437494742410;
    const double s1 = 0.95105651629515357212;
    const double s2 = 0.58778525229247312917;
    const cx sum1 = add(z[1], z[4]);
    const cx sum2 = add(z[2], z[3]);
    const cx dif1 = minus_i(sub(z[1], z[4]));
    const cx dif2 = minus_i(sub(z[2], z[3]));
    const cx even1 = add(z[0], add(scale(c1, sum1), scale(c2, sum2)));
    const cx even2 = add(z[0], add(scale(c2, sum1), scale(c1, sum2)));
    const cx odd1 = add(scale(s1, dif1), scale(s2, dif2));
    const cx odd2 = sub(scale(s2, dif1), scale(s1, dif2));
    z[0] = add(z[0], add(sum1, sum2));
    z[1] = add(even1, odd1);
    z[2] = add(even2, odd2);
    z[3] = sub(even2, odd2);
    z[4] = sub(even1, odd1);
}

static SHEAR_INLINE void dft8(cx *z) {
    const double root_half = 0.70710678118654752440;
    cx even[4] = {z[0], z[2], z[4], z[6]};
    cx odd[4] = {z[1], z[3], z[5], z[7]};
    dft4(even);
    dft4(odd);
    odd[1] = scale(root_half, add(odd[1], minus_i(odd[1])));
    odd[2] = minus_i(odd[2]);
    odd[3] = scale(root_half, sub(minus_i(odd[3]), odd[3]));
    for (int k = 0; k < 4; k++) {
        z[k] = add(even[k], odd[k]);
        z[k + 4] = sub(even[k], odd[k]);
    }
}

/* The addresses that the butterflies of one p read and write: block j is at [j apart], with its
 * lanes side by side. */
typedef struct strands {
    const double *re, *im;
    double *out_re, *out_im;
    size_t apart, out_apart;
    const double *w; /* twiddles of k = 1, 2, ... */
} strands;

static SHEAR_INLINE cx load(const strands *t, size_t j, size_t l) {
    return (cx){t->re[j * t->apart + l], t->im[j * t->apart + l]};
}

static SHEAR_INLINE void store(const strands *t, bool rotated, size_t k, size_t l, cx z) {
    const double c = rotated ? t->w[2 * k - 2] : 1.0;
    const double d = rotated ? t->w[2 * k - 1] : 0.0;
    t->out_re[k * t->out_apart + l] = rotated ? z.re * c - z.im * d : z.re;
    t->out_im[k * t->out_apart + l] = rotated ? z.re * d + z.im * c : z.im;
}

/* `rotated`: multiply by the twiddles, which are all 1 for p = 0. It is a constant once inlined, as
 * `dft` and `radix` are. */
static SHEAR_INLINE void butterfly(const strands *t, short_dft *dft, size_t radix, bool rotated,
                                   size_t l) {
    cx z[MAX_RADIX];
    for (size_t j = 0; j < radix; j++)
        z[j] = load(t, j, l);
    dft(z);
    for (size_t k = 0; k < radix; k++)
        store(t, rotated && k > 0, k, l, z[k]);
}

/* Run all butterflies of a pass. */
static SHEAR_INLINE void run(const fft_pass *pass, short_dft *dft, size_t radix, const double *re,
                             const double *im, size_t step, double *out_re, double *out_im) {
    const size_t s = (size_t)pass->s;
    const size_t m = (size_t)pass->m;
    const size_t block = s > 1 ? s * FFT_LANES : step;
    const size_t out_block = s * FFT_LANES;
    strands t = {.apart = m * block, .out_apart = out_block};
    for (size_t p = 0; p < m; p++) {
        t.re = re + p * block;
        t.im = im + p * block;
        t.out_re = out_re + p * radix * out_block;
        t.out_im = out_im + p * radix * out_block;
        t.w = pass->twiddle + 2 * p * (radix - 1);
        if (p == 0) { // NOLINT(bugprone-branch-clone): two loops, each with its constant
#pragma omp simd
            for (size_t l = 0; l < out_block; l++)
                butterfly(&t, dft, radix, false, l);
        } else {
#pragma omp simd
            for (size_t l = 0; l < out_block; l++)
                butterfly(&t, dft, radix, true, l);
        }
    }
}

SHEAR_SIMD static void run2(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, dft2, 2, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run3(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, dft3, 3, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run4(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, dft4, 4, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run5(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, dft5, 5, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run8(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, dft8, 8, re, im, step, out_re, out_im);
}

void fft_pass_run(const fft_pass *pass, const double *re, const double *im, size_t step,
                  double *out_re, double *out_im) {
    typedef void run_pass(const fft_pass *, const double *, const double *, size_t, double *,
                          double *);
    static run_pass *const runs[] = {[2] = run2, [3] = run3, [4] = run4, [5] = run5, [8] = run8};
    runs[pass->radix](pass, re, im, step, out_re, out_im);
}
