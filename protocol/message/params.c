/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of the parameters of requests, and their checks. */
#include "message/table.h"

const msg_table msg_nothing = {.name = "nothing", .size = sizeof(sheard_msg_nothing)};

static const msg_member hello_members[] = {
    MSG_NUMBER(hello, oldest, 1, 1000, 1, 0),
    MSG_NUMBER(hello, newest, 1, 1000, 1, 0),
    MSG_STRING(hello, client, SHEARD_MSG_NAME_MAX, MSG_PLAIN),
};

static int check_hello(const void *message, sheard_rpc_error *error) {
    const sheard_msg_hello *hello = message;
    return hello->oldest <= hello->newest
               ? SHEARD_RPC_OK
               : sheard_rpc_fail_parameter(error, SHEARD_RPC_BAD_PARAMETER, "oldest", NULL,
                                           "is newer than 'newest'");
}
MSG_TABLE(hello, check_hello);

/* ---- Sources ---- */

MSG_PART(image, MSG_STRING(image, path, SHEARD_MSG_PATH_MAX, MSG_REQUIRED | MSG_ABSOLUTE),
         MSG_NUMBER(image, hdu, 0, SHEARD_MSG_HDU_MAX, -1, MSG_NULLABLE),
         MSG_STRING(image, extname, SHEARD_MSG_EXTNAME_MAX, MSG_PLAIN));

/* The members of a source are written among those of the message that contains it. */
#define SOURCE_MEMBERS(T, at)                                                                      \
    MSG_STRING_AS(T, at path, "path", SHEARD_MSG_PATH_MAX, MSG_ABSOLUTE),                          \
        MSG_STRUCT_AS(T, at galaxy, "galaxy", image, MSG_NULLABLE),                                \
        MSG_STRUCT_AS(T, at noise, "noise", image, MSG_NULLABLE),                                  \
        MSG_STRUCT_AS(T, at psf, "psf", image, MSG_NULLABLE),                                      \
        MSG_STRUCT_AS(T, at catalog, "catalog", image, MSG_NULLABLE)

static const msg_member source_members[] = {SOURCE_MEMBERS(source, )};

static int bad_source(sheard_rpc_error *error, int code, const char *parameter, const char *said) {
    return sheard_rpc_fail_parameter(
        error, code, parameter,
        "give either \"path\", a field file, or all of \"galaxy\", \"noise\" and \"psf\"", "%s",
        said);
}

/* List the images in the order of enum shear_part. */
static void list_images(const sheard_msg_source *s, const sheard_msg_image *images[SHEAR_N_PARTS]) {
    images[SHEAR_PART_GALAXY] = &s->galaxy;
    images[SHEAR_PART_NOISE] = &s->noise;
    images[SHEAR_PART_PSF] = &s->psf;
    images[SHEAR_PART_CATALOG] = &s->catalog;
}

/* Check that each HDU is given by its number or by its name, not both. */
static int check_choices(const sheard_msg_image *const images[SHEAR_N_PARTS],
                         sheard_rpc_error *error) {
    char parameter[SHEARD_RPC_PARAMETER_SIZE];
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (images[i]->hdu >= 0 && images[i]->extname != NULL) {
            snprintf(parameter, sizeof parameter, "%s.hdu", shear_part_name(i));
            return sheard_rpc_fail_parameter(error, SHEARD_RPC_BAD_PARAMETER, parameter,
                                             "give \"hdu\" or \"extname\"",
                                             "contradicts 'extname'");
        }
    }
    return SHEARD_RPC_OK;
}

static int check_source(const void *message, sheard_rpc_error *error) {
    const sheard_msg_source *s = message;
    const sheard_msg_image *images[SHEAR_N_PARTS];
    const char *missing = NULL; /* the first required image that is missing */
    bool any = false;
    list_images(s, images);
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        any = any || images[i]->path != NULL;
        if (missing == NULL && images[i]->path == NULL && i != SHEAR_PART_CATALOG)
            missing = shear_part_name(i);
    }
    if (s->path != NULL) {
        return any ? bad_source(error, SHEARD_RPC_BAD_PARAMETER, "path",
                                "contradicts separate images")
                   : SHEARD_RPC_OK;
    }
    if (missing != NULL) {
        return bad_source(error, SHEARD_RPC_MISSING_PARAMETER, any ? missing : "path",
                          "is missing");
    }
    return check_choices(images, error);
}
MSG_TABLE(source, check_source);

