/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/pixels/chip_pixels.h"
