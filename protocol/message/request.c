/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters of requests. */
#include "message/table.h"

#include <stdio.h>
#include <string.h>

const msg_table msg_nothing = {.size = 0, .members = NULL, .n = 0};

static const msg_member hello_members[] = {
    MSG_INT_(sheard_msg_hello, oldest, "oldest", 1, 1000, 1, 0),
    MSG_INT_(sheard_msg_hello, newest, "newest", 1, 1000, 1, 0),
    MSG_TEXT_(sheard_msg_hello, client, "client", SHEARD_MSG_NAME_MAX, MSG_PLAIN),
};

static int check_hello(const void *message, sheard_rpc_error *error) {
    const sheard_msg_hello *hello = message;
    if (hello->oldest <= hello->newest) {
        return SHEARD_RPC_OK;
    }
    sheard_rpc_fail(error, SHEARD_RPC_BAD_PARAMETER, NULL, "'oldest' is newer than 'newest'");
    snprintf(error->parameter, sizeof error->parameter, "oldest");
    return error->code;
}
const msg_table msg_hello = {MSG_TABLE_(sheard_msg_hello, hello_members), .check = check_hello};

static const msg_member image_members[] = {
    MSG_TEXT_(sheard_msg_image, path, "path", SHEARD_MSG_PATH_MAX, MSG_REQUIRED | MSG_ABSOLUTE),
    MSG_INT_(sheard_msg_image, hdu, "hdu", 0, SHEARD_MSG_HDU_MAX, -1, MSG_NULLABLE),
    MSG_TEXT_(sheard_msg_image, extname, "extname", SHEARD_MSG_EXTNAME_MAX, MSG_PLAIN),
};
static const msg_table image = {MSG_TABLE_(sheard_msg_image, image_members), .check = NULL};

/* A source's members stand among those of what it belongs to. */
#define SOURCE_MEMBERS(T, at)                                                                      \
    MSG_TEXT_(T, at path, "path", SHEARD_MSG_PATH_MAX, MSG_ABSOLUTE),                              \
        MSG_OBJECT_(T, at galaxy, "galaxy", sheard_msg_image, &image, MSG_NULLABLE),               \
        MSG_OBJECT_(T, at noise, "noise", sheard_msg_image, &image, MSG_NULLABLE),                 \
        MSG_OBJECT_(T, at psf, "psf", sheard_msg_image, &image, MSG_NULLABLE),                     \
        MSG_OBJECT_(T, at catalog, "catalog", sheard_msg_image, &image, MSG_NULLABLE)

static const msg_member source_members[] = {SOURCE_MEMBERS(sheard_msg_source, )};

static int bad_source(sheard_rpc_error *error, int code, const char *parameter, const char *said) {
    sheard_rpc_fail(
        error, code,
        "give either \"path\", a field file, or all of \"galaxy\", \"noise\" and \"psf\"",
        "'%s': %s", parameter, said);
    snprintf(error->parameter, sizeof error->parameter, "%s", parameter);
    return code;
}

/* An HDU is chosen by its number or by its name. */
static int check_choices(const sheard_msg_source *s, sheard_rpc_error *error) {
    const sheard_msg_image *const images[] = {&s->galaxy, &s->noise, &s->psf, &s->catalog};
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (images[i]->hdu >= 0 && images[i]->extname != NULL) {
            sheard_rpc_fail(error, SHEARD_RPC_BAD_PARAMETER, "give \"hdu\" or \"extname\"",
                            "'%s.hdu': contradicts 'extname'", shear_part_name(i));
            snprintf(error->parameter, sizeof error->parameter, "%s.hdu", shear_part_name(i));
            return error->code;
        }
    }
    return SHEARD_RPC_OK;
}

static int check_source(const void *message, sheard_rpc_error *error) {
    const sheard_msg_source *s = message;
    const bool images = s->galaxy.path != NULL || s->noise.path != NULL || s->psf.path != NULL ||
                        s->catalog.path != NULL;
    if (s->path != NULL) {
        return images ? bad_source(error, SHEARD_RPC_BAD_PARAMETER, "path",
                                   "contradicts separate images")
                      : SHEARD_RPC_OK;
    }
    if (!images) {
        return bad_source(error, SHEARD_RPC_MISSING_PARAMETER, "path", "is missing");
    }
    const char *missing = s->galaxy.path == NULL  ? "galaxy"
                          : s->noise.path == NULL ? "noise"
                          : s->psf.path == NULL   ? "psf"
                                                  : NULL;
    return missing != NULL ? bad_source(error, SHEARD_RPC_MISSING_PARAMETER, missing, "is missing")
                           : check_choices(s, error);
}

shear_input sheard_source_input(const sheard_msg_source *s) {
    shear_input input = shear_input_of_file(s->path);
    const sheard_msg_image *const images[] = {&s->galaxy, &s->noise, &s->psf, &s->catalog};
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        input.parts[i] = (shear_input_part){images[i]->path, images[i]->extname, images[i]->hdu};
    }
    return input;
}

const msg_table msg_source = {MSG_TABLE_(sheard_msg_source, source_members), .check = check_source};

static const msg_member submit_members[] = {
    SOURCE_MEMBERS(sheard_msg_submit, source.),
    MSG_SETTINGS_(sheard_msg_submit, settings),
    MSG_TEXT_(sheard_msg_submit, field, "field", SHEARD_MSG_FIELD_MAX, MSG_PLAIN),
    MSG_INT_(sheard_msg_submit, priority, "priority", -SHEARD_MSG_PRIORITY_MAX,
             SHEARD_MSG_PRIORITY_MAX, 0, 0),
    MSG_TEXT_(sheard_msg_submit, key, "key", SHEARD_MSG_KEY_MAX, MSG_PLAIN),
    MSG_BOOL_(sheard_msg_submit, force, 0),
    MSG_BOOL_(sheard_msg_submit, wait, 0),
};

