/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exit_code.h: what shearctl exits with, as in shearctl(1). */
#ifndef CLIENT_TERMINAL_EXIT_CODE_H
#define CLIENT_TERMINAL_EXIT_CODE_H

/* Scripts rely on these numbers. */
enum exit_code {
    EXIT_CODE_DONE = 0,
    EXIT_CODE_OTHER = 1, /* anything that is not below: no memory, unwritable output, interrupted */
    EXIT_CODE_USAGE = 2, /* wrong options or settings */
    EXIT_CODE_INPUT = 3, /* bad input, all of it; no such file, job or field */
    EXIT_CODE_PARTLY = 4,     /* of several files, jobs or names some failed, the others are done */
    EXIT_CODE_JOB_FAILED = 5, /* every job that ended otherwise than done failed, none is done */
    EXIT_CODE_TIMED_OUT = 6,  /* --timeout is over and jobs are unfinished */
    EXIT_CODE_UNREACHABLE = 7, /* no service, it does not answer, or it is another release's */
    EXIT_CODE_CANCELLED = 8    /* the jobs were cancelled */
};

#endif
