/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run_program.h: run another program and collect its output. */
#pragma once

/* Run argv[0] (an absolute path; the list ends with NULL) and collect its standard output and
 * error, up to 1 MiB, in *text (malloc'd, to be freed by the caller). Returns its exit code; -1 if
 * it could not be run, was killed, or took longer than 10 s. *text may be NULL then. */
int run_program(const char *const argv[], char **text);

/* Return the path of `name`, malloc'd: beside this program, in ../sbin, in PATH, or in the
 * directories of system programs. NULL if it is not found. */
char *run_program_find(const char *name);
