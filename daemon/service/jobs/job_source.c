/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/job_source.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int source_check_size(const service *s, int fd, const char *name, shear_error *err) {
    const int64_t most = s->config.reader.max_file_bytes;
    struct stat st;
    if (fd < 0 || fstat(fd, &st) != 0 || st.st_size <= most) {
        return SHEAR_OK;
    }
    return shear_fail(err, SOURCE_E_TOO_LARGE,
                      "split the file, or have [reader] max_file_bytes raised",
                      "%.300s: has %lld bytes, and [reader] max_file_bytes allows %lld", name,
                      (long long)st.st_size, (long long)most);
}

static int open_part(const service *s, const access_peer *peer, const sheard_msg_image *wanted,
                     source_files *files, int i, shear_error *err) {
    sheard_msg_image *const named[] = {&files->named.galaxy, &files->named.noise, &files->named.psf,
                                       &files->named.catalog};
    if (wanted->path == NULL) {
        return SHEAR_OK;
    }
    const int code =
        access_open(s->roots, peer, wanted->path, &files->fds[i], &files->paths[i], err);
    *named[i] = (sheard_msg_image){files->paths[i], wanted->hdu, wanted->extname};
    return code == SHEAR_OK ? source_check_size(s, files->fds[i], files->paths[i], err) : code;
}

int source_files_open(const service *s, const access_peer *peer, const sheard_msg_source *source,
                      source_files *files, int *part, shear_error *err) {
    const sheard_msg_image *const wanted[] = {&source->galaxy, &source->noise, &source->psf,
                                              &source->catalog};
    int code = SHEAR_OK;
    *files = (source_files){.fds = {-1, -1, -1, -1}};
    *part = -1;
    if (source->path != NULL) {
        code = access_open(s->roots, peer, source->path, &files->fds[0], &files->paths[0], err);
        files->named.path = files->paths[0];
        return code == SHEAR_OK ? source_check_size(s, files->fds[0], files->paths[0], err) : code;
    }
    for (int i = 0; i < SHEAR_N_PARTS && code == SHEAR_OK; i++) {
        *part = i;
        code = open_part(s, peer, wanted[i], files, i, err);
    }
    return code;
}

void source_files_deinit(source_files *files) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (files->fds[i] >= 0) {
            close(files->fds[i]);
        }
        free(files->paths[i]);
    }
    *files = (source_files){.fds = {-1, -1, -1, -1}};
}

/* As who asked: with the groups of then; of older jobs these are not known, there it is the user
 * database's word. */
static int peer_of(const store_job *job, access_peer *peer, shear_error *err) {
    return job->groups != NULL ? access_peer_from_text(job->owner, job->gid, job->groups, peer, err)
                               : access_peer_from_user(job->owner, (gid_t)-1, peer, err);
}

static int open_clients(service *s, const store_job *job, source_opened *o, shear_error *err) {
    access_peer peer = {0};
    shear_error missing = {0};
    int part = -1;
    int code = peer_of(job, &peer, err);
    if (code == SHEAR_OK) {
        code = source_files_open(s, &peer, &o->source, &o->files, &part, err);
        o->input = sheard_source_input(&o->files.named);
    }
    access_peer_deinit(&peer);
    /* It was beneath a root when it was accepted, maybe by another name of one that is away. */
    if (code == ACCESS_E_OUTSIDE && access_roots_check(s->roots, &missing) != SHEAR_OK) {
        *err = missing;
        code = ACCESS_E_ROOT;
    }
    if (code != SHEAR_OK) {
        sheard_rpc_error error;
        const int rpc = rpc_from_access(&error, code, err);
        o->name =
            sheard_rpc_code_get(rpc == SHEARD_RPC_NO_SUCH_FILE ? SHEARD_RPC_FILE_VANISHED : rpc)
                ->name;
        o->job_class = code == ACCESS_E_NOT_FOUND || code == ACCESS_E_ROOT || code == SHEAR_E_IO ||
                               code == SHEAR_E_NOMEM
                           ? STORE_TRANSIENT
                           : STORE_DATA;
    }
    return code;
}

/* By the name that its owner gave it: in messages, and where the field is named after it. */
static int open_spooled(service *s, const char *spooled, const char *dropped, source_opened *o,
                        shear_error *err) {
    o->active_name = strdup(spooled);
    o->files.paths[0] = strdup(dropped);
    o->input = shear_input_of_file(o->files.paths[0]);
    o->job_class = STORE_TRANSIENT;
    if (o->active_name == NULL || o->files.paths[0] == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a name");
    }
    if (s->spool == NULL) {
        return shear_fail(err, SHEAR_E_IO, "switch the watch folder on again ([spool] enabled)",
                          "'%s' was dropped into the watch folder, which is switched off", dropped);
    }
    int code = spool_open_file(s->spool, spooled, &o->files.fds[0], err);
    if (code == SHEAR_OK) {
        code = source_check_size(s, o->files.fds[0], o->files.paths[0], err);
    }
    const int rpc = code == SPOOL_GONE           ? SHEARD_RPC_FILE_VANISHED
                    : code == SPOOL_DENIED       ? SHEARD_RPC_NOT_READABLE
                    : code == SPOOL_NOT_REGULAR  ? SHEARD_RPC_NOT_REGULAR
                    : code == SOURCE_E_TOO_LARGE ? SHEARD_RPC_FILE_TOO_LARGE
                                                 : SHEARD_RPC_IO;
    o->name = sheard_rpc_code_get(rpc)->name;
    o->job_class = code == SPOOL_GONE || code == SHEAR_E_IO ? STORE_TRANSIENT : STORE_DATA;
    return code;
}

int source_open_for_job(service *s, const store_job *job, source_opened *o, shear_error *err) {
    sheard_rpc_error error;
    char spooled[SPOOL_NAME_SIZE];
    *o = (source_opened){.files = {.fds = {-1, -1, -1, -1}},
                         .job_class = STORE_DATA,
                         .name = sheard_rpc_code_get(SHEARD_RPC_IO)->name};
    if (sheard_source_parse(&o->source, job->source, &error) != SHEARD_RPC_OK) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "the job's source cannot be read: %s",
                          error.message);
    }
    return spooled_is_own(job) && spooled_name(job, spooled)
               ? open_spooled(s, spooled, job->dropped, o, err)
               : open_clients(s, job, o, err);
}

void source_opened_deinit(source_opened *o) {
    source_files_deinit(&o->files);
    sheard_source_deinit(&o->source);
    free(o->active_name);
    o->active_name = NULL;
}
