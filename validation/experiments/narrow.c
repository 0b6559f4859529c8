/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `narrow` (beyond the paper): under-sampled data, which need no logarithm. */
#include "engine/aliases.h"
#include "engine/bias_fit.h"
#include "engine/methods.h"
#include "engine/must.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>

enum { SIGNS = 2, N_WAYS = 2, N_DISKS = 4, POWERS = 480, POWER_GALAXIES = 32, POWER_ANGLES = 8 };

static const char *const ways[N_WAYS] = {"defaults", "zhang2010"};
static const double disks_px[N_DISKS] = {0.0, 0.5, 1.0, 2.0}; /* half-light radii; 0: a point */
static const double power_step = 0.05;                        /* step of k, per px */

static const parameter parameters[] = {
    {"radii", "0.3,0.35,0.4,0.45,0.5,0.6,0.7,0.8,0.9,1,1.2", 0.2, 4, MAX_VALUES, "R_PSF, pixels"},
    {0}};

static int64_t stamps(const options *o) {
    return SIGNS * o->galaxies * options_list(o, "radii")->n;
}

typedef struct point {
    double r_psf_px, beta_px[N_WAYS];
    bias_fit bias[N_WAYS];
    /* The power fraction of the aliases for the target of the first way: of the mocks' galaxies,
     * and of disks. */
    double own, disk[N_DISKS];
} point;

typedef struct points {
    double limit_px; /* R_PSF for which the fraction of the smallest disks is 10^-3 */
    int n;
    point of[MAX_VALUES];
} points;

/* ---- the aliases ---- */

/* |f|^2 of the mocks' galaxies, averaged over directions and several galaxies, in steps of k. */
typedef struct powers {
    double v[POWERS];
} powers;

static double power_at(double k, const void *context) {
    const powers *p = context;
    const double at = fmin(k / power_step, POWERS - 1.001);
    const int i = (int)at;
    return p->v[i] + (at - i) * (p->v[i + 1] - p->v[i]);
}

static double power_of_points(int n, const double *x, const double *y, double k) {
    double sum = 0.0;
    for (int a = 0; a < POWER_ANGLES; a++) {
        const double kx = k * cos(M_PI * a / POWER_ANGLES);
        const double ky = k * sin(M_PI * a / POWER_ANGLES);
        double re = 0.0;
        double im = 0.0;
        for (int i = 0; i < n; i++) {
            re += cos(kx * x[i] + ky * y[i]);
            im += sin(kx * x[i] + ky * y[i]);
        }
        sum += re * re + im * im;
    }
    return sum / POWER_ANGLES;
}

static powers find_powers(const options *o) {
    CLEANUP(shear_mock_release)
    shear_mock *mock = sampler_mock(&o->mock, (int64_t)POWER_GALAXIES * o->mock.rotate);
    powers p = {0};
    const int most = shear_mock_get_info(mock)->max_points;
    CLEANUP(release_free) double *x = must_allocate(2 * (size_t)most, sizeof *x, "points");
    for (int galaxy = 0; galaxy < POWER_GALAXIES; galaxy++) {
        const int n = shear_mock_points(mock, galaxy, x, x + most);
#pragma omp parallel for schedule(dynamic)
        for (int i = 0; i < POWERS; i++)
            p.v[i] += power_of_points(n, x, x + most, power_step * i);
    }
    return p;
}

/* Return the fraction A. W_A of eq. (9) of Zhang (2010) is longer along y. */
static double share_at(double r_psf_px, double beta_px, power_function *power,
                       const void *context) {
    const double sigma_px[] = {r_psf_px, r_psf_px / sqrt(0.8)};
    return aliases_share(beta_px, sigma_px, power, context);
}

static double find_limit(const options *o) {
    double lo = 0.1;
    double hi = 1.0;
    for (int i = 0; i < 30; i++) {
        const double middle = 0.5 * (lo + hi);
        const double beta = fmax(o->settings.beta_ratio * middle, o->settings.beta_floor_px);
        *(share_at(middle, beta, disk_power, &disks_px[1]) > 1e-3 ? &lo : &hi) = middle;
    }
    return lo;
}

/* ---- measuring ---- */

static shear_settings settings_of(const options *o, int way, double r_psf_px) {
    shear_settings s = o->settings;
    if (way == 0) {
        s.interpolation = SHEAR_INTERP_NONE;
    } else {
        must(shear_settings_set(&s, "preset", ways[way], &must_error));
        s.filter = SHEAR_FILTER_NONE;
    }
    s.beta_px = fmax(s.beta_ratio * r_psf_px, s.beta_floor_px);
    return s;
}

