/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who a peer is, by socket, name or text; lists of users and groups. */
#include "access_fixture.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static void peer_of_a_socket(void **state) {
    (void)state;
    int pair[2];
    access_peer peer;
    shear_error err = {0};
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
    assert_int_equal(access_peer_from_socket(pair[0], &peer, NULL), SHEAR_OK);
    assert_int_equal(peer.uid, geteuid());
    assert_int_equal(peer.gid, getegid());
    assert_int_equal(peer.n_groups, getgroups(0, NULL));
    access_peer_deinit(&peer);
    close(pair[1]);
    close(pair[0]);
    const int lone = socket(AF_UNIX, SOCK_STREAM, 0);
    assert_int_equal(access_peer_from_socket(lone, &peer, &err), SHEAR_E_IO);
    close(lone);
    assert_int_equal(access_peer_from_socket(-1, &peer, &err), SHEAR_E_IO);
}

static void peer_of_a_user(void **state) {
    (void)state;
    access_peer peer;
    assert_int_equal(access_peer_from_user(0, 5, &peer, NULL), SHEAR_OK);
    assert_int_equal(peer.uid, 0);
    assert_int_equal(peer.gid, 0);
    assert_true(peer.n_groups >= 1);
    access_peer_deinit(&peer);
    assert_int_equal(access_peer_from_user(ALICE, STAFF, &peer, NULL), SHEAR_OK);
    assert_int_equal(peer.uid, ALICE);
    assert_int_equal(peer.gid, STAFF);
    assert_int_equal(peer.n_groups, 0);
    access_peer_deinit(&peer);
}

static void groups_as_text(void **state) {
    (void)state;
    gid_t some[] = {4, 27, 4294967294u};
    const access_peer peers[] = {
        {ALICE, STAFF, some, 3}, {ALICE, STAFF, some, 1}, {ALICE, STAFF, NULL, 0}};
    const char *const texts[] = {"4 27 4294967294", "4", ""};
    access_peer back;
    shear_error err = {0};
    for (int i = 0; i < 3; i++) {
        char *text = NULL;
        assert_int_equal(access_peer_groups_text(&peers[i], &text, &err), SHEAR_OK);
        assert_string_equal(text, texts[i]);
        assert_int_equal(access_peer_from_text(ALICE, STAFF, text, &back, &err), SHEAR_OK);
        assert_int_equal(back.uid, ALICE);
        assert_int_equal(back.gid, STAFF);
        assert_int_equal(back.n_groups, peers[i].n_groups);
        assert_memory_equal(back.groups, some, back.n_groups * sizeof *some);
        access_peer_deinit(&back);
        free(text);
    }
    const char *const bad[] = {"x", " 4", "4 ", "4  5", "4,5", "-4", "4294967296", "0x4", "4\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(access_peer_from_text(ALICE, STAFF, bad[i], &back, &err),
                         SHEAR_E_INTERNAL);
        assert_int_equal(back.n_groups, 0); /* no rights where they cannot be read */
    }
}

static void lists_of_users_and_groups(void **state) {
    (void)state;
    char root_name[] = "root";
    char number[] = "54324"; /* Bob */
    char team[] = "54323";
    const sheard_list users = {2, (char *[]){root_name, number}};
    const sheard_list groups = {1, (char *[]){team}};
    const sheard_list nobody = {0};
    gid_t in_team[] = {7, TEAM};
    const access_peer bob = {BOB, STAFF, NULL, 0};
    const access_peer member = {ALICE, STAFF, in_team, 2};
    const access_peer primary = {ALICE, TEAM, NULL, 0};
    access_list *list = NULL;
    shear_error err = {0};
    assert_int_equal(access_list_new(&list, &users, &groups, &err), SHEAR_OK);
    assert_true(access_list_has(list, &root_peer));
    assert_true(access_list_has(list, &bob));
    assert_true(access_list_has(list, &member));
    assert_true(access_list_has(list, &primary));
    assert_false(access_list_has(list, &alice));
    access_list_free(list);
    assert_int_equal(access_list_new(&list, &nobody, &nobody, &err), SHEAR_OK);
    assert_false(access_list_has(list, &root_peer));
    access_list_free(list);
    char unknown[] = "no-such-name-here";
    char too_large[] = "4294967295";
    char *bad[][1] = {{unknown}, {too_large}};
    for (int i = 0; i < 2; i++) {
        const sheard_list one = {1, bad[i]};
        assert_int_equal(access_list_new(&list, &one, &one, &err), SHEAR_OK);
        assert_false(access_list_has(list, &alice) || access_list_has(list, &root_peer));
        assert_non_null(strstr(access_list_unknown(list, 0), "no user"));
        assert_non_null(strstr(access_list_unknown(list, 0), bad[i][0]));
        assert_non_null(strstr(access_list_unknown(list, 1), "no group"));
        assert_null(access_list_unknown(list, 2));
        access_list_free(list);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(peer_of_a_socket),
        cmocka_unit_test(peer_of_a_user),
        cmocka_unit_test(groups_as_text),
        cmocka_unit_test(lists_of_users_and_groups),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
