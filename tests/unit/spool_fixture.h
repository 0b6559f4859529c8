/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A spool in a directory of its own, a loop, and an owner that remembers what it was told. */
#pragma once

#include "test.h"

#include "spool/spool.h"

#include <stdio.h>

enum { FIXTURE_FOUND_MAX = 20000, FIXTURE_NAME = 256, FIXTURE_PATH = 600 };

typedef struct found_file {
    char active_name[FIXTURE_NAME];
    char key[SPOOL_KEY_SIZE];
    char name[FIXTURE_NAME];
    bool again;
} found_file;

typedef struct spool_fixture {
    char root[128];      /* a temporary directory */
    char directory[160]; /* the spool in it */
    uv_loop_t loop;
    spool *spool; /* NULL: closed */
    spool_tuning tuning;
    int64_t room;
    int refusals; /* so many times the owner says no */
    found_file *found;
    int n_found;
    int n_logs[3];  /* messages by level */
    char log[4096]; /* all of them */
} spool_fixture;

/* cmocka's setup and teardown; *state is the fixture. Files settle at once, scans come once in an
 * hour, nothing is removed. */
int fixture_setup(void **state);
int fixture_teardown(void **state);

void fixture_open(spool_fixture *f); /* must succeed */
void fixture_close(spool_fixture *f);

/* Turn the loop until it is so; fails the test after a generous time. */
typedef bool fixture_condition(const spool_fixture *f, const void *argument);
void fixture_run_until(spool_fixture *f, fixture_condition *condition, const void *argument);
void fixture_run_until_found(spool_fixture *f, int n);
void fixture_run_until_scans(spool_fixture *f, int64_t more);
/* Turn the loop until everything that was there at the call has been looked at. */
void fixture_run_for(spool_fixture *f, int64_t ms);

/* Paths: "incoming/a.fits". They fail the test on errors. */
const char *fixture_path(const spool_fixture *f, const char *name); /* valid until the 4th next */
void fixture_write(const spool_fixture *f, const char *name, const char *content);
bool fixture_has(const spool_fixture *f, const char *name);
void fixture_expect(const spool_fixture *f, const char *name, const char *content);
int fixture_count(const spool_fixture *f, const char *folder); /* all but . and .. */
void fixture_end(spool_fixture *f, int found, bool good, const char *report);
const found_file *fixture_find(const spool_fixture *f, const char *name); /* or NULL */
