/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/field/internal.h: the members of an open field file. */
#pragma once

#include "fits/field/columns.h"
#include "fits/field/parts.h"
#include "fits/field/stamps.h"

struct shear_field {
    sf_parts parts;
    shear_field_info info;
    sf_stamps galaxy, noise;
    sf_image psf;
    sf_columns catalog;
};
