/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The version of the library that is linked. */
#include "shear/version.h"

const char *shear_version(void) {
    return SHEAR_VERSION_STRING;
}
