/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Piff models: the grid from its parameters, new and old; u and v from the pointing; and what needs
 * Piff itself. */
#include "psf_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 5, PLANE = SIZE * SIZE, TERMS = 6 };

#define END ((const char *)NULL)

static const double scale = 0.26;
/* q[parameter][term], u^i v^j: 1, v, v^2, u, uv, u^2 */
static double q[PLANE * TERMS];

static void fill_solution(void) {
    for (int i = 0; i < PLANE * TERMS; i++)
        q[i] = sin(2.3 * i + 0.4) / pow(300.0, (double)(i % TERMS > 0) + (double)(i % 3 == 2));
    q[PLANE / 2 * TERMS] = 40.0;
}

/* The parts of a file, as they differ. */
typedef struct piff_file {
    const char *model, *interp; /* types */
    const char *kernel;         /* column interp of the model; NULL: none */
    const char *keys, *keys_form, *keys_dim;
    const double *order;
    const char *order_form;
    double max_order; /* negative: no such column */
    const char *q_form, *q_dim;
    bool pointing;
    int stars;
} piff_file;

static const double two[] = {2.0, 2.0};
static const piff_file good = {.model = "PixelGrid",
                               .interp = "BasisPolynomial",
                               .kernel = "Lanczos(7)",
                               .order = two,
                               .order_form = "K",
                               .max_order = -1.0,
                               .q_form = "150D",
                               .q_dim = "(6,25)",
                               .pointing = true,
                               .stars = 6};

static void append_model(fitsfile *f, const char *prefix, const piff_file *p) {
    static const double size = SIZE;
    char name[40];
    snprintf(name, sizeof name, "%s_model", prefix);
    const psf_fixture_column model[] = {
        {"type", "9A", NULL, NULL, p->model},
        {"scale", "D", NULL, &scale, NULL},
        {"size", "K", NULL, &size, NULL},
        {p->kernel != NULL ? "interp" : NULL, "40A", NULL, NULL, p->kernel},
        {0}};
    psf_fixture_table(f, name, 1, model);
    const psf_fixture_column interp[] = {
        {"type", "15A", NULL, NULL, p->interp},
        {"order", p->order_form, NULL, p->order, NULL},
        {p->max_order >= 0.0 ? "max_order" : "use_qr", "K", NULL, &p->max_order, NULL},
        {p->keys != NULL ? "keys" : NULL, p->keys_form, p->keys_dim, NULL, p->keys},
        {0}};
    snprintf(name, sizeof name, "%s_interp", prefix);
    psf_fixture_table(f, name, 1, interp);
    const psf_fixture_column solution[] = {{"q", p->q_form, p->q_dim, q, NULL}, {0}};
    snprintf(name, sizeof name, "%s_interp_solution", prefix);
    psf_fixture_table(f, name, 1, solution);
}

/* The pointing is at 1h, 60 degrees; the stars lie within 100 arcsec. */
static void append_stars(fitsfile *f, const char *prefix, const piff_file *p) {
    static const double ra = 1.0;
    static const double dec = 60.0;
    static const double chisq[] = {130.0, 100.0};
    static const double range[] = {-100.0, 100.0, 3.0, 4.0, 5.0, 6.0};
    char name[40];
    const psf_fixture_column wcs[] = {{"wcs_str_0000", "8A", NULL, NULL, "gASVAAA="},
                                      {p->pointing ? "ra" : NULL, "D", NULL, &ra, NULL},
                                      {"dec", "D", NULL, &dec, NULL},
                                      {0}};
    snprintf(name, sizeof name, "%s_wcs", prefix);
    psf_fixture_table(f, name, 1, wcs);
    const psf_fixture_column sums[] = {
        {"chisq", "D", NULL, chisq, NULL}, {"dof", "D", NULL, chisq + 1, NULL}, {0}};
    snprintf(name, sizeof name, "%s_chisq", prefix);
    psf_fixture_table(f, name, 1, sums);
    const psf_fixture_column stars[] = {{"u", "D", NULL, range, NULL},
                                        {"v", "D", NULL, range, NULL},
                                        {"x", "D", NULL, range, NULL},
                                        {"colour", "D", NULL, range, NULL},
                                        {0}};
    snprintf(name, sizeof name, "%s_stars", prefix);
    if (p->stars > 0)
        psf_fixture_table(f, name, p->stars, stars);
}

