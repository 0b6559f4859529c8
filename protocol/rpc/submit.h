/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rpc/submit.h: read the parameters of submit, which are also the content of a job file. */
#pragma once

#include "sheard/rpc.h"

#include <jansson.h>

/* Read `params` (NULL: none) and check its settings together with `defaults` (NULL:
 * shear_settings_init). On an error *submit is empty. */
int submit_read(sheard_msg_submit *submit, const json_t *params, const shear_settings *defaults,
                sheard_rpc_error *error);
