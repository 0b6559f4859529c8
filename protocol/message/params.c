/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of the parameters of requests, and their checks. */
#include "message/table.h"

#include "base/cleanup.h"
#include "shear/stamp.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* The number of an option, or -1. */
#define OPTION_NUMBER(member, low, high) MSG_NUMBER(exposure, member, low, high, -1, MSG_NULLABLE)
#define OPTION_TEXT(member)              MSG_STRING(exposure, member, SHEARD_MSG_OPTION_MAX, MSG_PLAIN)

/* A required file is null only in an exposure that is not there. */
#define EXPOSURE_FILE(member, flag) MSG_STRUCT(exposure, member, image, MSG_NULLABLE | (flag))

MSG_PART(exposure, EXPOSURE_FILE(image, MSG_REQUIRED), EXPOSURE_FILE(sources, MSG_REQUIRED),
         EXPOSURE_FILE(psf, MSG_REQUIRED), EXPOSURE_FILE(weight, 0), OPTION_TEXT(weight_kind),
         EXPOSURE_FILE(mask, 0), OPTION_TEXT(mask_bad), EXPOSURE_FILE(segmentation, 0),
         EXPOSURE_FILE(wcs, 0), OPTION_TEXT(columns), OPTION_NUMBER(origin, 0, 1),
         OPTION_TEXT(select), OPTION_TEXT(carry), OPTION_TEXT(psf_kind),
         OPTION_NUMBER(stamp, SHEAR_MIN_SIDE, SHEAR_MAX_SIDE), OPTION_TEXT(noise),
         EXPOSURE_FILE(noise_image, 0), OPTION_NUMBER(noise_stamps, 1, SHEAR_MAX_NOISE_PLANES),
         OPTION_TEXT(amplifiers), OPTION_TEXT(frame));

/* A number that is 0 if it is not given. */
#define MSG_NUMBER_AS(T, member, key, low, high)                                                   \
    MSG_MEMBER(T, member, key, MSG_INT, int64_t, .flags = MSG_NULLABLE, .min = (low), .max = (high))

/* The members of a source are written among those of the message that contains it. */
#define SOURCE_MEMBERS(T, at)                                                                      \
    MSG_STRING_AS(T, at path, "path", SHEARD_MSG_PATH_MAX, MSG_ABSOLUTE),                          \
        MSG_STRUCT_AS(T, at galaxy, "galaxy", image, MSG_NULLABLE),                                \
        MSG_STRUCT_AS(T, at noise, "noise", image, MSG_NULLABLE),                                  \
        MSG_STRUCT_AS(T, at psf, "psf", image, MSG_NULLABLE),                                      \
        MSG_STRUCT_AS(T, at catalog, "catalog", image, MSG_NULLABLE),                              \
        MSG_NUMBER_AS(T, at stamp_nx, "stamp_nx", SHEAR_MIN_SIDE, SHEAR_MAX_SIDE),                 \
        MSG_NUMBER_AS(T, at stamp_ny, "stamp_ny", SHEAR_MIN_SIDE, SHEAR_MAX_SIDE),                 \
        MSG_NUMBER_AS(T, at stamps, "stamps", 1, INT32_MAX),                                       \
        MSG_STRUCT_AS(T, at exposure, "exposure", exposure, MSG_NULLABLE)

static const msg_member source_members[] = {SOURCE_MEMBERS(source, )};

static int bad_source(sheard_rpc_error *error, int code, const char *parameter, const char *said) {
    return sheard_rpc_fail_parameter(error, code, parameter,
                                     "give \"path\", a field file; or all of \"galaxy\", "
                                     "\"noise\" and \"psf\"; or \"exposure\"",
                                     "%s", said);
}

static bool is_exposure(const sheard_msg_source *s) {
    return s->exposure.image.path != NULL;
}

void sheard_source_parts(sheard_msg_source *s, sheard_msg_image *parts[SHEAR_N_PARTS]) {
    sheard_msg_exposure *e = &s->exposure;
    const bool exposure = is_exposure(s);
    parts[SHEAR_PART_GALAXY] = &s->galaxy;
    parts[SHEAR_PART_NOISE] = exposure ? &e->noise_image : &s->noise;
    parts[SHEAR_PART_PSF] = exposure ? &e->psf : &s->psf;
    parts[SHEAR_PART_CATALOG] = exposure ? &e->sources : &s->catalog;
    parts[SHEAR_PART_IMAGE] = &e->image;
    parts[SHEAR_PART_WEIGHT] = &e->weight;
    parts[SHEAR_PART_MASK] = &e->mask;
    parts[SHEAR_PART_SEGMENTATION] = &e->segmentation;
    parts[SHEAR_PART_WCS] = &e->wcs;
}

