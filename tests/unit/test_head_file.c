/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of header cards: their blocks, what they replace, and what is refused. */
#include "fits_fixture.h"
#include "sky_fixture.h"
#include "survey/wcs/head_file.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *write_text(const char *text) {
    const char *const path = fixture_path("chips.head");
    fixture_save(path, text, strlen(text));
    return path;
}

/* The cards of a header as text, with END. */
static void append(char *text, const sky_header *h, const char *end_of_line) {
    for (int64_t i = 0; i < h->n; i++) {
        sprintf(text + strlen(text), "%.80s%s", h->cards[i], end_of_line);
    }
    strcat(text, "END");
    strcat(text, end_of_line);
}

/* Three chips, whose coordinates replace SIP coordinates of other places. */
static void blocks_replace_coordinates(void **state) {
    (void)state;
    static char text[3 * SKY_FIXTURE_CARDS * 90];
    sky_header chips[3];
    text[0] = '\0';
    for (int i = 0; i < 3; i++) {
        chips[i] = sky_header_make("TAN");
        sky_header_number(&chips[i], "CRVAL1", 10.0 + i);
        if (i > 0)
            sky_header_add_tpv(&chips[i]);
        append(text, &chips[i], i == 1 ? "\r\n" : "\n");
        strcat(text, i == 0 ? "\n  \n" : "");
    }
    sky_header image = sky_header_make("TAN-SIP");
    sky_header_add_sip(&image);
    sky_header_set(&image, "EXTNAME = 'N15'");
    sky_header_set(&image, "AP_1_0  = 5.0");
    sky_header_set(&image, "RADESYS = 'FK5'");
    sky_header_set(&image, "CRVAL1A = 5.0");
    head_file h;
    shear_error err;
    assert_int_equal(head_file_init(&h, write_text(text), -1, &err), SHEAR_OK);
    assert_int_equal(h.n, 3);
    for (int i = 0; i < 3; i++) {
        int64_t count = image.n;
        char *const merged = head_file_merge(&h, i, image.cards[0], &count);
        assert_non_null(merged);
        sky_header both = {.n = count};
        assert_true(count < SKY_FIXTURE_CARDS);
        memcpy(both.cards, merged, (size_t)count * 80);
        free(merged);
        sky_map *map = sky_fixture_map(&both);
        const double x = 20.0, y = 3000.0;
        double ra, dec, a, d;
        sky_map_to_sky(map, 1, &x, &y, &ra, &dec);
        sky_oracle(&chips[i], x, y, &a, &d);
        assert_true(sky_distance(ra, dec, a, d) < 1e-12);
        sky_map_free(map);
        /* what is no coordinate stays */
        assert_memory_equal(both.cards[0], image.cards[0], 80);
        assert_memory_equal(both.cards[1], "EXTNAME = 'N15'", 15);
        assert_memory_equal(both.cards[2], "CRVAL1A = 5.0", 13);
    }
    head_file_deinit(&h);
}

static void descriptors_are_read_from_the_start(void **state) {
    (void)state;
    static char text[SKY_FIXTURE_CARDS * 90];
    const sky_header chip = sky_header_make("TAN");
    text[0] = '\0';
    append(text, &chip, "\n");
    const int fd = open(write_text(text), O_RDONLY | O_CLOEXEC);
    assert_true(fd >= 0 && lseek(fd, 0, SEEK_END) > 0);
    head_file h;
    shear_error err;
    assert_int_equal(head_file_init(&h, "another name", fd, &err), SHEAR_OK);
    assert_int_equal(h.n, 1);
    head_file_deinit(&h);
    close(fd);
}

static void refuse(const char *path, int code, const char *word) {
    head_file h;
    shear_error err = {0};
    assert_int_equal(head_file_init(&h, path, -1, &err), code);
    if (strstr(err.message, word) == NULL)
        fail_msg("'%s' is not in '%s'", word, err.message);
    head_file_deinit(&h);
}

static void what_is_no_head_file(void **state) {
    (void)state;
    const char *const type = "CTYPE1  = 'RA---TAN'\n";
    char text[400];
    refuse(write_text(""), SHEAR_E_FORMAT, "no END");
    refuse(write_text("\n\n"), SHEAR_E_FORMAT, "no END");
    refuse(write_text("END\n"), SHEAR_E_FORMAT, "block 1, which ends in line 1, has no CTYPE1");
    refuse(write_text(type), SHEAR_E_FORMAT, "no END");
    snprintf(text, sizeof text, "%sEND\n%s", type, type);
    refuse(write_text(text), SHEAR_E_FORMAT, "no END");
    snprintf(text, sizeof text, "%sEND\nCOMMENT  x\nEND\n", type);
    refuse(write_text(text), SHEAR_E_FORMAT, "block 2, which ends in line 4");
    snprintf(text, sizeof text, "%s\x01\nEND\n", type);
    refuse(write_text(text), SHEAR_E_FORMAT, "line 2");
    snprintf(text, sizeof text, "%-90s5\nEND\n", "CRVAL1  = ");
    refuse(write_text(text), SHEAR_E_FORMAT, "line 1");
    refuse(fixture_path("missing"), SHEAR_E_IO, "missing");
    const char *const path = fixture_path("image.fits");
    fixture_write_good(path);
    refuse(path, SHEAR_E_FORMAT, "head");
    const char *const huge = fixture_path("huge");
    const int fd = open(huge, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    assert_true(fd >= 0 && ftruncate(fd, (off_t)1 << 40) == 0);
    close(fd);
    refuse(huge, SHEAR_E_FORMAT, "1099511627776 bytes");
}

/* Bytes at random: an error, or blocks that can be merged. */
static void random_bytes(void **state) {
    (void)state;
    static const char *const pieces[] = {
        "END\n", "CTYPE1  = 'RA---TAN'\n", "\n", "END", "\r",
        "PV1_1", "CRVAL1  = 5\n",          "\t", "x",   "        \n"};
    srand(3);
    for (int round = 0; round < 300; round++) {
        char text[2000] = "";
        for (int n = rand() % 20; n > 0; n--)
            strcat(text, pieces[(size_t)rand() % (sizeof pieces / sizeof *pieces)]);
        head_file h;
        shear_error err;
        if (head_file_init(&h, write_text(text), -1, &err) == SHEAR_OK) {
            for (int i = 0; i < h.n; i++) {
                int64_t count = 0;
                char *const merged = head_file_merge(&h, i, NULL, &count);
                assert_true(merged != NULL && count >= 1);
                free(merged);
            }
        }
        head_file_deinit(&h);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_replace_coordinates),
        cmocka_unit_test(descriptors_are_read_from_the_start),
        cmocka_unit_test(what_is_no_head_file),
        cmocka_unit_test(random_bytes),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
