/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open a field, whatever it is: a field file, its parts, or an exposure. */
#include "survey/exposure.h"

#include "fits/field/reader.h"

int shear_field_open_input(shear_field **field, const shear_input *input, const int *fds,
                           shear_error *err) {
    return shear_input_is_exposure(input) ? exposure_open(field, input, fds, err)
                                          : field_file_open(field, input, fds, err);
}

int shear_field_open(shear_field **field, const char *path, shear_error *err) {
    const shear_input input = shear_input_of_file(path);
    return shear_field_open_input(field, &input, NULL, err);
}

int shear_field_open_fd(shear_field **field, int fd, const char *name, shear_error *err) {
    const shear_input input = shear_input_of_file(name);
    return shear_field_open_input(field, &input, &fd, err);
}
