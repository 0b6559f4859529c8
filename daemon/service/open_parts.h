/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/open_parts.h: open store, engine and server as configured. */
#pragma once

#include "shear/error.h"

typedef struct service service;

int open_store(service *s, shear_error *err);
int open_engine(service *s, shear_error *err);
int open_server(service *s, shear_error *err);
