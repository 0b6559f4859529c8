/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "shear/input.h"

#include "base/text.h"

#include <stdio.h>

const char *shear_part_name(int part) {
    static const char *const names[SHEAR_N_PARTS] = {
        "galaxy", "noise", "psf", "catalog", "image", "weight", "mask", "segmentation", "wcs"};
    return part >= 0 && part < SHEAR_N_PARTS ? names[part] : "unknown";
}

bool shear_input_is_exposure(const shear_input *input) {
    return input->path == NULL && input->parts[SHEAR_PART_IMAGE].path != NULL;
}

const char *shear_input_name(const shear_input *input) {
    const int part =
        shear_input_is_exposure(input) ? (int)SHEAR_PART_IMAGE : (int)SHEAR_PART_GALAXY;
    return input->path != NULL ? input->path : input->parts[part].path;
}

shear_input shear_input_of_file(const char *path) {
    shear_input input = {.path = path, .exposure = {.origin = 1}};
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        input.parts[i].hdu = -1;
    return input;
}

static void append(char *buf, size_t size, const char *separator, const shear_input_part *part) {
    char hdu[24] = "";
    if (part->extname == NULL && part->hdu >= 0)
        snprintf(hdu, sizeof hdu, "%lld", (long long)part->hdu);
    const char *chosen = part->extname != NULL ? part->extname : hdu;
    text_append(buf, size, "%s%s%s%s", separator, part->path, chosen[0] != '\0' ? ":" : "", chosen);
}

char *shear_input_text(const shear_input *input, char *buf, size_t size) {
    const int first = shear_input_is_exposure(input) ? SHEAR_PART_IMAGE : 0;
    text_set(buf, size, input->path);
    for (int i = 0; i < SHEAR_N_PARTS && input->path == NULL; i++) {
        const shear_input_part *part = &input->parts[(first + i) % SHEAR_N_PARTS];
        if (part->path != NULL)
            append(buf, size, buf[0] != '\0' ? " + " : "", part);
    }
    return buf;
}
