/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rpc/submit.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "message/table.h"

static int check_settings(const sheard_msg_submit *submit, const shear_settings *defaults,
                          sheard_rpc_error *error) {
    shear_settings s;
    shear_settings_init(&s);
    if (defaults != NULL)
        s = *defaults;
    shear_error core = {0};
    if (sheard_settings_apply(&s, submit->settings, &core) == SHEAR_OK)
        return SHEARD_RPC_OK;
    sheard_rpc_fail_core(error, &core);
    text_set(error->parameter, sizeof error->parameter, "settings");
    return error->code;
}

int submit_read(sheard_msg_submit *submit, const json_t *params, const shear_settings *defaults,
                sheard_rpc_error *error) {
    TRY(msg_read(submit, &msg_submit, params, MSG_STRICT, error));
    const int code = check_settings(submit, defaults, error);
    if (code != SHEARD_RPC_OK)
        msg_deinit(submit, &msg_submit);
    return code;
}
