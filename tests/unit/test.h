/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/test.h: cmocka, with the headers it wants before it. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
