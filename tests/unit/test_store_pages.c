/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pages: every record once, in order, whatever the filter and the limit, also while records are
 * added. */
#include "store_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { JOBS = 60 };

/* Jobs of two owners and three fields in every state; returns how many. */
static void make_jobs(fixture *f) {
    static const char *const fields[] = {"a", "b", NULL};
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    char content[16];
    for (int i = 0; i < JOBS; i++) {
        int64_t id = 0;
        bool known = false;
        store_spec spec = fx_spec(f, fields[i % 3]);
        spec.owner = 1000 + (uint32_t)(i % 2);
        FX_OK(store_submit(f->s, &spec, 1000, &id, &known, &err));
        if (i % 7 == 0) {
            FX_OK(store_cancel(f->s, id, fx_now(f), &end, &err));
        } else if (i % 7 != 1) {
            /* The oldest one runs, not always this one. */
            int64_t of = 0;
            const int64_t next = fx_next(f);
            snprintf(content, sizeof content, "c%d", i);
            const store_input learned = {"a", content, 16};
            const store_failure failure =
                fx_failure(f, STORE_TRANSIENT, i % 7 == 2 ? STORE_NEVER : INT64_MAX);
            FX_OK(store_set_input(f->s, next, &learned, &of, &err));
            if (i % 7 <= 3) {
                FX_OK(store_fail(f->s, next, &failure, &end, &err));
            } else if (i % 7 <= 5) {
                char *sums = fx_sums((unsigned)i);
                store_finished done;
                const store_work work = {.sums = sums, .now_ms = fx_now(f)};
                FX_OK(store_finish(f->s, next, &work, &done, &err));
                free(sums);
                if (i % 4 == 0)
                    FX_OK(store_retract(f->s, next, &err));
            }
        }
    }
}

static bool passes(const store_job_filter *filter, const store_job *job) {
    return (filter->states == 0 || (filter->states & 1u << job->state) != 0) &&
           (!filter->by_owner || job->owner == filter->owner) &&
           (filter->field == NULL ||
            (job->field != NULL && strcmp(job->field, filter->field) == 0));
}

/* All pages of a filter against a walk over every job. */
static void check_filter(fixture *f, store_job_filter filter, size_t limit) {
    shear_error err = {0};
    store_job_page page = {.more = true};
    int64_t id = JOBS + 1;
    while (page.more) {
        FX_OK(store_jobs(f->s, &filter, limit, &page, &err));
        assert_true(page.n <= limit && (page.n == limit || !page.more));
        for (size_t i = 0; i < page.n; i++) {
            store_job job = {0};
            do {
                store_job_deinit(&job);
                FX_OK(store_job_get(f->s, --id, &job, &err));
            } while (!passes(&filter, &job));
            assert_int_equal(page.jobs[i].id, id);
            assert_int_equal(page.jobs[i].state, job.state);
            assert_string_equal(page.jobs[i].settings, job.settings);
            store_job_deinit(&job);
        }
        filter.before = id;
        const bool more = page.more;
        store_job_page_deinit(&page);
        page.more = more;
    }
    while (--id > 0) {
        store_job job;
        FX_OK(store_job_get(f->s, id, &job, &err));
        assert_false(passes(&filter, &job));
        store_job_deinit(&job);
    }
}

static void every_filter_and_limit_of_jobs(void **state) {
    fixture *f = *state;
    static const size_t limits[] = {1, 7, JOBS, STORE_PAGE_MAX};
    static const char *const fields[] = {NULL, "a", "b", "none"};
    shear_error err = {0};
    store_counts counts;
    make_jobs(f);
    FX_OK(store_count(f->s, &counts, &err));
    for (int i = 0; i < STORE_N_STATES; i++) {
        assert_true(counts.jobs[i] > 0); /* every state is there */
    }
    for (unsigned states = 0; states < 1u << STORE_N_STATES; states += states < 9 ? 1 : 6) {
        for (size_t i = 0; i < 4; i++) {
            for (unsigned owner = 0; owner < 3; owner++) {
                const store_job_filter filter = {states, fields[i], owner > 0,
                                                 owner > 0 ? 999 + owner : 0, 0};
                check_filter(f, filter, limits[(states + i + owner) % 4]);
            }
        }
    }
}

