#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Documents for those who carry on say the truth: the map lists every file, names are of files that exist, recipes name
just the files that an example of their kind is in, questions of a newcomer have answers in the map."""
import os
import re
import unittest

import house
import treemap

TREE = house.Tree()
MAP = TREE.read("docs/architecture.md")
EVERY = house.run("git", "-C", str(house.ROOT), "ls-files").split() if (house.ROOT / ".git").exists() else TREE.files(
    ".c", ".h", ".md", ".txt", ".py", ".in", ".cmake",
    folders=house.PRODUCT + ("tests", "docs", "man", "cmake", "completions"))
RECIPE = re.compile(r"<!-- recipe (\S+): (.*?) -->\n(.*?)<!-- end -->", re.S)
FORMAT = re.compile(r"`([\w./*{},-]+)`")


def spread(pattern):
    """a/{b,c}.c -> a/b.c, a/c.c; a/b.h,.c -> a/b.h, a/b.c"""
    m = re.search(r"\{([^}]*)\}", pattern)
    if m:
        return [x for part in m.group(1).split(",") for x in spread(pattern[:m.start()] + part + pattern[m.end():])]
    stem, *endings = pattern.split(",")
    return [stem] + [re.sub(r"\.\w+$", "", stem) + ending for ending in endings]


def files_of_recipe(text):
    """The files that the list of a recipe names: `- ` then names in backquotes before the dash."""
    return sorted({name for line in re.findall(r"^\d+\. (.*?)(?: - |$)", text, re.M)
                   for quoted in FORMAT.findall(line) for name in spread(quoted)})


def files_with(pattern):
    """The files of the tree, tests, results and prose aside, in which the example of a recipe appears."""
    expression = re.compile(pattern)
    found = []
    for path in EVERY:
        if re.match(r"tests/|bench/|validation/results/|validation/\w+\.md|[A-Z]+\.md"
                    r"|docs/(architecture|performance|accuracy)", path):
            continue
        try:
            if expression.search(TREE.read(path)) or expression.search(path):
                found.append(path)
        except (UnicodeDecodeError, FileNotFoundError, IsADirectoryError):
            pass
    return sorted(found)


class Docs(house.Case):
    def test_the_map_is_of_this_tree(self):
        self.assertEqual(MAP, treemap.filled(TREE, MAP), "run scripts/map")

    def test_the_map_has_every_folder(self):
        folders = sorted({os.path.dirname(p) for p in TREE.files(".c", ".h")})
        self.assertEqual(folders, sorted(treemap.folders_of(MAP)))

    def test_every_file_says_what_it_is(self):
        self.nothing([(line, 0, "has no comment at its head") for line in re.findall(r"^- `[^`]*`$", MAP, re.M)], "heads")

    def test_names_in_the_text_are_files(self):
        for document in ("docs/architecture.md", "CONTRIBUTING.md"):
            text = treemap.BLOCK.sub("", TREE.read(document))
            for quoted in re.findall(r"`((?:[\w.-]+/)+[\w.{},-]*)`", text):
                if re.match(r"build/|sheard/|shear/|base/\w+\.h|incoming/|active/|done/|failed/", quoted):
                    continue
                for name in spread(quoted):
                    self.assertTrue((house.ROOT / name).exists(), f"{document}: {name}")

    def test_sources_that_documents_speak_of(self):
        names = {os.path.basename(path) for path in EVERY}
        for document in ["README.md", "CONTRIBUTING.md"] + TREE.files(".md", ".in", folders=("docs", "man", "validation")):
            for name in re.findall(r"(?<![\w./<*-])[\w./-]*\w\.[ch]\b(?![\w(])", TREE.read(document)):
                self.assertTrue("NAME" in name or os.path.basename(name) in names, f"{document}: {name}")

    def test_links_are_files(self):
        for document in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "docs/architecture.md", "docs/glossary.md",
                         "docs/accuracy.md", "docs/choosing.md"):
            for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", TREE.read(document)):
                self.assertTrue((house.ROOT / os.path.dirname(document) / target).exists(), f"{document}: {target}")

    def test_lines_of_the_readme(self):
        self.nothing([("README.md", n, "120 columns and more")
                      for n, line in enumerate(TREE.read("README.md").split("\n"), 1)
                      if len(line) >= 120], "columns")

    def test_recipes(self):
        recipes = RECIPE.findall(MAP)
        self.assertEqual([name for name, _, _ in recipes],
                         ["setting", "measure", "method", "interpolation", "experiment", "reader"])
        for name, pattern, text in recipes:
            with self.subTest(name):
                files = files_of_recipe(text)
                self.assertGreater(len(files), 1)
                for path in files:
                    self.assertTrue((house.ROOT / path).is_file(), path)
                if pattern != "-":
                    left_out = set(files_with(pattern)) - set(files)
                    self.assertFalse(left_out, f"files with {pattern} that the recipe does not name")

    def test_questions(self):
        lines = [line for line in TREE.read("tests/house/questions.txt").splitlines() if line and not line.startswith("#")]
        self.assertEqual(len(lines), 2 * 20)
        for question, answer in zip(lines[::2], lines[1::2]):
            path, _, words = answer.strip().partition(" ")
            with self.subTest(question):
                self.assertTrue((house.ROOT / path).is_file(), path)
                block = re.search(rf"<!-- files {os.path.dirname(path)} -->\n(.*?)<!-- end -->", MAP, re.S)
                entry = [line for line in block.group(1).split("\n")
                         if f"`{treemap.stem_of(os.path.basename(path))}." in line]
                self.assertEqual(len(entry), 1)
                self.assertIn(words.strip(), entry[0], "the words by which its line is found")


if __name__ == "__main__":
    unittest.main()
