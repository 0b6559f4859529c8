/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exit_code.h: the exit codes of shearctl, as documented in shearctl(1). */
#pragma once

/* Scripts rely on these numbers. */
enum exit_code {
    EXIT_CODE_DONE = 0,
    EXIT_CODE_OTHER = 1,      /* any other error: out of memory, unwritable output, interrupted */
    EXIT_CODE_USAGE = 2,      /* wrong options or settings */
    EXIT_CODE_INPUT = 3,      /* all input is bad; no such file, job or field */
    EXIT_CODE_PARTLY = 4,     /* some of several files, jobs or names failed, the others are done */
    EXIT_CODE_JOB_FAILED = 5, /* no job is done, and at least one failed */
    EXIT_CODE_TIMED_OUT = 6,  /* jobs are unfinished at the end of --timeout */
    EXIT_CODE_UNREACHABLE = 7, /* no service, no reply, or a service of another version */
    EXIT_CODE_CANCELLED = 8    /* the jobs were cancelled */
};