char *sheard_source_parameter(const sheard_msg_source *s, int part, const char *member, char *buf,
                              size_t size) {
    const bool exposure = is_exposure(s);
    const char *name = exposure && part == SHEAR_PART_CATALOG ? "sources"
                       : exposure && part == SHEAR_PART_NOISE ? "noise_image"
                                                              : shear_part_name(part);
    snprintf(buf, size, "%s%s.%s", exposure ? "exposure." : "", name, member);
    return buf;
}

/* Check that each HDU is given by its number or by its name, not both. */
static int check_choices(const sheard_msg_source *s, sheard_msg_image *const parts[SHEAR_N_PARTS],
                         sheard_rpc_error *error) {
    char parameter[SHEARD_RPC_PARAMETER_SIZE];
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (parts[i]->hdu >= 0 && parts[i]->extname != NULL) {
            return sheard_rpc_fail_parameter(
                error, SHEARD_RPC_BAD_PARAMETER,
                sheard_source_parameter(s, i, "hdu", parameter, sizeof parameter),
                "give \"hdu\" or \"extname\"", "contradicts 'extname'");
        }
    }
    return SHEARD_RPC_OK;
}

/* ---- Exposures ---- */

/* The members that are options of shear_exposure_set(): texts, and numbers that are -1 if not
 * given. */
static const struct {
    const char *member; /* in JSON; the option has dashes */
    const char *option;
    size_t offset;
    bool number;
} options[] = {
    {"weight_kind", "weight-kind", offsetof(sheard_msg_exposure, weight_kind), false},
    {"mask_bad", "mask-bad", offsetof(sheard_msg_exposure, mask_bad), false},
    {"columns", "columns", offsetof(sheard_msg_exposure, columns), false},
    {"origin", "origin", offsetof(sheard_msg_exposure, origin), true},
    {"select", "select", offsetof(sheard_msg_exposure, select), false},
    {"carry", "carry", offsetof(sheard_msg_exposure, carry), false},
    {"psf_kind", "psf-kind", offsetof(sheard_msg_exposure, psf_kind), false},
    {"stamp", "stamp", offsetof(sheard_msg_exposure, stamp), true},
    {"noise", "noise", offsetof(sheard_msg_exposure, noise), false},
    {"noise_stamps", "noise-stamps", offsetof(sheard_msg_exposure, noise_stamps), true},
    {"amplifiers", "amplifiers", offsetof(sheard_msg_exposure, amplifiers), false},
    {"frame", "frame", offsetof(sheard_msg_exposure, frame), false},
};
enum { N_OPTIONS = sizeof options / sizeof options[0] };

/* Set option `i` of *to, if it is given. */
static int set_option(shear_exposure *to, const sheard_msg_exposure *from, int i,
                      shear_error *err) {
    const void *member = (const char *)from + options[i].offset;
    char number[24];
    const char *text = number;
    int64_t value = 0;
    if (options[i].number) {
        memcpy(&value, member, sizeof value);
        snprintf(number, sizeof number, "%lld", (long long)value);
        text = value >= 0 ? number : NULL;
    } else {
        memcpy(&text, member, sizeof text);
    }
    return text != NULL ? shear_exposure_set(to, options[i].option, text, err) : SHEAR_OK;
}

static int check_exposure(const sheard_msg_exposure *e, sheard_rpc_error *error) {
    char parameter[SHEARD_RPC_PARAMETER_SIZE];
    shear_exposure unused = {.origin = 1};
    shear_error err = {0};
    const char *missing = e->sources.path == NULL ? "exposure.sources"
                          : e->psf.path == NULL   ? "exposure.psf"
                                                  : NULL;
    if (missing != NULL)
        return bad_source(error, SHEARD_RPC_MISSING_PARAMETER, missing, "is missing");
    if (e->noise != NULL && e->noise_image.path != NULL) {
        return sheard_rpc_fail_parameter(error, SHEARD_RPC_BAD_PARAMETER, "exposure.noise",
                                         "give \"noise\" or \"noise_image\"",
                                         "contradicts 'noise_image'");
    }
    for (int i = 0; i < N_OPTIONS; i++) {
        if (set_option(&unused, e, i, &err) != SHEAR_OK) {
            snprintf(parameter, sizeof parameter, "exposure.%s", options[i].member);
            return sheard_rpc_fail_parameter(error, SHEARD_RPC_BAD_PARAMETER, parameter, NULL, "%s",
                                             err.message);
        }
    }
    return SHEARD_RPC_OK;
}

