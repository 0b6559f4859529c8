/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fft/pass.h"

#include "base/simd.h"
#include "fft/fft.h"

#include <stdbool.h>

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
static SHEAR_INLINE void dft2(cx *a, cx *b) {
    const cx sum = add(*a, *b);
    *b = sub(*a, *b);
    *a = sum;
}

static SHEAR_INLINE void dft4(cx *a, cx *b, cx *c, cx *d) {
    dft2(a, c);
    dft2(b, d);
    const cx rotated = minus_i(*d);
    const cx second = *c;
    *c = sub(*a, *b);
    *a = add(*a, *b);
    *b = add(second, rotated);
    *d = sub(second, rotated);
}

static SHEAR_INLINE void dft3(cx *a, cx *b, cx *c) {
    const double half_root3 = 0.86602540378443864676;
    const cx sum = add(*b, *c);
    const cx rotated = scale(half_root3, minus_i(sub(*b, *c)));
    const cx middle = sub(*a, scale(0.5, sum));
    *a = add(*a, sum);
    *b = add(middle, rotated);
    *c = sub(middle, rotated);
}

static SHEAR_INLINE void dft5(cx *a, cx *b, cx *c, cx *d, cx *e) {
    const double c1 = 0.30901699437494742410; /* cos and sin of 72 and 144 degrees */
    const double c2 = -0.80901699437494742410;
    const double s1 = 0.95105651629515357212;
    const double s2 = 0.58778525229247312917;
    const cx sum1 = add(*b, *e);
    const cx sum2 = add(*c, *d);
    const cx dif1 = minus_i(sub(*b, *e));
    const cx dif2 = minus_i(sub(*c, *d));
    const cx even1 = add(*a, add(scale(c1, sum1), scale(c2, sum2)));
    const cx even2 = add(*a, add(scale(c2, sum1), scale(c1, sum2)));
    const cx odd1 = add(scale(s1, dif1), scale(s2, dif2));
    const cx odd2 = sub(scale(s2, dif1), scale(s1, dif2));
    *a = add(*a, add(sum1, sum2));
    *b = add(even1, odd1);
    *e = sub(even1, odd1);
    *c = add(even2, odd2);
    *d = sub(even2, odd2);
}

/* even: points 0, 2, 4, 6; odd: points 1, 3, 5, 7. The results are points 0 to 3 and 4 to 7. */
static SHEAR_INLINE void dft8(cx even[4], cx odd[4]) {
    const double root_half = 0.70710678118654752440;
    dft4(&even[0], &even[1], &even[2], &even[3]);
    dft4(&odd[0], &odd[1], &odd[2], &odd[3]);
    odd[1] = scale(root_half, add(odd[1], minus_i(odd[1])));
    odd[2] = minus_i(odd[2]);
    odd[3] = scale(root_half, sub(minus_i(odd[3]), odd[3]));
    dft2(&even[0], &odd[0]);
    dft2(&even[1], &odd[1]);
    dft2(&even[2], &odd[2]);
    dft2(&even[3], &odd[3]);
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

/* `rotated`: multiply by the twiddles, which are all 1 for p = 0. It is a constant once inlined. */
typedef void butterfly(const strands *t, bool rotated, size_t l);

static SHEAR_INLINE void butterfly2(const strands *t, bool rotated, size_t l) {
    cx a = load(t, 0, l);
    cx b = load(t, 1, l);
    dft2(&a, &b);
    store(t, false, 0, l, a);
    store(t, rotated, 1, l, b);
}

static SHEAR_INLINE void butterfly3(const strands *t, bool rotated, size_t l) {
    cx a = load(t, 0, l);
    cx b = load(t, 1, l);
    cx c = load(t, 2, l);
    dft3(&a, &b, &c);
    store(t, false, 0, l, a);
    store(t, rotated, 1, l, b);
    store(t, rotated, 2, l, c);
}

static SHEAR_INLINE void butterfly4(const strands *t, bool rotated, size_t l) {
    cx a = load(t, 0, l);
    cx b = load(t, 1, l);
    cx c = load(t, 2, l);
    cx d = load(t, 3, l);
    dft4(&a, &b, &c, &d);
    store(t, false, 0, l, a);
    store(t, rotated, 1, l, b);
    store(t, rotated, 2, l, c);
    store(t, rotated, 3, l, d);
}

static SHEAR_INLINE void butterfly5(const strands *t, bool rotated, size_t l) {
    cx a = load(t, 0, l);
    cx b = load(t, 1, l);
    cx c = load(t, 2, l);
    cx d = load(t, 3, l);
    cx e = load(t, 4, l);
    dft5(&a, &b, &c, &d, &e);
    store(t, false, 0, l, a);
    store(t, rotated, 1, l, b);
    store(t, rotated, 2, l, c);
    store(t, rotated, 3, l, d);
    store(t, rotated, 4, l, e);
}

static SHEAR_INLINE void butterfly8(const strands *t, bool rotated, size_t l) {
    cx even[4] = {load(t, 0, l), load(t, 2, l), load(t, 4, l), load(t, 6, l)};
    cx odd[4] = {load(t, 1, l), load(t, 3, l), load(t, 5, l), load(t, 7, l)};
    dft8(even, odd);
    store(t, false, 0, l, even[0]);
    store(t, rotated, 1, l, even[1]);
    store(t, rotated, 2, l, even[2]);
    store(t, rotated, 3, l, even[3]);
    store(t, rotated, 4, l, odd[0]);
    store(t, rotated, 5, l, odd[1]);
    store(t, rotated, 6, l, odd[2]);
    store(t, rotated, 7, l, odd[3]);
}

/* Run all butterflies of a pass. `one` and `radix` are constants once inlined. */
static SHEAR_INLINE void run(const fft_pass *pass, butterfly *one, size_t radix, const double *re,
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
                one(&t, false, l);
        } else {
#pragma omp simd
            for (size_t l = 0; l < out_block; l++)
                one(&t, true, l);
        }
    }
}

SHEAR_SIMD static void run2(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, butterfly2, 2, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run3(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, butterfly3, 3, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run4(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, butterfly4, 4, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run5(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, butterfly5, 5, re, im, step, out_re, out_im);
}

SHEAR_SIMD static void run8(const fft_pass *pass, const double *re, const double *im, size_t step,
                            double *out_re, double *out_im) {
    run(pass, butterfly8, 8, re, im, step, out_re, out_im);
}

void fft_pass_run(const fft_pass *pass, const double *re, const double *im, size_t step,
                  double *out_re, double *out_im) {
    switch (pass->radix) {
    case 2:
        run2(pass, re, im, step, out_re, out_im);
        break;
    case 3:
        run3(pass, re, im, step, out_re, out_im);
        break;
    case 4:
        run4(pass, re, im, step, out_re, out_im);
        break;
    case 5:
        run5(pass, re, im, step, out_re, out_im);
        break;
    default:
        run8(pass, re, im, step, out_re, out_im);
        break;
    }
}
