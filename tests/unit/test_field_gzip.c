/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damaged gzip files, and no room to unpack good ones. */
#include "fits_fixture.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define END ((const char *)NULL)

static void gzip_damage(void **state) {
    (void)state;
    const char *plain = fixture_path("plain.fits");
    fixture_write_good(plain);
    const char *packed = fixture_path("bad.fits.gz");
    fixture_gzip(plain, packed);
    size_t size = 0;
    unsigned char *bytes = fixture_load(packed, &size);
    for (size_t cut = 1; cut < size; cut += cut < 12 ? 1 : 251) {
        fixture_save(packed, bytes, size - cut);
        /* The last cut leaves less than the two magic bytes. */
        fixture_expect_open(packed, SHEAR_E_FORMAT, size - cut > 1 ? "gzip data are truncated" : "",
                            END);
    }
    for (size_t at = 20; at < size; at += 997) {
        bytes[at] ^= 0x55;
        fixture_save(packed, bytes, size);
        fixture_expect_open(packed, SHEAR_E_FORMAT, END);
        bytes[at] ^= 0x55;
    }
    bytes = realloc(bytes, size + 4);
    memcpy(bytes + size, "junk", 4);
    fixture_save(packed, bytes, size + 4);
    fixture_expect_open(packed, SHEAR_E_FORMAT, "gzip data are damaged", END);
    free(bytes);
    fixture_save(plain, "plain text, packed", 18);
    fixture_gzip(plain, packed);
    fixture_expect_open(packed, SHEAR_E_FORMAT, "not a FITS file", "unpacked", END);
}

static void gzip_limits(void **state) {
    (void)state;
    const char *plain = fixture_path("plain.fits");
    const char *packed = fixture_path("limited.fits.gz");
    shear_field_spec s = fixture_spec();
    s.n_stamps = 400;
    fixture_write(plain, &s);
    fixture_gzip(plain, packed);
    assert_int_equal(setenv("SHEAR_UNPACK_LIMIT", "300000", 1), 0);
    fixture_expect_open(packed, SHEAR_E_FORMAT, "limit of 300000 bytes", END);
    assert_int_equal(setenv("SHEAR_UNPACK_LIMIT", "1000000", 1), 0);
    shear_field *field = NULL;
    assert_int_equal(shear_field_open(&field, packed, NULL), SHEAR_OK);
    shear_field_close(field);
    assert_int_equal(unsetenv("SHEAR_UNPACK_LIMIT"), 0);

    const char *tmp = getenv("TMPDIR");
    char *old = tmp != NULL ? strdup(tmp) : NULL;
    assert_int_equal(setenv("TMPDIR", fixture_path("no/such/directory"), 1), 0);
    fixture_expect_open(packed, SHEAR_E_IO, "temporary file", "TMPDIR", END);
    if (old != NULL) {
        setenv("TMPDIR", old, 1);
    } else {
        unsetenv("TMPDIR");
    }
    free(old);
}

/* No room for what is unpacked: an error of the system, not of the file. */
static void no_room_to_unpack(void **state) {
    (void)state;
    const char *plain = fixture_path("plain.fits");
    const char *packed = fixture_path("room.fits.gz");
    shear_field_spec s = fixture_spec();
    s.n_stamps = 400;
    fixture_write(plain, &s);
    fixture_gzip(plain, packed);
    struct rlimit old;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    struct rlimit tight = {.rlim_cur = 10000, .rlim_max = old.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
    fixture_expect_open(packed, SHEAR_E_IO, "temporary copy", END);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gzip_damage),
        cmocka_unit_test(gzip_limits),
        cmocka_unit_test(no_room_to_unpack),
    };
    signal(SIGXFSZ, SIG_IGN); /* writing beyond RLIMIT_FSIZE is to fail, not to kill */
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