shear_input sheard_source_input(const sheard_msg_source *s) {
    shear_input input = shear_input_of_file(s->path);
    const sheard_msg_image *images[SHEAR_N_PARTS];
    list_images(s, images);
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        input.parts[i] = (shear_input_part){images[i]->path, images[i]->extname, images[i]->hdu};
    return input;
}

/* ---- Jobs ---- */

static const msg_member submit_members[] = {
    SOURCE_MEMBERS(submit, source.),
    MSG_JSON(submit, settings, MSG_SETTINGS),
    MSG_STRING(submit, field, SHEARD_MSG_FIELD_MAX, MSG_PLAIN),
    MSG_NUMBER(submit, priority, -SHEARD_MSG_PRIORITY_MAX, SHEARD_MSG_PRIORITY_MAX, 0, 0),
    MSG_STRING(submit, key, SHEARD_MSG_KEY_MAX, MSG_PLAIN),
    MSG(submit, force),
    MSG(submit, wait),
};

static int check_submit(const void *message, sheard_rpc_error *error) {
    return check_source(&((const sheard_msg_submit *)message)->source, error);
}
MSG_TABLE(submit, check_submit);

MSG_WHOLE(id, MSG_NUMBER(id, id, 1, INT64_MAX, 0, MSG_REQUIRED));

MSG_WHOLE(jobs, MSG_SET(jobs, states, msg_job_states),
          MSG_STRING(jobs, field, SHEARD_MSG_FIELD_MAX, MSG_PLAIN),
          MSG_NUMBER(jobs, owner, 0, UINT32_MAX, -1, MSG_NULLABLE),
          MSG_STRING(jobs, cursor, SHEARD_MSG_CURSOR_MAX, MSG_PLAIN),
          MSG_NUMBER(jobs, limit, 1, SHEARD_MSG_JOBS_PAGE, 50, 0));

MSG_WHOLE(wait, MSG_IDS(wait, ids, SHEARD_MSG_LIST_MAX, MSG_REQUIRED),
          MSG_UP_TO(wait, timeout_s, SHEARD_MSG_WAIT_MAX));

/* ---- Fields ---- */

MSG_WHOLE(field, MSG_STRING(field, field, SHEARD_MSG_FIELD_MAX, MSG_REQUIRED | MSG_PLAIN),
          MSG_STRING(field, digest, SHEARD_MSG_DIGEST_MAX, MSG_PLAIN),
          MSG_NUMBER(field, after, 0, INT64_MAX, 0, 0),
          MSG_NUMBER(field, limit, 0, SHEARD_MSG_FIELDS_PAGE, 100, 0));

MSG_WHOLE(forget, MSG_STRING(forget, field, SHEARD_MSG_FIELD_MAX, MSG_REQUIRED | MSG_PLAIN),
          MSG_STRING(forget, digest, SHEARD_MSG_DIGEST_MAX, MSG_PLAIN));

MSG_WHOLE(fields, MSG_STRING(fields, prefix, SHEARD_MSG_FIELD_MAX, MSG_PLAIN),
          MSG_STRING(fields, cursor, SHEARD_MSG_CURSOR_MAX, MSG_PLAIN),
          MSG_NUMBER(fields, limit, 1, SHEARD_MSG_FIELDS_PAGE, 200, 0));

/* ---- Subscriptions and the service ---- */

#define WATCHED                                                                                    \
    MSG_IDS(subscribe, jobs, SHEARD_MSG_LIST_MAX, 0),                                              \
        MSG_STRINGS(subscribe, fields, SHEARD_MSG_LIST_MAX, SHEARD_MSG_FIELD_MAX, MSG_PLAIN),      \
        MSG(subscribe, all)

static const msg_member subscribe_members[] = {WATCHED, MSG(subscribe, progress)};

static int check_subscribe(const void *message, sheard_rpc_error *error) {
    const sheard_msg_subscribe *s = message;
    return s->all || s->n_jobs > 0 || s->n_fields > 0
               ? SHEARD_RPC_OK
               : sheard_rpc_fail_parameter(error, SHEARD_RPC_MISSING_PARAMETER, "jobs",
                                           "give \"jobs\", \"fields\" or \"all\": true",
                                           "nothing is named to subscribe to");
}
MSG_TABLE(subscribe, check_subscribe);

MSG_WHOLE(unsubscribe, WATCHED);

MSG_WHOLE(shutdown, MSG_NAMED(shutdown, mode, "mode", msg_shutdown_modes, 0),
          MSG_UP_TO(shutdown, timeout_s, SHEARD_MSG_WAIT_MAX));
