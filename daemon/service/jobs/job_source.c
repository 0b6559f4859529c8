/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/jobs/job_source.h"

#include "base/cleanup.h"
#include "service/core/parts.h"
#include "service/jobs/rpc_errors.h"
#include "service/jobs/spooled_file.h"

#include <string.h>
#include <sys/stat.h>

/* ---- a client's files ---- */

int source_files_check_size(const service *s, int fd, const char *name, shear_error *err) {
    const int64_t most = s->config.reader.max_file_bytes;
    struct stat st;
    if (fd < 0 || fstat(fd, &st) != 0 || st.st_size <= most)
        return SHEAR_OK;
    return shear_fail(err, JOB_SOURCE_E_TOO_LARGE,
                      "split the file, or have [reader] max_file_bytes raised",
                      "%.300s: has %lld bytes, and [reader] max_file_bytes allows %lld", name,
                      (long long)st.st_size, (long long)most);
}

static int open_file(const service *s, const access_peer *peer, const char *path,
                     source_files *files, int i, shear_error *err) {
    TRY(access_open(s->permissions.roots, peer, path, &files->fds[i], &files->paths[i], err));
    return source_files_check_size(s, files->fds[i], files->paths[i], err);
}

int source_files_open(const service *s, const access_peer *peer, const sheard_msg_source *source,
                      source_files *files, shear_error *err) {
    sheard_msg_image *named[SHEAR_N_PARTS];
    *files = (source_files)SOURCE_FILES_NONE;
    files->part = -1;
    files->named = *source;
    if (source->path != NULL) {
        TRY(open_file(s, peer, source->path, files, 0, err));
        files->named.path = files->paths[0];
        return SHEAR_OK;
    }
    sheard_source_parts(&files->named, named);
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        files->part = i;
        if (named[i]->path == NULL)
            continue;
        TRY(open_file(s, peer, named[i]->path, files, i, err));
        named[i]->path = files->paths[i];
    }
    return SHEAR_OK;
}

void source_files_deinit(source_files *files) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        release_fd(&files->fds[i]);
        free(files->paths[i]);
    }
    *files = (source_files)SOURCE_FILES_NONE;
}

/* ---- a job's ---- */

/* Get the submitter, with the groups of that time. Jobs of older versions have none stored:
 * those get the groups in the user database. */
static int peer_of(const store_job *job, access_peer *peer, shear_error *err) {
    return job->groups != NULL ? access_peer_from_text(job->owner, job->gid, job->groups, peer, err)
                               : access_peer_from_user(job->owner, (gid_t)-1, peer, err);
}

/* Open the files for the job's owner. */
static int open_clients(const service *s, const store_job *job, job_source *o, shear_error *err) {
    CLEANUP(access_peer_deinit) access_peer peer = {0};
    shear_error missing = {0};
    TRY(peer_of(job, &peer, err));
    const int code = source_files_open(s, &peer, &o->source, &o->files, err);
    o->input = sheard_source_input(&o->files.named);
    /* The path was beneath a root when it was accepted, perhaps by another name of a root that is
     * missing now. */
    if (code == ACCESS_E_OUTSIDE &&
        access_roots_check(s->permissions.roots, &missing) != SHEAR_OK) {
        *err = missing;
        return ACCESS_E_ROOT;
    }
    return code;
}

/* Open a file of the watch folder. Its name is the one that its owner gave it, in messages and as
 * the field's default name. */
static int open_spooled(const service *s, const store_job *job, const char *active_name,
                        job_source *o, shear_error *err) {
    o->files.paths[0] = strdup(job->dropped);
    if (o->files.paths[0] == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a name");
    o->input = shear_input_of_file(o->files.paths[0]);
    if (s->spool == NULL)
        return spooled_file_fail_switched_off(job, err);
    TRY(spool_open_file(s->spool, active_name, &o->files.fds[0], err));
    return source_files_check_size(s, o->files.fds[0], o->files.paths[0], err);
}

/* Open the job's files, and set o->rpc. */
static int open_files(const service *s, const store_job *job, job_source *o, shear_error *err) {
    sheard_rpc_error error;
    char active_name[SPOOL_NAME_SIZE];
    o->rpc = SHEARD_RPC_IO;
    if (sheard_source_parse(&o->source, job->source, &error) != SHEARD_RPC_OK) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL, "the job's source cannot be read: %s",
                          error.message);
    }
    if (!spooled_file_is_field(job) || !spooled_file_name(job, active_name)) {
        const int code = open_clients(s, job, o, err);
        o->rpc = rpc_error_from_access(&error, code, err);
        return code;
    }
    const int code = open_spooled(s, job, active_name, o, err);
    o->rpc = rpc_error_from_spool(&error, code, err);
    o->rpc = o->rpc == SHEARD_RPC_NO_SUCH_FILE ? SHEARD_RPC_FILE_VANISHED : o->rpc;
    return code;
}

int job_source_open(const service *s, const store_job *job, job_source *o, shear_error *err) {
    *o = (job_source){.files = SOURCE_FILES_NONE};
    const int code = open_files(s, job, o, err);
    if (code == SHEAR_OK)
        return SHEAR_OK;
    const int rpc = o->rpc == SHEARD_RPC_NO_SUCH_FILE ? SHEARD_RPC_FILE_VANISHED : o->rpc;
    const bool may_pass = rpc == SHEARD_RPC_FILE_VANISHED || rpc == SHEARD_RPC_ROOT_MISSING ||
                          code == SHEAR_E_IO || code == SHEAR_E_NOMEM;
    o->reason =
        (failure_reason){may_pass ? STORE_TRANSIENT : STORE_DATA, sheard_rpc_code_get(rpc)->name};
    return code;
}

void job_source_deinit(job_source *o) {
    source_files_deinit(&o->files);
    sheard_source_deinit(&o->source);
}
