#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tests of the house find what they are for: made-up trees and objects that must fail."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import dialect
import house
import links
import repeats
import rooms
import test_links
import test_rooms
import treemap

PLAN = [["floor", "core/include"], ["floor", "core/fits", "core/measure"], ["floor", "protocol/include"],
        ["floor", "protocol"],
        ["floor", "daemon/store"], ["floor", "daemon/service"], ["floor", "client"], ["apart", "client", "daemon"],
        ["outside", "sqlite3.h", "daemon/store"], ["outside", "gsl", "mocks"], ["made", "shear/version.h"],
        ["root", ".", "core", "core/include", "protocol", "protocol/include", "daemon", "client"]]


class Made(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.plan = rooms.House(PLAN)

    def tree(self, files):
        for path, text in files.items():
            (self.root / path).parent.mkdir(parents=True, exist_ok=True)
            (self.root / path).write_text(text, encoding="utf-8")
        return house.Tree(self.root)

    def includes(self, files):
        return rooms.Includes(self.tree(files), self.plan)


class Includes(Made):
    def test_protocol_may_not_see_the_store(self):
        found = self.includes({"daemon/store/store.h": "", "protocol/frame.c": '#include "store/store.h"\n'})
        self.assertEqual(test_rooms.upward(found, self.plan), [("protocol/frame.c", "daemon/store/store.h")])

    def test_downwards_is_fine(self):
        found = self.includes({"core/include/shear/error.h": "", "daemon/store/store.h": '#include "shear/error.h"\n',
                               "daemon/service/jobs.c": '#include "store/store.h"\n// #include "rpc/none.h"\n'})
        self.assertEqual(test_rooms.upward(found, self.plan), [])
        self.assertEqual(test_rooms.unknown(found, self.plan), [])
        self.assertEqual(rooms.private_uses(found), [])

    def test_rooms_of_one_floor_do_not_know_each_other(self):
        found = self.includes({"core/fits/file.h": "", "core/measure/plan.c": '#include "fits/file.h"\n'})
        self.assertEqual(len(test_rooms.upward(found, self.plan)), 1)

    def test_client_and_daemon_stay_apart(self):
        found = self.includes({"daemon/store/store.h": "", "client/main.c": '#include "store/store.h"\n'})
        self.assertEqual(len(test_rooms.upward(found, self.plan)), 1)

    def test_private_headers(self):
        found = self.includes({"core/fits/file.h": "", "daemon/store/internal.h": "",
                               "daemon/service/jobs.c": '#include "store/internal.h"\n#include "fits/file.h"\n',
                               "daemon/store/job.c": '#include "store/internal.h"\n'})
        self.assertEqual(sorted(rooms.private_uses(found)), [("daemon/service/jobs.c", "core/fits/file.h"),
                                                             ("daemon/service/jobs.c", "daemon/store/internal.h")])

    def test_an_include_of_nothing(self):
        found = self.includes({"client/main.c": '#include "nothing.h"\n#include "shear/version.h"\n'})
        self.assertEqual(test_rooms.unknown(found, self.plan), [("client/main.c", "nothing.h")])

    def test_an_include_that_is_not_written_from_the_root(self):
        found = self.includes({"core/fits/file.h": "", "core/fits/a.c": '#include "file.h"\n#include "fits/file.h"\n'})
        self.assertEqual(test_rooms.otherwise_written(found), [("core/fits/a.c", "file.h")])

    def test_outside_libraries(self):
        found = self.includes({"client/main.c": "#include <sqlite3.h>\n#include <gsl/gsl_math.h>\n#include <stdio.h>\n",
                               "daemon/store/sql.c": "#include <sqlite3.h>\n"})
        self.assertEqual(test_rooms.strangers(found, self.plan),
                         [("client/main.c", "sqlite3.h"), ("client/main.c", "gsl/gsl_math.h")])


class Objects(Made):
    """Objects as cc makes them, and a build.ninja that says what is linked of them."""

    def links(self, sources, targets):
        lines = []
        for path, text in sources.items():
            folder, name = os.path.split(path)
            obj = f"{folder}/CMakeFiles/x.dir/{name}.o"
            self.tree({path: text, obj: ""})
            subprocess.run([os.environ.get("CC", "cc"), "-c", self.root / path, "-o", self.root / obj], check=True)
            lines.append(f"build {obj}: C_COMPILER__x {path} || order")
        for target, inputs in targets.items():
            inputs = [i if i.startswith("lib/")
                      else os.path.join(os.path.dirname(i), "CMakeFiles/x.dir", os.path.basename(i)) + ".o"
                      for i in inputs]
            lines.append(f"build {target}: C_LINKER {inputs[0]} $\n  {' '.join(inputs[1:])} | lib/none.a || order")
        self.tree({"build.ninja": "\n".join(lines) + "\n"})
        return links.Links(self.root).uses

    A = "int b(void); int a(void) { return b(); }"
    B = "int a(void); int b(void) { return a(); }"

    def test_a_circle(self):
        uses = self.links({"core/fits/a.c": self.A, "core/fits/b.c": self.B}, {"bin/x": ["core/fits/a.c", "core/fits/b.c"]})
        self.assertEqual(links.circles(uses), [["core/fits/a.c", "core/fits/b.c"]])
        self.assertEqual(links.circles(links.without(uses, {("core/fits/b.c", "core/fits/a.c")})), [])

    def test_a_circle_through_an_archive(self):
        uses = self.links({"core/fits/a.c": self.A, "core/fits/b.c": self.B},
                          {"lib/libb.a": ["core/fits/b.c"], "bin/x": ["core/fits/a.c", "lib/libb.a"]})
        self.assertEqual(len(links.circles(uses)), 1)

    def test_equal_names_of_two_programs_do_not_meet(self):
        uses = self.links({"core/fits/a.c": self.A, "client/b.c": self.B, "daemon/store/b.c": "int b(void) { return 0; }"},
                          {"bin/x": ["core/fits/a.c", "daemon/store/b.c"], "bin/y": ["client/b.c"]})
        self.assertEqual(links.circles(uses), [])
        self.assertEqual(list(uses["core/fits/a.c"]), ["daemon/store/b.c"])

    def test_a_use_of_a_room_above(self):
        uses = self.links({"core/fits/a.c": self.A, "daemon/store/b.c": "int b(void) { return 0; }"},
                          {"bin/x": ["core/fits/a.c", "daemon/store/b.c"]})
        self.assertEqual(test_links.upward(uses, self.plan), [("core/fits/a.c", "daemon/store/b.c")])

    def test_static_names_are_nobodys(self):
        uses = self.links({"core/fits/a.c": "static int b(void) { return 1; } int a(void) { return b(); }",
                           "core/fits/b.c": self.B}, {"bin/x": ["core/fits/a.c", "core/fits/b.c"]})
        self.assertEqual(links.circles(uses), [])


class Dialect(unittest.TestCase):
    def wrong(self, rule, text, path="core/fits/file.c"):
        return [text for _, text in rule(path, text)]

    def test_pointers(self):
        for body in ("if (!p) {", "if (p) {", "if (n && p) {", "while (p && n) {", "return n || !p;", "n = p ? 1 : 0;"):
            self.assertTrue(self.wrong(dialect.pointer_tests, "int f(const char *p, int n) {\n    " + body + "\n}\n"), body)
        for body in ("if (p == NULL) {", "if (!p->done) {", "if (n && *p) {", "if (!p[0]) {", "if (n && p < q) {",
                     "if (!n) {", "n = a * p;", "/* !p */", 'print("!p");'):
            self.assertFalse(self.wrong(dialect.pointer_tests, "int f(const char *p, int n) {\n    " + body + "\n}\n"), body)

    def test_types(self):
        for text in ("struct a {\n    int b;\n};\n", "typedef enum a { B } a;\n", "typedef struct {\n    int b;\n} a;\n",
                     "typedef struct b {\n    int b;\n} a;\n"):
            self.assertTrue(self.wrong(dialect.typedefs, text), text)
        for text in ("typedef struct a {\n    int b;\n} a;\n", "enum a { B };\n", "struct a;\ntypedef struct a a;\n"):
            self.assertFalse(self.wrong(dialect.typedefs, text), text)
        self.assertEqual(dialect.typedefs("", "struct a {\n};\n", dialect.declared_types(["typedef struct a a;"])), [])

    def test_ladders(self):
        rung = "    if (code == SHEAR_OK) {\n        code = g();\n    }\n"
        self.assertEqual(len(self.wrong(dialect.ladders, "int f(void) {\n" + rung * 2 + "}\n")), 2)
        self.assertEqual(self.wrong(dialect.ladders, "int f(void) {\n" + rung + "}\nint g(void) {\n" + rung + "}\n"), [])

    def test_enums(self):
        self.assertEqual(len(self.wrong(dialect.enums_as_ints,
                                        "    int kind; /* enum axis_kind */\n    int code; /* enum shear_code */\n")), 1)

    def test_stale_names(self):
        rule = dialect.stale_names({"a.h"})
        self.assertEqual(rule("", "/* see b/a.h and c.h, <x.h>, cmd_NAME.c */\nint a; // d.c\n"),
                         [(1, "there is no c.h"), (2, "there is no d.c")])

    def test_lengths(self):
        self.assertEqual(self.wrong(dialect.lengths, "\n" * 401), ["file of 401 lines"])
        self.assertEqual(self.wrong(dialect.lengths, "int f(int a,\n      int b) {\n" + "    a++;\n" * 58 + "}\n"),
                         ["function f of 61 lines"])
        self.assertEqual(self.wrong(dialect.lengths, "int f(int a) {\n" + "    a++;\n" * 58 + "}\n"), [])

    def test_lengths_of_python(self):
        self.assertEqual(self.wrong(dialect.python_lengths, "x" * 125 + "\n" + "x" * 126 + "\n"), ["line of 126 columns"])

    def test_functions(self):
        text = ("static const int table[] = {\n    1,\n};\nint declared(int a);\nint f(void) {\n}\n\n"
                "static int *g(int a,\n              int b) {\n    return \"}\";\n}\n")
        self.assertEqual(house.functions_of(text), [("f", 5, 6), ("g", 8, 11)])

    def test_includes(self):
        for text in ('#include <stdio.h>\n\n#include "b/b.h"\n', '#include "b/b.h"\n#include "fits/file.h"\n',
                     '#include "fits/inner.h"\n'):
            self.assertTrue(self.wrong(dialect.include_style, text), text)
        self.assertEqual(self.wrong(dialect.include_style,
                                    '#include "fits/file.h"\n\n#include "b/b.h"\n\n#include <stdio.h>\n'), [])

    def test_words(self):
        words = dialect.Words([["prose", "anew"], ["prose", "is_none"], ["name", "course"]])
        self.assertEqual(words.of_source("", "/* made anew */\nint x; // there is\n/* a\n * is\n * none */\n"),
                         [(1, "anew"), (4, "is_none")])
        self.assertEqual(words.of_source("", 'int course_main; int of_course; int recourse; char *a = "course";\n'),
                         [(1, "course"), (1, "course")])

    def test_code_without_comments(self):
        self.assertEqual(house.code_lines('/* a */\n\nint a; // b\nchar *c = "/* d */"; /* e\n f */\n'), 2)


class Map(Made):
    def test_lines(self):
        tree = self.tree({"base/a.h": "/* SPDX */\n/* a.h: what a is,\n * and more. Not this.\n */\n",
                          "base/a.c": "/* SPDX */\n",
                          "base/b.c": "/* SPDX */\n/* B does: this. */\n",
                          "base/include/base/c.h": "/* SPDX */\n/** @file base/c.h\n * @brief C.\n */",
                          "base/c.c": "/* SPDX */\nint c; /* no head */\n"})
        self.assertEqual(treemap.lines_of(tree, "base"),
                         ["- `a.h,.c` what a is, and more", "- `b.c` B does: this", "- `c.c` C"])
        tree = self.tree({"base/d.c":
                          "/* SPDX */\n/* Weights (eq. (15), e.g. cubic; eqs. (17) too), i.e. of d. Not this. */"})
        self.assertIn("- `d.c` Weights (eq. (15), e.g. cubic; eqs. (17) too), i.e. of d", treemap.lines_of(tree, "base"))
        text = "x\n<!-- files base/include/base -->\nold\n<!-- end -->\ny"
        self.assertEqual(treemap.filled(tree, text), "x\n<!-- files base/include/base -->\n- `c.h` C\n<!-- end -->\ny")


class Repeats(unittest.TestCase):
    BODY = "".join(f"    a{i} = f{i}(b, {i}) {'+*-/%'[i % 5]} {'c' * (i % 3 + 1)};\n" for i in range(8))

    def text(self, name, body):
        return f"int {name}(void) {{\n{body}}}\n"

    def test_the_same_lines(self):
        a = {"a.c": self.text("f", self.BODY), "b.c": self.text("g", "    int x = 1;\n" + self.BODY.replace("    ", "\t"))}
        self.assertEqual([(n, p, q) for n, p, _, q, _ in repeats.runs(a, 6)], [(8, "a.c", "b.c")])
        self.assertEqual(repeats.runs(a, 10), [])

    def test_other_names(self):
        a = {"a.c": self.text("f", self.BODY), "b.c": self.text("g", self.BODY.replace("b", "d"))}
        self.assertEqual(repeats.runs(a, 6), [])
        self.assertEqual(len(repeats.runs(a, 6, True)), 1)

    def test_tables_do_not_count(self):
        table = "    static const row t[] = {\n" + "".join(
            f"        {{{i}, \"{i}\", f{i}}},\n" for i in range(20)) + "    };\n"
        self.assertEqual(repeats.runs({"a.c": self.text("f", table), "b.c": self.text("g", table)}, 6), [])


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    unittest.main()
