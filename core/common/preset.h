/* SPDX-License-Identifier: GPL-3.0-or-later */
/* common/preset.h: all settings at once. */
#ifndef SHEAR_COMMON_PRESET_H
#define SHEAR_COMMON_PRESET_H

#include "shear/error.h"
#include "shear/settings.h"

/* Set all members to those of enum shear_preset `preset`. */
int preset_apply(shear_settings *s, enum shear_preset preset, shear_error *err);

#endif
