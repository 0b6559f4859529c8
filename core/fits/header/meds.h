/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/meds.h: files of multi-epoch cut-outs (MEDS), which are known by their HDUs. */
#pragma once

#include "fits/header/file.h"

/* SHEAR_E_FORMAT: the file is a MEDS file, of which stamps cannot be read. Its table of objects may
 * serve as a catalog. */
int sf_meds_refuse(const sf_file *f, shear_error *err);
