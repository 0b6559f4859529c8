/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "shear/version.h"

const char *shear_version(void) {
    return SHEAR_VERSION_STRING;
}
