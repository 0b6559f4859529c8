/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/source_list.h"