/* Measure. The series are way + N_WAYS * sign. */
static void measure(const options *o, cache *c, point *p) {
    sample s = {.n_scenes = SIGNS, .n_series = SIGNS * N_WAYS};
    for (int i = 0; i < SIGNS; i++) {
        shear_mock_spec *m = &s.scenes[i].spec;
        *m = o->mock;
        m->g1 *= i != 0 ? -1.0 : 1.0;
        m->g2 *= i != 0 ? -1.0 : 1.0;
        m->r_psf_px = p->r_psf_px;
        m->nx = m->ny = stamp_side(m->r_gal_px, m->r_psf_px);
    }
    for (int i = 0; i < s.n_series; i++) {
        s.series[i] = (series){i / N_WAYS, psf_oversample(PSF_FINE, p->r_psf_px),
                               settings_of(o, i % N_WAYS, p->r_psf_px)};
        p->beta_px[i % N_WAYS] = s.series[i].settings.beta_px;
    }
    snprintf(s.name, sizeof s.name, "R_PSF=%g", p->r_psf_px);
    CLEANUP(jackknife_sums_deinit) jackknife_sums sums = {0};
    sample_measure(o, c, &s, &sums);
    for (int way = 0; way < N_WAYS; way++) {
        const shear_set set = {.n = SIGNS,
                               .series = {way, N_WAYS + way},
                               .g = {{o->mock.g1, o->mock.g2}, {-o->mock.g1, -o->mock.g2}}};
        p->bias[way] = bias_fit_lines(&sums, &set);
    }
}

/* ---- table ---- */

static const column columns[] = {
    {"r_psf", TABLE_NUMBER, 2, .help = "R_PSF of Zhang (2010), eq. (9)", .unit = "pix"},
    {"settings", TABLE_TEXT, 0, .help = "the defaults, or preset zhang2010"},
    {"beta", TABLE_NUMBER, 2, .help = "scale radius of the target", .unit = "pix"},
    {"m1", TABLE_NUMBER, 5, .help = "multiplicative bias", .with_error = true},
    {"m2", TABLE_NUMBER, 5, .help = "multiplicative bias", .with_error = true},
    {"c1", TABLE_NUMBER, 6, .help = "additive bias", .with_error = true},
    {"c2", TABLE_NUMBER, 6, .help = "additive bias", .with_error = true},
    {"aliases", TABLE_NUMBER, -2, .help = "their share, of these galaxies"},
    {"points", TABLE_NUMBER, -2, .help = "of points"},
    {"disks_half", TABLE_NUMBER, -2,
     .help = "of exponential disks of this half-light radius, pixels"},
    {"disks_1", TABLE_NUMBER, -2, .help = "of exponential disks of this half-light radius, pixels"},
    {"disks_2", TABLE_NUMBER, -2, .help = "of exponential disks of this half-light radius, pixels"},
    {0}};

static void add_row(table *t, const point *p, int way) {
    const bias_fit *b = &p->bias[way];
    table_numbers(t, p->r_psf_px);
    table_texts(t, ways[way]);
    table_numbers(t, p->beta_px[way], b->m[0], b->m_err[0], b->m[1], b->m_err[1], b->c[0],
                  b->c_err[0], b->c[1], b->c_err[1]);
    if (way == 0) {
        table_numbers(t, p->own, p->disk[0], p->disk[1], p->disk[2], p->disk[3]);
    } else {
        table_numbers(t, NAN, NAN, NAN, NAN, NAN);
    }
}

static void conclude(table *t, const points *all, int way) {
    double worst = 0.0;
    int good = 0;
    int n = 0;
    for (int i = 0; i < 2 * all->n; i++) {
        const bias_fit *b = &all->of[i / 2].bias[way];
        const int c = i % 2;
        if (all->of[i / 2].r_psf_px > all->limit_px) {
            worst = fmax(worst, fabs(b->m[c]));
            n++;
            good += fabs(b->m[c]) < 2e-3 + 2.0 * b->m_err[c];
        }
    }
    table_meta(t, TABLE_CONCLUSION,
               "%s: |m| within 2 10^-3 beside two errors in %d of %d (m1 and m2 of every R_PSF "
               "above %.2f px), at most %.1f 10^-3",
               ways[way], good, n, all->limit_px, 1e3 * worst);
}

static void tabulate(table *t, const points *all) {
    table_columns(t, columns);
    for (int i = 0; i < N_WAYS * all->n; i++)
        add_row(t, &all->of[i % all->n], i / all->n);
    for (int way = 0; way < N_WAYS; way++)
        conclude(t, all, way);
    table_meta(t, TABLE_CONCLUSION,
               "the aliases of exponential disks of half-light radius 0.5 px are 10^-3 of the "
               "signal at R_PSF = %.2f px",
               all->limit_px);
    table_meta(t, "limit", "%.4f", all->limit_px);
}

/* ---- figure ---- */

