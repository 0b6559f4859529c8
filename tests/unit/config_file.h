/* SPDX-License-Identifier: GPL-3.0-or-later */
/* config_file.h: configuration files in a temporary directory, and what is wrong with them. */
#pragma once

#include "sheard/config.h"
#include "test.h"

/* cmocka setup and teardown of a group: *state is the directory's path. */
int directory_make(void **state);
int directory_remove(void **state);

/* Write text[size] as file `name` of the directory; its path is in a static buffer. */
const char *file_with_bytes(void **state, const char *name, const char *text, size_t size);
const char *file_with(void **state, const char *text);

/* Defaults + file of this text. */
int load_text_file(void **state, const char *text, sheard_config *config,
                   sheard_problems *problems);

/* All of `file` as a string, malloc'd. */
char *slurp(const char *path);

/* What a print function writes, malloc'd. */
char *printed(const sheard_config *config);

/* Every setting is the same in both. */
void assert_same_config(const sheard_config *a, const sheard_config *b);

/* The i-th problem is an error at `line` of file.conf whose message or advice holds `words`. */
void assert_problem(const sheard_problems *problems, size_t i, int line, const char *words);
