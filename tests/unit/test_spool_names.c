/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which names are accepted, and the names that files get. */
#include "test.h"

#include "spool/names.h"

#include <string.h>

static void good_and_bad_names(void **state) {
    (void)state;
    static const struct {
        const char *name;
        enum name_status status;
    } cases[] = {
        {"a.fits", NAME_GOOD},
        {"a.fits.gz", NAME_GOOD},
        {"a.fits.fz", NAME_GOOD},
        {"a.json", NAME_GOOD},
        {"a.fit", NAME_GOOD},
        {"a.fit.gz", NAME_GOOD},
        {"a.fit.fz", NAME_GOOD},
        {"a.fz", NAME_GOOD},
        {"a.FITS", NAME_GOOD},
        {"a.Fit.GZ", NAME_GOOD},
        {"a.FZ", NAME_GOOD},
        {"a.JSON", NAME_GOOD},
        {"with space (1).fits", NAME_GOOD},
        {"-rf.fits", NAME_GOOD},
        {"a.fits(/tmp/out.fits).fits", NAME_SUFFIX}, /* has a slash: no name at all */
        {"a.fits[1][col x].fits", NAME_GOOD},
        {"\xc3\xa9toile.fits", NAME_GOOD},
        {"\xf0\x9f\x94\xad.fits", NAME_GOOD},
        {".fits", NAME_QUIET},
        {".a.fits", NAME_QUIET},
        {"a.fits.tmp", NAME_QUIET},
        {"a.fits.part", NAME_QUIET},
        {"a", NAME_SUFFIX},
        {"a.FITS.TMP", NAME_QUIET},
        {"a.Part", NAME_QUIET},
        {"a.fitsx", NAME_SUFFIX},
        {"fits", NAME_SUFFIX},
        {"a.fits.bz2", NAME_SUFFIX},
        {"a.gz", NAME_SUFFIX},
        {"a.json~", NAME_SUFFIX},
        {"a\n.fits", NAME_CONTROL},
        {"\x1b[2J.fits", NAME_CONTROL},
        {"a\x7f.fits", NAME_CONTROL},
        {"a\xc2\x9b.fits", NAME_CONTROL}, /* U+009B, which terminals obey */
        {"a\xff.fits", NAME_NOT_UTF8},
        {"a\xc0\xaf.fits", NAME_NOT_UTF8},         /* longer than need be */
        {"a\xe0\x80\xaf.fits", NAME_NOT_UTF8},     /* the same */
        {"a\xed\xa0\x80.fits", NAME_NOT_UTF8},     /* a surrogate */
        {"a\xf4\x90\x80\x80.fits", NAME_NOT_UTF8}, /* beyond U+10FFFF */
        {"a.fits\xc3", NAME_NOT_UTF8},             /* cut off */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (name_validate(cases[i].name) != cases[i].status) {
            fail_msg("case %zu: %d instead of %d", i, name_validate(cases[i].name),
                     cases[i].status);
        }
    }
}

static void fill(char *name, size_t length) {
    memset(name, 'x', length);
    memcpy(name + length - 5, ".fits", 6);
}

static void longest_name_fits_everywhere(void **state) {
    (void)state;
    char name[NAME_SIZE];
    char active[NAME_SIZE];
    char numbered[NAME_SIZE];
    fill(name, NAME_GOOD_MAX + 1);
    assert_int_equal(name_validate(name), NAME_LONG);
    fill(name, NAME_GOOD_MAX);
    assert_int_equal(name_validate(name), NAME_GOOD);
    assert_int_equal(name_make_active(active, name, 0), 0);
    assert_string_equal(name_of_active(active), name);
    assert_true(1 + strlen(active) + strlen(".end") <= NAME_MAX);
    name_number(numbered, name, INT64_MAX);
    assert_true(strlen(numbered) + strlen(".json") <= NAME_MAX);
    assert_string_equal(numbered + strlen(numbered) - 24, "9223372036854775807.fits");
}

static void active_names(void **state) {
    (void)state;
    char first[NAME_SIZE];
    char second[NAME_SIZE];
    char key[SPOOL_KEY_SIZE];
    assert_int_equal(name_make_active(first, "a-b.fits", 7), 0);
    assert_int_equal(name_make_active(second, "a-b.fits", 7), 0);
    assert_string_not_equal(first, second);
    assert_string_equal(name_of_active(first), "a-b.fits");
    name_key(key, first);
    assert_int_equal(strlen(key), SPOOL_KEY_SIZE - 1);
    assert_memory_equal(key, first, strlen(key));
    first[0] = 'g';
    assert_null(name_of_active(first));
    assert_null(name_of_active("a-b.fits"));
    second[SPOOL_KEY_SIZE] = '.';
    assert_null(name_of_active(second));
}

static void numbers_go_before_the_extension(void **state) {
    (void)state;
    char name[NAME_SIZE];
    name_number(name, "a.fits", 0);
    assert_string_equal(name, "a.fits");
    name_number(name, "a.fits", 1);
    assert_string_equal(name, "a.1.fits");
    name_number(name, "a.b.fits.gz", 12);
    assert_string_equal(name, "a.b.12.fits.gz");
    name_number(name, "a.fits.json", 2);
    assert_string_equal(name, "a.fits.2.json");
}

static void messages_are_printable(void **state) {
    (void)state;
    char name[NAME_SIZE];
    name_printable(name, "a\x1b[2J\xc2\x9b.fits");
    assert_string_equal(name, "a?[2J??.fits");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(good_and_bad_names),     cmocka_unit_test(longest_name_fits_everywhere),
        cmocka_unit_test(active_names),           cmocka_unit_test(numbers_go_before_the_extension),
        cmocka_unit_test(messages_are_printable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