static void a_page_of_jobs_stays_while_jobs_come(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job_page page;
    store_job_filter filter = {0};
    for (int i = 0; i < 10; i++)
        fx_submit(f, "a");
    FX_OK(store_jobs(f->s, &filter, 4, &page, &err));
    assert_int_equal(page.jobs[3].id, 7);
    filter.before = page.jobs[3].id;
    store_job_page_deinit(&page);
    fx_submit(f, "a");
    fx_next(f);
    FX_OK(store_jobs(f->s, &filter, 4, &page, &err));
    assert_int_equal(page.n, 4);
    assert_int_equal(page.jobs[0].id, 6);
    assert_int_equal(page.jobs[3].id, 3);
    assert_true(page.more);
    store_job_page_deinit(&page);
}

static void limits_are_limited(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job_page page;
    store_field_page fields;
    const store_job_filter all = {0};
    const store_field_filter every = {0};
    FX_OK(store_begin(f->s, &err));
    for (int i = 0; i < STORE_PAGE_MAX + 1; i++)
        fx_submit(f, "a");
    FX_OK(store_commit(f->s, &err));
    FX_OK(store_jobs(f->s, &all, 1000000, &page, &err));
    assert_int_equal(page.n, STORE_PAGE_MAX);
    assert_true(page.more);
    store_job_page_deinit(&page);
    FX_OK(store_jobs(f->s, &all, 0, &page, &err));
    assert_int_equal(page.n, 0);
    assert_true(page.more);
    store_job_page_deinit(&page);
    FX_OK(store_fields(f->s, &every, 10, &fields, &err));
    assert_int_equal(fields.n, 0);
    assert_false(fields.more);
    store_field_page_deinit(&fields);
}

static const char *const names[] = {"A", "a", "a b", "a%", "a_", "ab", "b", "ba", "z~"};
enum { NAMES = sizeof names / sizeof names[0] };

static void make_fields(fixture *f) {
    for (int i = NAMES - 1; i >= 0; i--)
        fx_done(f, names[i], "c", (unsigned)i);
}

static void check_fields(fixture *f, const char *prefix, size_t limit) {
    shear_error err = {0};
    store_field_page page = {.more = true};
    store_field_filter filter = {.prefix = prefix};
    char after[STORE_FIELD_MAX + 1] = "";
    int at = 0;
    while (page.more) {
        FX_OK(store_fields(f->s, &filter, limit, &page, &err));
        for (size_t i = 0; i < page.n; i++) {
            while (strncmp(names[at], prefix, strlen(prefix)) != 0)
                at++;
            char *sums = fx_sums((unsigned)at);
            assert_string_equal(page.fields[i].name, names[at++]);
            assert_string_equal(page.fields[i].sums, sums);
            free(sums);
        }
        assert_true(page.n == limit || !page.more);
        if (page.n > 0) {
            snprintf(after, sizeof after, "%s", page.fields[page.n - 1].name);
            filter.after_name = after;
            filter.after_digest = "d0";
        }
        const bool more = page.more;
        store_field_page_deinit(&page);
        page.more = more;
    }
    while (at < NAMES)
        assert_int_not_equal(strncmp(names[at++], prefix, strlen(prefix)), 0);
}

/* The letters of SQL's patterns mean themselves; lower and upper case differ. */
static void every_prefix_and_limit_of_fields(void **state) {
    static const char *const prefixes[] = {"", "a", "A", "a%", "a_", "b", "bb", "z", "zz", "0"};
    fixture *f = *state;
    make_fields(f);
    for (size_t i = 0; i < sizeof prefixes / sizeof prefixes[0]; i++) {
        for (size_t limit = 1; limit < NAMES + 2; limit++)
            check_fields(f, prefixes[i], limit);
    }
}

