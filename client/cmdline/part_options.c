/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/part_options.h"

#include "base/cleanup.h"
#include "cmdline/input_path.h"

#include <stdlib.h>
#include <string.h>

static bool are_images_given(const part_options *o, bool all) {
    const bool galaxy = o->given[SHEAR_PART_GALAXY] != NULL;
    const bool noise = o->given[SHEAR_PART_NOISE] != NULL;
    const bool psf = o->given[SHEAR_PART_PSF] != NULL;
    return all ? galaxy && noise && psf : galaxy || noise || psf;
}

bool part_options_any(const part_options *o) {
    return are_images_given(o, false) || o->given[SHEAR_PART_CATALOG] != NULL;
}

/* Replace only the catalog of a field file: the file itself is all other parts. */
static void use_file(part_options *o, const char *file) {
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        o->given[i] = i == SHEAR_PART_CATALOG ? o->given[i] : file;
}

enum exit_code part_options_settle(part_options *o, const command *self, char **files,
                                   int n_files) {
    const bool all = are_images_given(o, true);
    if (are_images_given(o, false) && n_files > 0)
        return options_fail(self, "give either field files, or --galaxy, --noise and --psf");
    if (o->given[SHEAR_PART_CATALOG] != NULL && n_files > 1)
        return options_fail(self, "--catalog-in goes with one field file");
    if (part_options_any(o) && !all && n_files < 1)
        return options_fail(self, "--galaxy, --noise and --psf belong together");
    if (o->given[SHEAR_PART_CATALOG] != NULL && n_files == 1)
        use_file(o, files[0]);
    return !all && n_files < 1 ? options_fail(self, "which files?") : EXIT_CODE_DONE;
}

static int set_part(part_input *p, int i, const char *given, bool absolute, shear_error *err) {
    shear_input_part *part = &p->input.parts[i];
    size_t length = 0;
    TRY(input_path_hdu(given, part, &length, err));
    CLEANUP(release_free) char *file = strndup(given, length);
    if (file == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    if (!absolute) {
        part->path = p->paths[i] = CLEANUP_TAKE(file);
        return SHEAR_OK;
    }
    const int found = input_path_absolute(file, &p->paths[i], err);
    part->path = p->paths[i];
    return found;
}

int part_input_init(part_input *p, const part_options *o, bool absolute, shear_error *err) {
    *p = (part_input){.input = shear_input_of_file(NULL)};
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (o->given[i] != NULL)
            TRY(set_part(p, i, o->given[i], absolute, err));
    }
    return SHEAR_OK;
}

void part_input_deinit(part_input *p) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        free(p->paths[i]);
        p->paths[i] = NULL;
    }
}
