/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_map.h"
