/* SPDX-License-Identifier: GPL-3.0-or-later */
/* common/release.h: TYPE_release functions of libshear's own types, for CLEANUP
 * (base/cleanup.h). */
#pragma once

#include "base/cleanup.h"
#include "shear/field.h"
#include "shear/plan.h"
#include "shear/sums.h"
#include "shear/symmetry.h"
#include "shear/work.h"

CLEANUP_DEFINE(shear_block, shear_block_free)
CLEANUP_DEFINE(shear_field, shear_field_close)
CLEANUP_DEFINE(shear_field_sums, shear_field_sums_free)
CLEANUP_DEFINE(shear_hashing, shear_hashing_free)
CLEANUP_DEFINE(shear_jackknife, shear_jackknife_free)
CLEANUP_DEFINE(shear_plan, shear_plan_free)
CLEANUP_DEFINE(shear_symmetry, shear_symmetry_free)
CLEANUP_DEFINE(shear_work, shear_work_free)
CLEANUP_DEFINE(shear_worker, shear_worker_free)
CLEANUP_DEFINE(shear_workspace, shear_workspace_free)