static void draw_m(const panels *p, int i, const points *all, bool both) {
    curve curves[2 * N_WAYS] = {
        {"defaults, g_{1}", SHEAR_BLUE, .marker = SHEAR_DISC},
        {"g_{2}", SHEAR_BLUE, .marker = SHEAR_CIRCLE},
        {"log-bicubic (zhang2010), g_{1}", SHEAR_VERMILION, .marker = SHEAR_SQUARE},
        {"g_{2}", SHEAR_VERMILION, .marker = SHEAR_CROSS}};
    for (int k = 0; k < 2 * N_WAYS * all->n; k++) {
        const point *at = &all->of[k % all->n];
        const int which = k / all->n;
        const bias_fit *b = &at->bias[which / 2];
        curve_add(&curves[which], at->r_psf_px, 1e3 * b->m[which % 2], 1e3 * b->m_err[which % 2]);
    }
    panels_draw(p, i,
                &(chart){both ? "bias" : "the defaults alone", "R_{PSF}, px", "m, 10^{-3}",
                         .legend = SHEAR_BOTTOM_RIGHT, .truth = 0.0, .limit = all->limit_px,
                         .spread = 0.006, .n_curves = both ? 2 * N_WAYS : 2, .curves = curves});
}

static void draw_c(const panels *p, int i, const points *all) {
    curve curves[N_WAYS] = {{"defaults", SHEAR_BLUE, .marker = SHEAR_DISC},
                            {"log-bicubic (zhang2010)", SHEAR_VERMILION, .marker = SHEAR_SQUARE}};
    for (int k = 0; k < all->n * N_WAYS; k++) {
        const point *at = &all->of[k / N_WAYS];
        const bias_fit *b = &at->bias[k % N_WAYS];
        curve_add(&curves[k % N_WAYS], at->r_psf_px, hypot(b->c[0], b->c[1]),
                  fmax(b->c_err[0], b->c_err[1]));
    }
    panels_draw(p, i,
                &(chart){"additive bias", "R_{PSF}, px", "|c|", .y = {1e-8, 1e-1}, .log_y = true,
                         .truth = NAN, .limit = all->limit_px, .n_curves = N_WAYS,
                         .curves = curves});
}

static void draw_aliases(const panels *p, int i, const points *all) {
    curve curves[N_DISKS + 1] = {
        {.label = "points", .hue = SHEAR_BLACK, .dash = SHEAR_DOTTED},
        {.label = "disks of half-light radius 0.5 px", .hue = SHEAR_VERMILION},
        {.label = "1 px", .hue = SHEAR_GREEN},
        {.label = "2 px", .hue = SHEAR_SKY},
        {.label = "the galaxies measured", .hue = SHEAR_BLUE, .dash = SHEAR_DASHED}};
    for (int k = 0; k <= N_DISKS; k++) {
        curves[k].line = true;
        for (int at = 0; at < all->n; at++) {
            const point *of = &all->of[at];
            curve_add(&curves[k], of->r_psf_px, k < N_DISKS ? of->disk[k] : of->own, NAN);
        }
    }
    panels_draw(p, i,
                &(chart){"aliases' part of the signal", "R_{PSF}, px", "A(\xce\xb2)",
                         .y = {1e-8, 1.0}, .log_y = true, .truth = 1e-3, .limit = all->limit_px,
                         .n_curves = N_DISKS + 1, .curves = curves});
}

static void run_narrow(run *r) {
    const options *o = r->options;
    const parameter_values *radii = options_list(o, "radii");
    const powers own = find_powers(o);
    static points all;
    all.limit_px = find_limit(o);
    for (; all.n < radii->n; all.n++) {
        point *p = &all.of[all.n];
        p->r_psf_px = radii->v[all.n];
        measure(o, r->cache, p);
        p->own = share_at(p->r_psf_px, p->beta_px[0], power_at, &own);
        for (int k = 0; k < N_DISKS; k++)
            p->disk[k] = share_at(p->r_psf_px, p->beta_px[0], disk_power, &disks_px[k]);
    }
    tabulate(r->table, &all);
    const panels p = run_panels(r, NULL, 1100, 740,
                                (shear_grid){.rows = 2, .columns = 2, .gap_x = 12, .gap_y = 8});
    draw_m(&p, 0, &all, true);
    draw_m(&p, 1, &all, false);
    draw_aliases(&p, 2, &all);
    draw_c(&p, 3, &all);
}

const experiment experiment_narrow = {
    "narrow",
    "beyond the paper: under-sampled data, R_PSF from 0.3 pixels on",
    "Irregular galaxies in fours at +g and -g, without noise, behind W_A given finely\n"
    "sampled: m and c against R_PSF by the defaults (no interpolation, beta at least 1.4\n"
    "pixels) and by preset zhang2010 (log-bicubic where R_PSF is below 1 pixel). Beside it\n"
    "the part of the signal that aliases have under the target, by quadrature: of these\n"
    "galaxies, of points, and of exponential disks.",
    .defaults = "preset=default filter=none shear=0.03,-0.02 rotate=4 galaxy=irregular "
                "galaxies=3200 groups=50",
    .fixed = "size galaxy psf r-psf oversamp noise-ratio white photons preset psf-size psf-angle "
             "beta filter psf-ids interpolation",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_narrow};