static const char *path_of(void) {
    return fixture_path("model.piff");
}

static const char *write_simple(const piff_file *p) {
    const psf_fixture_column psf[] = {{"type", "20A", NULL, NULL, "SimplePSF"}, {0}};
    fitsfile *f = fixture_create(path_of());
    psf_fixture_table(f, "psf", 1, psf);
    append_model(f, "psf", p);
    append_stars(f, "psf", p);
    fixture_close(f);
    return path_of();
}

/* A galaxy at (u, v) of a pointing, by the inverse projection. */
static psf_place deproject(double u, double v, double ra0, double dec0) {
    const double degree = acos(-1.0) / 180.0;
    const double xi = -u / 3600.0 * degree;
    const double eta = v / 3600.0 * degree;
    const double below = cos(dec0 * degree) - eta * sin(dec0 * degree);
    const double a = atan2(xi, below);
    const double d = atan((sin(dec0 * degree) + eta * cos(dec0 * degree)) * cos(a) / below);
    return (psf_place){17.0, 23.0, ra0 + a / degree - (u < 0.0 ? 360.0 : 0.0), d / degree, NULL};
}

static psf_place at(double u, double v) {
    return deproject(u, v, 15.0, 60.0);
}

static double basis(int t, double u, double v) {
    const double k[TERMS] = {1.0, v, v * v, u, u * v, u * u};
    return k[t];
}

/* With n^2 parameters, the samples are the parameters. */
static void test_grid(void **state) {
    (void)state;
    double out[PLANE];
    psf_models *p = psf_fixture_open(write_simple(&good), SHEAR_PSF_KIND_AUTO, 32);
    const shear_psf_model *m = psf_models_get(p, 0);
    const char *const *names = NULL;
    assert_string_equal(psf_models_text(p, 0), "Piff, PixelGrid 5 x 5 of 0.26 arcsec, degree 2 in "
                                               "u, v, 6 stars, chi2/dof 1.30");
    assert_true(m->axes == SHEAR_PSF_AXES_SKY && m->step == scale && m->lanczos == 7);
    assert_true(m->terms == TERMS && m->nx == SIZE && m->ny == SIZE);
    assert_int_equal(psf_models_contexts(p, 0, &names), 0);
    static const double places[][2] = {{0.0, 0.0}, {30.0, -50.0}, {-190.0, 170.0}};
    for (size_t i = 0; i < 3; i++) {
        const double u = places[i][0];
        const double v = places[i][1];
        const psf_place place = at(u, v);
        psf_fixture_samples(p, 0, &place, out);
        for (int k = 0; k < PLANE; k++) {
            double sum = 0.0;
            for (int t = 0; t < TERMS; t++)
                sum += q[k * TERMS + t] * basis(t, u, v);
            psf_fixture_near(out[k], sum, 1e-6);
        }
    }
    double c[TERMS];
    psf_place place = at(201.0, 0.0);
    assert_false(psf_models_terms(p, 0, &place, c));
    place = at(0.0, 0.0);
    place.ra = NAN;
    assert_false(psf_models_terms(p, 0, &place, c));
    place.ra = 195.0; /* the other side of the sky */
    assert_false(psf_models_terms(p, 0, &place, c));
    psf_models_close(p);
}