static int check_submit(const void *message, sheard_rpc_error *error) {
    return check_source(&((const sheard_msg_submit *)message)->source, error);
}
const msg_table msg_submit = {MSG_TABLE_(sheard_msg_submit, submit_members), .check = check_submit};

static const msg_member id_members[] = {
    MSG_INT_(sheard_msg_id, id, "id", 1, INT64_MAX, 0, MSG_REQUIRED),
};
const msg_table msg_id = {MSG_TABLE_(sheard_msg_id, id_members), .check = NULL};

static const msg_member jobs_members[] = {
    MSG_STATES_(sheard_msg_jobs, states, msg_states),
    MSG_TEXT_(sheard_msg_jobs, field, "field", SHEARD_MSG_FIELD_MAX, MSG_PLAIN),
    MSG_INT_(sheard_msg_jobs, owner, "owner", 0, UINT32_MAX, -1, MSG_NULLABLE),
    MSG_TEXT_(sheard_msg_jobs, cursor, "cursor", SHEARD_MSG_CURSOR_MAX, MSG_PLAIN),
    MSG_INT_(sheard_msg_jobs, limit, "limit", 1, SHEARD_MSG_JOBS_PAGE, 50, 0),
};
const msg_table msg_jobs = {MSG_TABLE_(sheard_msg_jobs, jobs_members), .check = NULL};

static const msg_member wait_members[] = {
    MSG_INTS_(sheard_msg_wait, ids, SHEARD_MSG_LIST_MAX, MSG_REQUIRED),
    MSG_REAL_(sheard_msg_wait, timeout_s, 0, SHEARD_MSG_WAIT_MAX),
};
const msg_table msg_wait = {MSG_TABLE_(sheard_msg_wait, wait_members), .check = NULL};

static const msg_member field_members[] = {
    MSG_TEXT_(sheard_msg_field, field, "field", SHEARD_MSG_FIELD_MAX, MSG_REQUIRED | MSG_PLAIN),
    MSG_TEXT_(sheard_msg_field, digest, "digest", SHEARD_MSG_DIGEST_MAX, MSG_PLAIN),
    MSG_INT_(sheard_msg_field, after, "after", 0, INT64_MAX, 0, 0),
    MSG_INT_(sheard_msg_field, limit, "limit", 0, SHEARD_MSG_FIELDS_PAGE, 100, 0),
};
const msg_table msg_field = {MSG_TABLE_(sheard_msg_field, field_members), .check = NULL};

static const msg_member forget_members[] = {
    MSG_TEXT_(sheard_msg_forget, field, "field", SHEARD_MSG_FIELD_MAX, MSG_REQUIRED | MSG_PLAIN),
    MSG_TEXT_(sheard_msg_forget, digest, "digest", SHEARD_MSG_DIGEST_MAX, MSG_PLAIN),
};
const msg_table msg_forget = {MSG_TABLE_(sheard_msg_forget, forget_members), .check = NULL};

static const msg_member fields_members[] = {
    MSG_TEXT_(sheard_msg_fields, prefix, "prefix", SHEARD_MSG_FIELD_MAX, MSG_PLAIN),
    MSG_TEXT_(sheard_msg_fields, cursor, "cursor", SHEARD_MSG_CURSOR_MAX, MSG_PLAIN),
    MSG_INT_(sheard_msg_fields, limit, "limit", 1, SHEARD_MSG_FIELDS_PAGE, 200, 0),
};
const msg_table msg_fields = {MSG_TABLE_(sheard_msg_fields, fields_members), .check = NULL};

#define WATCHED                                                                                    \
    MSG_INTS_(sheard_msg_subscribe, jobs, SHEARD_MSG_LIST_MAX, 0),                                 \
        MSG_TEXTS_(sheard_msg_subscribe, fields, SHEARD_MSG_LIST_MAX, SHEARD_MSG_FIELD_MAX,        \
                   MSG_PLAIN),                                                                     \
        MSG_BOOL_(sheard_msg_subscribe, all, 0)

static const msg_member subscribe_members[] = {
    WATCHED,
    MSG_BOOL_(sheard_msg_subscribe, progress, 0),
};

static int check_subscribe(const void *message, sheard_rpc_error *error) {
    const sheard_msg_subscribe *s = message;
    if (s->all || s->n_jobs > 0 || s->n_fields > 0) {
        return SHEARD_RPC_OK;
    }
    sheard_rpc_fail(error, SHEARD_RPC_MISSING_PARAMETER,
                    "give \"jobs\", \"fields\" or \"all\": true",
                    "'jobs': nothing is named to subscribe to");
    snprintf(error->parameter, sizeof error->parameter, "jobs");
    return error->code;
}
const msg_table msg_subscribe = {MSG_TABLE_(sheard_msg_subscribe, subscribe_members),
                                 .check = check_subscribe};

static const msg_member unsubscribe_members[] = {WATCHED};
const msg_table msg_unsubscribe = {MSG_TABLE_(sheard_msg_subscribe, unsubscribe_members),
                                   .check = NULL};

static const msg_member shutdown_members[] = {
    MSG_NAME_(sheard_msg_shutdown, mode, "mode", msg_modes, 0),
    MSG_REAL_(sheard_msg_shutdown, timeout_s, 0, SHEARD_MSG_WAIT_MAX),
};
const msg_table msg_shutdown = {MSG_TABLE_(sheard_msg_shutdown, shutdown_members), .check = NULL};
