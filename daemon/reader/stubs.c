/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replace the functions of libcurl (downloads) and libbz2 (whole *.bz2 files) that CFITSIO refers
 * to, for a reader with CFITSIO linked as an archive. The reader uses neither: it reads the
 * descriptors that it was given, and has no network. Without libcurl and the thirty libraries that
 * come with it a reader starts much faster, and an attacker who exploits CFITSIO finds less code.
 * The build allows unused parameters here, and functions that no header declares. */

enum { CURL_FAILED_INIT = 2, BZ_CONFIG_ERROR = -9 }; /* as in their headers */

void *curl_easy_init(void) {
    return 0;
}

int curl_easy_setopt(void *handle, int option, ...) {
    return CURL_FAILED_INIT;
}

int curl_easy_perform(void *handle) {
    return CURL_FAILED_INIT;
}

void curl_easy_cleanup(void *handle) {
}

int curl_global_init(long flags) {
    return CURL_FAILED_INIT;
}

void curl_global_cleanup(void) {
}

void *BZ2_bzReadOpen(int *error, void *file, int verbosity, int is_small, void *unused, int n) {
    *error = BZ_CONFIG_ERROR;
    return 0;
}

int BZ2_bzRead(int *error, void *file, void *out, int n) {
    *error = BZ_CONFIG_ERROR;
    return 0;
}

void BZ2_bzReadClose(int *error, void *file) {
    *error = 0;
}
