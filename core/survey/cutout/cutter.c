/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/cutout/cutter.h"