static void a_page_of_fields_stays_while_fields_come(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_field_page page;
    const store_field_filter filter = {"a", "a b", "d0"};
    make_fields(f);
    fx_done(f, "a a", "c", 1); /* before the cursor: must not show */
    fx_done(f, "aa", "c", 1);  /* behind it: must */
    FX_OK(store_fields(f->s, &filter, 3, &page, &err));
    assert_int_equal(page.n, 3);
    assert_string_equal(page.fields[0].name, "a%");
    assert_string_equal(page.fields[1].name, "a_");
    assert_string_equal(page.fields[2].name, "aa");
    assert_true(page.more);
    store_field_page_deinit(&page);
}

/* A name with two sets of settings may lie across the end of a page. */
static void a_page_may_end_within_a_name(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_field_page page;
    int64_t id = 0;
    int64_t of = 0;
    bool known = false;
    store_finished end;
    fx_done(f, "a", "c", 1);
    fx_done(f, "b", "c", 1);
    store_spec spec = fx_spec(f, "a");
    spec.settings = "{1}";
    spec.settings_digest = "d1";
    FX_OK(store_submit(f->s, &spec, 10, &id, &known, &err));
    fx_next(f);
    const store_input learned = {"a", "c", 16};
    FX_OK(store_set_input(f->s, id, &learned, &of, &err));
    char *sums = fx_sums(9);
    const store_work work = {.sums = sums, .now_ms = fx_now(f)};
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    free(sums);
    const store_field_filter filter = {NULL, "a", "d0"};
    FX_OK(store_fields(f->s, &filter, 1, &page, &err));
    assert_int_equal(page.n, 1);
    assert_string_equal(page.fields[0].name, "a");
    assert_string_equal(page.fields[0].settings_digest, "d1");
    assert_true(page.more);
    store_field_page_deinit(&page);
}

static void contributions_in_the_order_of_counting(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_contribution_page page;
    store_finished end;
    char *sums = fx_sums(4);
    const int64_t late = fx_running(f, "a", "late");
    const int64_t first = fx_done(f, "a", "c1", 1);
    fx_done(f, "other", "c1", 1);
    const int64_t second = fx_done(f, "a", "c2", 2);
    FX_OK(store_contributions(f->s, "a", "d0", 0, 1, &page, &err));
    assert_int_equal(page.n, 1);
    assert_true(page.more);
    assert_int_equal(page.items[0].job, first);
    const int64_t after = page.items[0].id;
    store_contribution_page_deinit(&page);
    const store_work work = {.sums = sums, .now_ms = fx_now(f)};
    FX_OK(store_finish(f->s, late, &work, &end, &err)); /* an older job, counted later */
    FX_OK(store_contributions(f->s, "a", "d0", after, 2, &page, &err));
    assert_int_equal(page.n, 2);
    assert_false(page.more);
    assert_int_equal(page.items[0].job, second);
    assert_int_equal(page.items[1].job, late);
    assert_string_equal(page.items[1].content, "late");
    assert_int_equal(page.items[1].n_stamps, 16);
    assert_int_equal(page.items[1].n_used, 15);
    assert_int_equal(page.items[1].counted_ms, f->now);
    store_contribution_page_deinit(&page);
    FX_CODE(STORE_NOT_FOUND, store_contributions(f->s, "a", "d1", 0, 9, &page, &err));
    FX_CODE(STORE_NOT_FOUND, store_contributions(f->s, "none", "d0", 0, 9, &page, &err));
    assert_int_equal(page.n, 0);
    free(sums);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(every_filter_and_limit_of_jobs),
        STORE_TEST(a_page_of_jobs_stays_while_jobs_come),
        STORE_TEST(limits_are_limited),
        STORE_TEST(every_prefix_and_limit_of_fields),
        STORE_TEST(a_page_of_fields_stays_while_fields_come),
        STORE_TEST(a_page_may_end_within_a_name),
        STORE_TEST(contributions_in_the_order_of_counting),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
