/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run_program.h: another program's output. */
#ifndef CLIENT_DOCTOR_RUN_PROGRAM_H
#define CLIENT_DOCTOR_RUN_PROGRAM_H

/* Run argv[0] (an absolute path; the list ends with NULL) and collect what it writes to standard
 * output and error, up to 1 MiB, in *text (malloc'd, the caller's). Returns its exit code; -1 where
 * it could not be run, was killed, or took longer than 10 s; *text may be NULL then. */
int run_program(const char *const argv[], char **text);

/* The path of `name`: beside this program, in ../sbin of it, or in PATH and the directories of
 * system programs. malloc'd; NULL: not found. */
char *run_program_find(const char *name);

#endif
