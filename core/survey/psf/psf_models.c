/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/psf/psf_models.h"
