#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Logic is written once: no six lines stand twice in the product's functions, nor ten that differ in names only; in the
tests no ten."""
import unittest

import house
import repeats

TREE = house.Tree()
PRODUCT = {path: TREE.read(path) for path in TREE.files(".c", ".h")}
TESTS = {path: TREE.read(path) for path in TREE.files(".c", ".h", folders=("tests",))}


class Repeats(house.Case):
    def test_no_lines_twice(self):
        self.check(PRODUCT, 6, False, "repeated_lines")

    def test_no_shape_twice(self):
        self.check(PRODUCT, 10, True, "repeated_shapes")

    def test_no_lines_twice_in_tests(self):
        self.check(TESTS, 10, False, "repeated_in_tests")

    def check(self, texts, least, shape, rule):
        self.nothing([(a, at, f"{n} lines stand in {b}:{bt}, too") for n, a, at, b, bt in repeats.runs(texts, least, shape)],
                     rule, "repeated" if rule == "repeated_lines" else None)


if __name__ == "__main__":
    unittest.main()
