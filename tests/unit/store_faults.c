/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store_faults.h"
#include "store/database.h"
#include "store_actions.h"
#include "test.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void mix(uint64_t *hash, const void *bytes, size_t n) {
    for (size_t i = 0; i < n; i++)
        *hash = (*hash ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u;
}

static void mix_rows(store *s, const char *sql, uint64_t *hash) {
    sqlite3_stmt *stmt = NULL;
    assert_int_equal(sqlite3_prepare_v2(s->db, sql, -1, &stmt, NULL), SQLITE_OK);
    while (sqlite3_step(stmt) == SQLITE_ROW) {
        for (int i = 0; i < sqlite3_column_count(stmt); i++) {
            const char *text = (const char *)sqlite3_column_text(stmt, i);
            mix(hash, text != NULL ? text : "null", text != NULL ? strlen(text) + 1 : 5);
        }
    }
    assert_int_equal(sqlite3_finalize(stmt), SQLITE_OK);
}

uint64_t said_by(store *s) {
    static const char *const tables[] = {
        "SELECT * FROM jobs ORDER BY id",
        "SELECT * FROM attempts ORDER BY job, number",
        "SELECT * FROM checkpoints ORDER BY job",
        "SELECT * FROM fields ORDER BY id",
        "SELECT * FROM contributions ORDER BY id",
        "SELECT * FROM forgotten ORDER BY id",
        "SELECT * FROM settings ORDER BY digest",
        "SELECT * FROM counts ORDER BY state",
        "SELECT * FROM totals",
        "SELECT * FROM checkpoint_terms ORDER BY job, end_block",
        "SELECT * FROM contribution_terms ORDER BY contribution, part",
        "SELECT * FROM sqlite_sequence",
        "SELECT * FROM sqlite_schema ORDER BY name"};
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
        mix_rows(s, tables[i], &hash);
    return hash;
}

void copy(const char *from, const char *to) {
    char bytes[65536];
    unlink(to); /* some file systems write a file out that replaces another by truncating it */
    FILE *in = fopen(from, "rb");
    FILE *out = fopen(to, "wb");
    assert_true(in != NULL && out != NULL);
    for (size_t n = fread(bytes, 1, sizeof bytes, in); n > 0;
         n = fread(bytes, 1, sizeof bytes, in)) {
        assert_int_equal(fwrite(bytes, 1, n, out), n);
    }
    fclose(in);
    assert_int_equal(fclose(out), 0);
}

static char *with_ending(fixture *f, const char *ending) {
    static char name[400];
    snprintf(name, sizeof name, "%s%s", f->path, ending);
    return name;
}

void begin(fixture *f, int mode) {
    static const char *const endings[] = {"-wal", "-journal", "-wal.synced"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        unlink(with_ending(f, endings[i]));
    copy(with_ending(f, ".empty"), f->path);
    copy(f->path, with_ending(f, ".synced"));
    store_vfs_arm(VFS_SOUND, 0);
    fx_open(f);
    fill(f);
    if (mode == BUSY) {
        assert_int_equal(sqlite3_exec(f->s->db,
                                      "PRAGMA wal_autocheckpoint = 1; PRAGMA cache_size = 4", NULL,
                                      NULL, NULL),
                         SQLITE_OK);
    }
}

uint64_t restart(fixture *f) {
    fx_close(f);
    f->now = REOPEN_MS;
    fx_open(f);
    return said_by(f->s);
}

int meaning_of(enum store_vfs_fault fault) {
    return fault == VFS_FULL ? SHEAR_E_FULL : SHEAR_E_IO;
}

void keep_empty(fixture *f) {
    fx_close(f);
    copy(f->path, with_ending(f, ".empty"));
}
