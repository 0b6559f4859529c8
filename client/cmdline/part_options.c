/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/part_options.h"

#include "base/cleanup.h"
#include "cmdline/input_path.h"
#include "terminal/message.h"

#include <stdlib.h>
#include <string.h>

static bool are_images_given(const part_options *o, bool all) {
    const bool galaxy = o->given[SHEAR_PART_GALAXY] != NULL;
    const bool noise = o->given[SHEAR_PART_NOISE] != NULL;
    const bool psf = o->given[SHEAR_PART_PSF] != NULL;
    return all ? galaxy && noise && psf : galaxy || noise || psf;
}

bool part_options_any(const part_options *o) {
    return are_images_given(o, false) || o->given[SHEAR_PART_CATALOG] != NULL ||
           o->given[SHEAR_PART_IMAGE] != NULL;
}

enum exit_code part_options_set(const option_entry *entry, const char *value) {
    part_options *o = entry->context;
    shear_error err = {0};
    o->of_exposure = entry->name;
    if (shear_exposure_set(&o->exposure, entry->name, value, &err) == SHEAR_OK)
        return EXIT_CODE_DONE;
    return message_fail(EXIT_CODE_USAGE, err.advice, "--%s", err.message);
}

enum exit_code part_options_set_size(const option_entry *entry, const char *value) {
    part_options *o = entry->context;
    shear_error err = {0};
    return shear_mosaic_set_size(&o->mosaic, value, &err) == SHEAR_OK
               ? EXIT_CODE_DONE
               : message_fail(EXIT_CODE_USAGE, NULL, "--%s", err.message);
}

/* Replace only the catalog of a field file: the file itself is all other parts. */
static void use_file(part_options *o, const char *file) {
    o->given[SHEAR_PART_GALAXY] = o->given[SHEAR_PART_NOISE] = o->given[SHEAR_PART_PSF] = file;
}

/* Return the name of an option of exposures that was given without an image; NULL: none. */
static const char *stray(const part_options *o) {
    for (int i = SHEAR_PART_IMAGE + 1; i < SHEAR_N_PARTS; i++) {
        if (o->given[i] != NULL)
            return shear_part_name(i);
    }
    return o->sources != NULL ? "sources" : o->of_exposure;
}

/* Settle --noise, which is a word or a file, and --sources. */
static enum exit_code settle_exposure(part_options *o, const command *self, int n_files) {
    const char *noise = o->given[SHEAR_PART_NOISE];
    if (n_files > 0 || o->given[SHEAR_PART_GALAXY] != NULL)
        return options_fail(self, "give either field files, or --galaxy ..., or --image ...");
    if (o->given[SHEAR_PART_CATALOG] != NULL)
        return options_fail(self, "the catalog of an exposure is --sources");
    if (o->mosaic.stamp_nx != 0 || o->mosaic.stamps != 0)
        return options_fail(self, "the side of an exposure's stamps is --stamp");
    if (o->sources == NULL || o->given[SHEAR_PART_PSF] == NULL)
        return options_fail(self, "--image needs --sources and --psf");
    o->given[SHEAR_PART_CATALOG] = o->sources;
    if (noise == NULL || shear_exposure_set(&o->exposure, "noise", noise, NULL) == SHEAR_OK) {
        o->given[SHEAR_PART_NOISE] = NULL;
    } else {
        o->exposure.noise = SHEAR_NOISE_IMAGE;
    }
    return EXIT_CODE_DONE;
}

enum exit_code part_options_settle(part_options *o, const command *self, char **files,
                                   int n_files) {
    const bool all = are_images_given(o, true);
    if (o->given[SHEAR_PART_IMAGE] != NULL)
        return settle_exposure(o, self, n_files);
    if (stray(o) != NULL)
        return options_fail(self, "--%s belongs to an exposure: give --image, too", stray(o));
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
    p->input.exposure = o->exposure;
    p->input.mosaic = o->mosaic;
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