/* Old files leave out one or three pixels, which flux and centroid give. */
static void test_old_grids(void **state) {
    (void)state;
    static const struct {
        const char *form, *dim;
        int left;
    } cases[] = {{"144D", "(6,24)", 1}, {"132D", "(6,22)", 3}};
    for (size_t i = 0; i < 2; i++) {
        piff_file old = good;
        double out[PLANE];
        double sum = 0.0;
        double right = 0.0;
        double up = 0.0;
        old.kernel = NULL;
        old.q_form = cases[i].form;
        old.q_dim = cases[i].dim;
        psf_models *p = psf_fixture_open(write_simple(&old), SHEAR_PSF_KIND_PIFF, 32);
        const psf_place place = at(30.0, -50.0);
        assert_int_equal(psf_models_get(p, 0)->lanczos, 3);
        psf_fixture_samples(p, 0, &place, out);
        int parameter = 0;
        for (int k = 0; k < PLANE; k++) {
            const bool solved = k == 12 || (cases[i].left == 3 && (k == 17 || k == 13));
            double expected = 0.0;
            for (int t = 0; t < TERMS; t++)
                expected += q[parameter * TERMS + t] * basis(t, 30.0, -50.0);
            if (!solved)
                psf_fixture_near(out[k], expected, 1e-6);
            parameter += solved ? 0 : 1;
            sum += out[k];
            right += out[k] * (k % SIZE - 2);
            up += out[k] * (k / SIZE - 2);
        }
        assert_int_equal(parameter, PLANE - cases[i].left);
        psf_fixture_near(sum * scale * scale, 1.0, 1e-9);
        if (cases[i].left == 3) {
            psf_fixture_near(right, 0.0, 1e-9);
            psf_fixture_near(up, 0.0, 1e-9);
        }
        psf_models_close(p);
    }
}

/* 1, c, x, x c: orders 1 and 1, all their products. */
static void test_keys(void **state) {
    (void)state;
    static const double one[] = {1.0, 1.0};
    const double colour = 1.5;
    const psf_place place = {-40.0, 0.0, NAN, NAN, &colour};
    const char *const *names = NULL;
    for (int form = 0; form < 2; form++) {
        piff_file f = good;
        double c[4];
        f.keys = form == 0 ? "x     colour" : "['x', 'colour']";
        f.keys_form = form == 0 ? "12A" : "20A";
        f.keys_dim = form == 0 ? "(6,2)" : NULL;
        f.order = one;
        f.order_form = "2K";
        f.max_order = 2.0;
        f.pointing = false;
        f.q_form = "100D";
        f.q_dim = "(4,25)";
        psf_models *p = psf_fixture_open(write_simple(&f), SHEAR_PSF_KIND_AUTO, 32);
        assert_int_equal(psf_models_contexts(p, 0, &names), 1);
        assert_string_equal(names[0], "colour");
        assert_true(psf_models_terms(p, 0, &place, c));
        assert_true(c[0] == 1.0 && c[1] == 1.5 && c[2] == -40.0 && c[3] == -60.0);
        psf_models_close(p);
    }
}

static void test_constant(void **state) {
    (void)state;
    static const double none = 0.0;
    piff_file f = good;
    double c = 0.0;
    f.order = &none;
    f.q_form = "25D";
    f.q_dim = NULL;
    f.pointing = false;
    f.stars = 0;
    psf_models *p = psf_fixture_open(write_simple(&f), SHEAR_PSF_KIND_AUTO, 32);
    assert_true(psf_models_terms(p, 0, &(psf_place){NAN, NAN, NAN, NAN, NULL}, &c) && c == 1.0);
    psf_models_close(p);
}

static void write_chips(const char *type) {
    static const double numbers[] = {3.0, 61.0};
    const psf_fixture_column psf[] = {{"type", "20A", NULL, NULL, "SingleChip"}, {0}};
    const psf_fixture_column chips[] = {{"chipnums", "K", NULL, numbers, NULL}, {0}};
    const psf_fixture_column simple[] = {{"type", "20A", NULL, NULL, type}, {0}};
    fitsfile *f = fixture_create(path_of());
    psf_fixture_table(f, "psf", 1, psf);
    psf_fixture_table(f, "psf_chipnums", 2, chips);
    psf_fixture_table(f, "psf_3", 1, simple);
    append_model(f, "psf_3", &good);
    append_stars(f, "psf_3", &good);
    psf_fixture_table(f, "psf_61", 1, simple);
    append_model(f, "psf_61", &good);
    append_stars(f, "psf_61", &good);
    fixture_close(f);
}

