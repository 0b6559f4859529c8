/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear.h: all of libshear. */
#ifndef SHEAR_H
#define SHEAR_H

#include "shear/arrays.h"
#include "shear/catalog.h"
#include "shear/error.h"
#include "shear/field.h"
#include "shear/input.h"
#include "shear/plan.h"
#include "shear/psf.h"
#include "shear/run.h"
#include "shear/settings.h"
#include "shear/stamp.h"
#include "shear/sums.h"
#include "shear/symmetry.h"
#include "shear/text.h"
#include "shear/version.h"
#include "shear/work.h"

#endif
