/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a reader says of a field: each number that the daemon would use as a size, an index or a
 * scale is bounded. */
#include "reader/validate.h"
#include "test.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* An exposure with PSF models on the sky. */
static shear_field_info good_info(void) {
    shear_field_info info = {
        .name = "exp",
        .pixscale = 0.2,
        .frame = SHEAR_FRAME_SKY,
        .geometry = {.nx = 64, .ny = 48, .psf_nx = 25, .psf_ny = 25, .psf_oversample = 1},
        .n_stamps = 100,
        .n_psf = 12,
        .n_models = 2,
        .psf_terms = 6,
        .noise_planes = 4,
        .psf_layout = SHEAR_PSF_MODELS,
        .columns = SHEAR_COL_PSF_ID | SHEAR_COL_PSF_TERMS | SHEAR_COL_JACOBIAN,
    };
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        info.hdu[i] = -1;
    return info;
}

static shear_psf_model good_model(void) {
    return (shear_psf_model){
        .nx = 25, .ny = 25, .terms = 6, .step = 0.5, .axes = SHEAR_PSF_AXES_PIXEL, .lanczos = 4};
}

/* Change one member of a copy, and check that it is refused. */
#define REFUSED(member, value)                                                                     \
    do {                                                                                           \
        shear_field_info bad = good_info();                                                        \
        bad.member = (value);                                                                      \
        assert_false(validate_info(&bad));                                                         \
    } while (0)

static void infos(void **state) {
    (void)state;
    shear_field_info info = good_info();
    assert_true(validate_info(&info));
    info.frame = SHEAR_FRAME_PIXEL;
    info.pixscale = NAN;
    assert_true(validate_info(&info));
    info = good_info();
    memset(info.name, 'x', sizeof info.name); /* no NUL */
    assert_true(validate_info(&info));
    REFUSED(name[0], '\n');
    REFUSED(geometry.nx, 0);
    REFUSED(geometry.ny, SHEAR_MAX_SIDE + 1);
    REFUSED(geometry.psf_nx, INT32_MAX);
    REFUSED(geometry.psf_oversample, NAN);
    REFUSED(n_stamps, INT64_MAX);
    REFUSED(n_psf, 13);
    REFUSED(n_models, -2);
    REFUSED(psf_terms, SHEAR_MAX_PSF_TERMS + 1);
    REFUSED(noise_planes, 0);
    REFUSED(noise_planes, SHEAR_MAX_NOISE_PLANES + 1);
    REFUSED(noise_planes, INT32_MAX);
    REFUSED(frame, (enum shear_frame)SHEAR_N_FRAMES);
    REFUSED(pixscale, NAN);
    REFUSED(pixscale, INFINITY);
    REFUSED(pixscale, -1.0);
    REFUSED(columns, SHEAR_COL_PSF_ID | SHEAR_COL_PSF_TERMS);
    REFUSED(columns, SHEAR_COL_PSF_ID | SHEAR_COL_JACOBIAN);
    REFUSED(psf_layout, SHEAR_PSF_ONE);
    REFUSED(psf_layout, (enum shear_psf_layout)77);
    REFUSED(hdu[SHEAR_PART_WCS], -2);
}

#define WRONG(member, value)                                                                       \
    do {                                                                                           \
        shear_psf_model bad = good_model();                                                        \
        bad.member = (value);                                                                      \
        assert_false(validate_model(&bad, &info));                                                 \
    } while (0)

static void models(void **state) {
    (void)state;
    shear_field_info info = good_info();
    shear_psf_model m = good_model();
    assert_true(validate_model(&m, &info));
    m.axes = SHEAR_PSF_AXES_SKY;
    assert_true(validate_model(&m, &info));
    WRONG(nx, 0);
    WRONG(nx, 26);
    WRONG(ny, INT32_MAX);
    WRONG(terms, 5);
    WRONG(step, NAN);
    WRONG(step, 1e300);
    WRONG(step, 1e-300);
    WRONG(lanczos, 33);
    WRONG(lanczos, -1);
    WRONG(smoothed_px, NAN);
    WRONG(smoothed_px, -1.0);
    m.smoothed_px = 1.0; /* along the axes of the sky */
    assert_false(validate_model(&m, &info));
    m.smoothed_px = 0.0;
    WRONG(axes, (enum shear_psf_axes)7);
    WRONG(axes, SHEAR_PSF_AXES_MODES); /* which are on the grid of the stamps: 64 x 48 */
    info.geometry.psf_nx = m.nx = 64;
    info.geometry.psf_ny = m.ny = 48;
    m.axes = SHEAR_PSF_AXES_MODES;
    assert_true(validate_model(&m, &info));
    info.columns = SHEAR_COL_PSF_ID | SHEAR_COL_PSF_TERMS; /* no Jacobians */
    WRONG(axes, SHEAR_PSF_AXES_SKY);
}

static shear_carried good_column(void) {
    return (shear_carried){.name = "MAG", .form = "3E", .unit = "mag", .null = "-1", .bytes = 12};
}

#define BAD(member, value)                                                                         \
    do {                                                                                           \
        shear_carried bad = good_column();                                                         \
        bad.member = (value);                                                                      \
        assert_false(validate_carried(&bad));                                                      \
    } while (0)

static void carried(void **state) {
    (void)state;
    static const struct {
        const char *form;
        int bytes;
        bool good;
    } forms[] = {{"1J", 4, true},    {"12A", 12, true}, {"11X", 2, true},      {"1M", 16, true},
                 {"11X", 11, false}, {"1P", 8, false},  {"J", 4, false},       {"-1J", 4, false},
                 {"3", 3, false},    {"1JJ", 4, false}, {"1048577B", 1, false}};
    shear_carried c = good_column();
    assert_true(validate_carried(&c));
    memset(c.unit, 'x', sizeof c.unit); /* no NUL */
    assert_true(validate_carried(&c));
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        c = good_column();
        strcpy(c.form, forms[i].form);
        c.bytes = forms[i].bytes;
        assert_int_equal(validate_carried(&c), forms[i].good);
    }
    BAD(name[0], '\0');
    BAD(name[1], '\n');
    BAD(unit[0], '\x80');
    BAD(zero[0], '\t');
    BAD(null[0], '\''); /* it would be a string */
    BAD(scale[0], 'T');
    BAD(zero[0], '-');
    BAD(null[1], ' ');
    BAD(bytes, 0);
    BAD(bytes, 13);
    BAD(bytes, INT32_MIN);
    shear_field_info info = good_info();
    info.n_carried = 2;
    info.carried_bytes = 16;
    info.carried = &c;
    assert_true(validate_info(&info));
    assert_null(info.carried); /* a pointer of the child's */
    REFUSED(n_carried, 1);     /* of no bytes */
    REFUSED(n_carried, -1);
    REFUSED(carried_bytes, 1); /* of no column */
    REFUSED(carried_bytes, SHEAR_MAX_CARRIED_BYTES + 1);
    REFUSED(n_carried, SHEAR_MAX_CARRIED + 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(infos),
        cmocka_unit_test(carried),
        cmocka_unit_test(models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