static void test_chips(void **state) {
    (void)state;
    write_chips("SimplePSF");
    psf_models *p = psf_fixture_open(path_of(), SHEAR_PSF_KIND_AUTO, 32);
    assert_int_equal(psf_models_count(p), 2);
    assert_non_null(strstr(psf_models_text(p, 1), "chip 61"));
    psf_models_close(p);
    write_chips("SumPSF");
    psf_fixture_refuse(path_of(), SHEAR_PSF_KIND_AUTO, SHEAR_E_PSF, "psf_3", "'SumPSF'", "psf.draw",
                       "cube", END);
}

static void refuse(const piff_file *p, int code, const char *word) {
    psf_fixture_refuse(write_simple(p), SHEAR_PSF_KIND_AUTO, code, "model.piff", word, END);
}

static void test_refused(void **state) {
    (void)state;
    static const double negative = -1.0;
    static const double huge = 1e300;
    piff_file f = good;
    f.model = "Moffat";
    refuse(&f, SHEAR_E_PSF, "'Moffat'");
    f = good;
    f.interp = "GPInterp";
    refuse(&f, SHEAR_E_PSF, "'GPInterp'");
    f = good;
    f.kernel = "galsim.Quintic(1e-4)";
    refuse(&f, SHEAR_E_PSF, "galsim.Quintic");
    f.kernel = "Lanczos(99999999999999999999)";
    refuse(&f, SHEAR_E_PSF, "Lanczos(99999");
    f = good;
    f.stars = 5;
    refuse(&f, SHEAR_E_PSF, "fewer stars");
    f = good;
    f.pointing = false;
    refuse(&f, SHEAR_E_PSF, "no pointing");
    f = good;
    f.order = &negative;
    refuse(&f, SHEAR_E_FORMAT, "order");
    f.order = &huge;
    f.order_form = "D";
    refuse(&f, SHEAR_E_FORMAT, "order");
    f = good;
    f.order_form = "2K";
    f.keys = "x";
    f.keys_form = "1A";
    refuse(&f, SHEAR_E_FORMAT, "one per key");
    f = good;
    f.max_order = 1.0;
    refuse(&f, SHEAR_E_FORMAT, "has 3");
    f = good;
    f.q_dim = "(25,6)";
    refuse(&f, SHEAR_E_FORMAT, "has 25 terms of 6 parameters");
    f.q_form = "138D";
    f.q_dim = "(6,23)";
    refuse(&f, SHEAR_E_FORMAT, "23 parameters");
    f = good;
    q[7] = NAN;
    refuse(&f, SHEAR_E_PSF, "not finite");
    fill_solution();
    q[PLANE / 2 * TERMS] = -40.0;
    refuse(&f, SHEAR_E_PSF, "flux is not positive");
    fill_solution();
}

static void test_missing_tables(void **state) {
    (void)state;
    static const char *const tables[] = {"psf_model", "psf_interp", "psf_interp_solution",
                                         "psf_wcs"};
    for (size_t i = 0; i < 4; i++) {
        write_simple(&good);
        fixture_patch(path_of(), tables[i], "EXTNAME", "'ELSE'");
        psf_fixture_refuse(path_of(), SHEAR_PSF_KIND_AUTO, SHEAR_E_FORMAT, tables[i], END);
    }
}

static void test_robust(void **state) {
    (void)state;
    const char *path = write_simple(&good);
    psf_fixture_spoil(path, 400);
    psf_fixture_starve(path);
}

/* ---- real files ---- */

