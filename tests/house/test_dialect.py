#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The dialect (CONTRIBUTING.md, "Style"): pointers, types, lengths, includes, ladders and words. What is excepted has its
name and its reason in exceptions.txt."""
import pathlib
import re
import unittest

import dialect
import house

TREE = house.Tree()
SOURCES = TREE.sources()
TESTS = TREE.files(".c", ".h", folders=("tests",))
DOCUMENTS = [p for p in ("README.md", "CONTRIBUTING.md", "SECURITY.md") if (TREE.root / p).is_file()] + TREE.files(
    ".md", ".in", folders=("docs", "man", "validation")) + TREE.files(".txt", folders=("client",))  # help of subcommands
PYTHON = [p for p in TREE.files(".py", "", folders=house.PRODUCT + ("tests", "scripts"))
          if p.endswith(".py") or "python" in TREE.read(p).split("\n")[0]]
# Headers that are not this project's.
OUTSIDE = {name.split("/")[-1] for p in SOURCES + TESTS for name in re.findall(r"#include\s*<([^>]+)>", TREE.read(p))}
WORDS = dialect.Words(house.rules("words.txt"))


def found(rule, files):
    return [(path, line, text) for path in files for line, text in rule(path, TREE.read(path))]


class Dialect(house.Case):
    def test_pointers_are_compared_with_NULL(self):
        self.nothing(found(dialect.pointer_tests, SOURCES + TESTS), "pointers")

    def test_types(self):
        declared = dialect.declared_types(map(TREE.read, SOURCES))
        self.nothing(found(lambda path, text: dialect.typedefs(path, text, declared), SOURCES), "types")

    def test_enums_are_of_their_type(self):
        self.nothing(found(dialect.enums_as_ints, SOURCES), "enums")

    def test_comments_name_files_that_are_there(self):
        names = {pathlib.Path(p).name for p in SOURCES + TESTS + TREE.files(".in")} | OUTSIDE
        self.nothing(found(dialect.stale_names(names), SOURCES + TESTS), "stale_names")

    def test_lengths(self):
        self.nothing(found(dialect.lengths, SOURCES), "lengths", "long")

    def test_lengths_of_python(self):
        self.assertIn("scripts/map", PYTHON)
        self.nothing(found(dialect.python_lengths, PYTHON), "python_lengths")

    def test_includes(self):
        self.nothing(found(dialect.include_style, SOURCES), "includes")
        self.nothing([(p, 0, "a private header is called internal.h") for p in SOURCES if p.endswith("/inner.h")], "inner")

    def test_no_ladders(self):
        self.nothing(found(dialect.ladders, SOURCES), "ladders")

    def test_words_of_sources(self):
        self.nothing(found(WORDS.of_source, SOURCES), "words", "word")

    def test_words_of_documents(self):
        self.nothing([(path, line, word) for path in DOCUMENTS for line, word in WORDS.of_prose(TREE.read(path))],
                     "words_of_documents", "word_of_document")


if __name__ == "__main__":
    unittest.main()
