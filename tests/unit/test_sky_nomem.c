/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each allocation of maps and .head files fails once: an error, and nothing is left behind (which
 * the address sanitizer sees). */
#include "fits_fixture.h"
#include "scarce.h"
#include "sky_fixture.h"
#include "survey/wcs/head_file.h"

#include <stdlib.h>
#include <string.h>

static int make_map(const char *path, shear_error *err) {
    (void)path;
    sky_header h = sky_header_make("TPV");
    sky_header_add_tpv(&h);
    sky_map *map = NULL;
    const int code = sky_map_new(&map, h.cards[0], h.n, "f", err);
    assert_true((map != NULL) == (code == SHEAR_OK));
    sky_map_free(map);
    return code;
}

static int read_head(const char *path, shear_error *err) {
    head_file h;
    char *merged = NULL;
    int64_t count = 0;
    const int code = head_file_init(&h, path, -1, err);
    if (code == SHEAR_OK)
        merged = head_file_merge(&h, 1, NULL, &count);
    const bool failed = code == SHEAR_OK && merged == NULL;
    free(merged);
    head_file_deinit(&h);
    return failed ? SHEAR_E_NOMEM : code;
}

/* Let the n-th allocation fail, for all n. */
static void fail_each(int (*work)(const char *path, shear_error *err), const char *path) {
    bool refused = true;
    for (long n = 1; refused; n++) {
        shear_error err = {0};
        scarce_after(n, false);
        const int code = work(path, &err);
        refused = scarce_end();
        assert_int_equal(code, refused ? SHEAR_E_NOMEM : SHEAR_OK);
        assert_true(n < 1000);
    }
}

static void every_allocation(void **state) {
    (void)state;
    const char *const text = "CTYPE1  = 'RA---TAN'\nEND\nCTYPE1  = 'RA---TAN'\nCRVAL1  = 5\nEND\n";
    const char *const path = fixture_path("two.head");
    fixture_save(path, text, strlen(text));
    fail_each(make_map, path);
    fail_each(read_head, path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_allocation)};
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