/* Another implementation's parameters at the stars, which are those that Piff itself stored. */
static void test_real_parameters(void **state) {
    (void)state;
    char truth[512];
    fitsfile *f = NULL;
    int status = 0;
    if (psf_fixture_real("piff/truth_D00240560_params_at_stars.fits") == NULL)
        skip();
    snprintf(truth, sizeof truth, "%s",
             psf_fixture_real("piff/truth_D00240560_params_at_stars.fits"));
    psf_models *p = psf_fixture_open(psf_fixture_real("piff/D00240560_r_c01_r2362p01_piff.fits"),
                                     SHEAR_PSF_KIND_AUTO, 64);
    assert_string_equal(psf_models_text(p, 0), "Piff, PixelGrid 17 x 17 of 0.30 arcsec, degree 3 "
                                               "in u, v, 50 stars, chi2/dof 0.26");
    fits_open_diskfile(&f, truth, READONLY, &status);
    fits_movabs_hdu(f, 2, NULL, &status);
    double worst = 0.0;
    for (int row = 1; row <= 50; row++) {
        double parameters[286];
        double samples[289];
        double uv[2];
        int column = 0;
        fits_get_colnum(f, CASEINSEN, "params", &column, &status);
        fits_read_col(f, TDOUBLE, column, row, 1, 286, NULL, parameters, NULL, &status);
        fits_get_colnum(f, CASEINSEN, "u", &column, &status);
        fits_read_col(f, TDOUBLE, column, row, 1, 1, NULL, &uv[0], NULL, &status);
        fits_get_colnum(f, CASEINSEN, "v", &column, &status);
        fits_read_col(f, TDOUBLE, column, row, 1, 1, NULL, &uv[1], NULL, &status);
        assert_int_equal(status, 0);
        const psf_place place =
            deproject(uv[0], uv[1], 15.0 * 2.5297219444444443, -6.014888888888889);
        double sum = 0.0;
        double peak = 0.0;
        psf_fixture_samples(p, 0, &place, samples);
        for (int i = 0, k = 0; i < 289; i++) {
            sum += samples[i];
            peak = fmax(peak, samples[i]);
            if (i == 144 || i == 145 || i == 161)
                continue;
            worst = fmax(worst, fabs(samples[i] - parameters[k++]));
        }
        psf_fixture_near(sum * 0.09, 1.0, 1e-10);
        assert_true(samples[144] == peak);
    }
    assert_true(worst < 1e-11);
    fits_close_file(f, &status);
    psf_models_close(p);
}

static void test_real_files(void **state) {
    (void)state;
    if (psf_fixture_real("piff/test_single_py27.piff") == NULL)
        skip();
    psf_fixture_refuse(psf_fixture_real("piff/test_single_py27.piff"), SHEAR_PSF_KIND_AUTO,
                       SHEAR_E_PSF, "psf_1_model", "'Moffat'", END);
    psf_models *p = psf_fixture_open(
        psf_fixture_real("piff/D00232418_i_c19_r5006p01_piff-model.fits"), SHEAR_PSF_KIND_AUTO, 64);
    assert_int_equal(psf_models_get(p, 0)->lanczos, 3);
    const psf_place star = {1318.69, 109.796, 15.0 * 1.0320614211122938, 1.8559013197077192, NULL};
    double c[16];
    assert_true(psf_models_terms(p, 0, &star, c));
    psf_fixture_near(c[4], 3290.011418128778, 1e-3); /* u */
    psf_fixture_near(c[1], 818.4981850750606, 1e-3); /* v */
    psf_models_close(p);
}

static int setup(void **state) {
    fill_solution();
    return fixture_setup(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_robust),          cmocka_unit_test(test_grid),
        cmocka_unit_test(test_old_grids),       cmocka_unit_test(test_keys),
        cmocka_unit_test(test_constant),        cmocka_unit_test(test_chips),
        cmocka_unit_test(test_refused),         cmocka_unit_test(test_missing_tables),
        cmocka_unit_test(test_real_parameters), cmocka_unit_test(test_real_files),
    };
    return cmocka_run_group_tests(tests, setup, fixture_teardown);
}
