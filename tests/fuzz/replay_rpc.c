/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_rpc without libFuzzer: replay_rpc FILE... gives it each file, after every first byte that
 * means something else. */
#include "fuzz_rpc.h"

#include <stdio.h>
#include <stdlib.h>

enum { LARGEST = 1 << 20 };

static int replay(const char *path, uint8_t *bytes) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        perror(path);
        return 1;
    }
    const size_t n = fread(bytes + 1, 1, LARGEST - 1, file);
    fclose(file);
    for (int first = 0; first < 256; first += 17) {
        bytes[0] = (uint8_t)first;
        LLVMFuzzerTestOneInput(bytes, n + 1);
    }
    return n > 0 ? 0 : 1;
}

int main(int argc, char **argv) {
    uint8_t *bytes = malloc(LARGEST);
    int failed = bytes == NULL || argc < 2;
    for (int i = 1; i < argc && failed == 0; i++)
        failed = replay(argv[i], bytes);
    free(bytes);
    return failed;
}
