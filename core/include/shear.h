/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * @file shear.h
 * All of libshear: the headers in shear/.
 *
 * @mainpage libshear
 * The mean gravitational shear of galaxy stamps by the method of Zhang (2010): moments of
 * noise-corrected power spectra, without a model of a galaxy and without calibration.
 *
 * - shear_measure_arrays(): the shear of stamps in memory (shear/arrays.h)
 * - shear_run_file(): the shear of a field file (shear/run.h)
 * - shear_plan_new(), shear_measure(), shear_block_sums_add(): the same in steps (shear/plan.h,
 *   shear/sums.h); shear_work_new(): the same with threads of the caller's own (shear/work.h)
 * - shear_settings_set(): the choices of the measurement (shear/settings.h)
 * - shear_field_create(): writing field files (shear/field.h)
 * - shear_field_get_chip(): the chips of an exposure (shear/chip.h)
 * - shear_catalog_read(): the results of single stamps (shear/catalog.h)
 *
 * Every call that can fail returns enum shear_code (shear/error.h). Lengths are in galaxy pixels.
 * The program examples show an in-memory field, a file and a stream; `pkg-config --cflags --libs
 * libshear` and CMake's `find_package(shear)` (target shear::shear) find the library.
 */
#ifndef SHEAR_H
#define SHEAR_H

#include "shear/arrays.h"
#include "shear/catalog.h"
#include "shear/centring.h"
#include "shear/chip.h"
#include "shear/error.h"
#include "shear/field.h"
#include "shear/input.h"
#include "shear/linkage.h"
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