/* ---- A source as a whole ---- */

/* Check the images of stamps: all are there but the catalog, which may be. */
static int check_images(sheard_msg_image *const parts[SHEAR_N_PARTS], bool any,
                        sheard_rpc_error *error) {
    for (int i = 0; i < SHEAR_PART_CATALOG; i++) {
        if (parts[i]->path == NULL) {
            return bad_source(error, SHEARD_RPC_MISSING_PARAMETER,
                              any ? shear_part_name(i) : "path", "is missing");
        }
    }
    return SHEARD_RPC_OK;
}

/* Check that an exposure has neither images of stamps beside it, nor their layout. */
static int check_alone(const sheard_msg_source *s, bool any, sheard_rpc_error *error) {
    if (any) {
        return bad_source(error, SHEARD_RPC_BAD_PARAMETER, "exposure",
                          "contradicts separate images");
    }
    if (s->stamp_nx != 0 || s->stamp_ny != 0 || s->stamps != 0) {
        return sheard_rpc_fail_parameter(
            error, SHEARD_RPC_BAD_PARAMETER,
            s->stamp_nx != 0   ? "stamp_nx"
            : s->stamp_ny != 0 ? "stamp_ny"
                               : "stamps",
            "the side of an exposure's stamps is \"exposure\": {\"stamp\": N}",
            "contradicts 'exposure'");
    }
    return SHEARD_RPC_OK;
}

static int check_source(const void *message, sheard_rpc_error *error) {
    sheard_msg_source s = *(const sheard_msg_source *)message;
    sheard_msg_image *parts[SHEAR_N_PARTS];
    const bool any = s.galaxy.path != NULL || s.noise.path != NULL || s.psf.path != NULL ||
                     s.catalog.path != NULL;
    sheard_source_parts(&s, parts);
    if (s.path != NULL && (any || is_exposure(&s)))
        return bad_source(error, SHEARD_RPC_BAD_PARAMETER, "path", "contradicts separate images");
    if (is_exposure(&s))
        TRY(check_alone(&s, any, error));
    if (s.path != NULL)
        return SHEARD_RPC_OK;
    TRY(is_exposure(&s) ? check_exposure(&s.exposure, error) : check_images(parts, any, error));
    return check_choices(&s, parts, error);
}
MSG_TABLE(source, check_source);

shear_input sheard_source_input(const sheard_msg_source *source) {
    sheard_msg_source s = *source;
    shear_input input = shear_input_of_file(s.path);
    sheard_msg_image *parts[SHEAR_N_PARTS];
    sheard_source_parts(&s, parts);
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        input.parts[i] = (shear_input_part){parts[i]->path, parts[i]->extname, parts[i]->hdu};
    input.mosaic = (shear_mosaic){(int)(s.stamp_nx != 0 ? s.stamp_nx : s.stamp_ny),
                                  (int)(s.stamp_ny != 0 ? s.stamp_ny : s.stamp_nx), s.stamps};
    for (int i = 0; i < N_OPTIONS && is_exposure(&s); i++)
        (void)set_option(&input.exposure, &s.exposure, i, NULL); /* checked before */
    if (input.parts[SHEAR_PART_NOISE].path != NULL && is_exposure(&s))
        input.exposure.noise = SHEAR_NOISE_IMAGE;
    return input;
}

void sheard_source_set(sheard_msg_source *s, const shear_input *input) {
    sheard_msg_image *parts[SHEAR_N_PARTS];
    s->path = input->path;
    s->stamp_nx = input->mosaic.stamp_nx;
    s->stamp_ny = input->mosaic.stamp_ny;
    s->stamps = input->mosaic.stamps;
    s->exposure.image.path = input->parts[SHEAR_PART_IMAGE].path; /* which decides what is what */
    sheard_source_parts(s, parts);
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        const shear_input_part *from = &input->parts[i];
        *parts[i] = (sheard_msg_image){from->path, from->hdu, from->extname};
    }
    for (int i = 0; i < N_OPTIONS && is_exposure(s); i++) {
        void *member = (char *)&s->exposure + options[i].offset;
        char number[24];
        const char *text = shear_exposure_get(&input->exposure, options[i].option, number);
        const int64_t value = text != NULL && options[i].number ? strtoll(text, NULL, 10) : -1;
        memcpy(member, options[i].number ? (const void *)&value : (const void *)&text,
               options[i].number ? sizeof value : sizeof text);
    }
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
