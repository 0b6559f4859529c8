#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""libshear for programs of others: its headers, and examples/ built against an installation that was moved, by pkg-config
and by CMake's find_package. BUILD is the build directory, CMAKE the program."""
import gzip
import os
import re
import shutil
import tempfile
import unittest

from install import BUILD, CMAKE, files_of, installed_and_moved, run
from tool import SANITIZED, shearctl

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
EXAMPLES = ("arrays", "file", "streaming")
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]


def compilers(*names):
    return [name for name in names if shutil.which(name)]


def needs(*programs):
    missing = [name for name in programs if not shutil.which(name)]
    return unittest.skipIf(missing, f"not installed: {missing}")


class Installation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.directory = directory.name
        cls.prefix = installed_and_moved(directory.name)
        cls.files = sorted(files_of(cls.prefix))
        cls.lib = os.path.join(cls.prefix, os.path.dirname(next(f for f in cls.files if f.endswith("/libshear.so"))))
        cls.headers = [f[len("include/"):] for f in cls.files if f.startswith("include/")]

    def path(self, *names):
        return os.path.join(self.directory, *names)

    def compile(self, compiler, standard, source, *more):
        return run(compiler, f"-std={standard}", *WARNINGS, "-I", os.path.join(self.prefix, "include"), *more, source)


class Headers(Installation):
    """Each alone, for every language that it is meant for."""

    def compile_alone(self, compiler, standard, suffix):
        for header in self.headers:
            source = self.path("alone" + suffix)
            with open(source, "w", encoding="utf-8") as file:
                file.write(f"#include <{header}>\n#include <{header}>\nint alone;\n")
            self.compile(compiler, standard, source, "-fsyntax-only")

    def test_all_are_installed(self):
        self.assertIn("shear.h", self.headers)
        with open(os.path.join(self.prefix, "include/shear.h"), encoding="utf-8") as file:
            included = set(re.findall(r'#include "(\S+)"', file.read()))
        self.assertEqual(included, set(self.headers) - {"shear.h"}, "shear.h includes all the others")

    def test_as_c(self):
        for compiler in compilers("gcc", "clang-14"):
            for standard in ("c99", "c17"):
                self.compile_alone(compiler, standard, ".c")

    def test_as_cpp(self):
        for compiler in compilers("g++", "clang++-14"):
            for standard in ("c++11", "c++20"):
                self.compile_alone(compiler, standard, ".cpp")

    def declared(self):
        names = set()
        for header in self.headers:
            with open(os.path.join(self.prefix, "include", header), encoding="utf-8") as file:
                text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
            names.update(re.findall(r"^(?!static)\w[\w *]*?\b(\w+)\(", text, re.M))
        return names

    @unittest.skipIf(SANITIZED, "a sanitizer has symbols of its own")
    @needs("nm")
    def test_the_library_has_what_they_declare_and_nothing_else(self):
        symbols = run("nm", "-D", "--defined-only", os.path.join(self.lib, "libshear.so"))
        self.assertEqual(set(re.findall(r" [A-Z] (\w+)", symbols)), self.declared())

    def test_names_are_the_librarys(self):
        for header in self.headers:
            with open(os.path.join(self.prefix, "include", header), encoding="utf-8") as file:
                text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
            if header == "shear/linkage.h":
                self.assertIn('#define SHEAR_BEGIN_C extern "C" {', text)
            elif header != "shear.h":
                self.assertRegex(text, r"(?s)\nSHEAR_BEGIN_C\n.*\nSHEAR_END_C\n", header)
            for name in re.findall(r"^#define (\w+)|^\w[\w *]*?\b(\w+)\(", text, re.M):
                self.assertRegex("".join(name), "^(SHEAR|shear)_", header)


@needs("doxygen")
class Reference(Installation):
    """Pages of section 3 and HTML, made from the headers."""

    def test_every_symbol_has_a_page(self):
        for header in self.headers:
            with open(os.path.join(self.prefix, "include", header), encoding="utf-8") as file:
                text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
            for name in re.findall(r"^\w[\w *]*?\b(\w+)\(", text, re.M) + re.findall(r"^} (\w+);", text, re.M):
                self.assertIn(f"share/man/man3/{name}.3.gz", self.files)

    def test_pages_are_the_librarys(self):
        for name in self.files:
            if "/man3/" in name:
                self.assertRegex(os.path.basename(name), r"^(shear[-_]|SHEAR_|libshear\.3)")
                with gzip.open(os.path.join(self.prefix, name), "rt", encoding="utf-8") as file:
                    text = file.read()
                linked = re.fullmatch(r"\.so (man3/\S+)\n", text)
                if linked:
                    self.assertIn(f"share/man/{linked[1]}.gz", self.files)
                else:
                    self.assertRegex(text, r'^\.TH "\S+" 3 "\w+ \d+, \d+" "libshear \S+" "libshear"\n')

    def test_pages_have_no_scripts(self):
        pages = [name for name in self.files if "/libshear-dev/html/" in name]
        self.assertIn("share/doc/libshear-dev/html/index.html", pages)
        self.assertFalse([name for name in pages if name.endswith(".js")])

    def test_a_symbol_without_documentation_is_an_error(self):
        header = self.path("undocumented.h")
        for text, code in ("/** Nothing. */\nint documented(void);\n", 0), ("int undocumented(void);\n", 1):
            with open(header, "w", encoding="utf-8") as file:
                file.write("/** @file\n * A header. */\n" + text)
            with open(os.path.join(BUILD, "reference", "Doxyfile"), encoding="utf-8") as file:
                options = file.read() + f"\nINPUT = {header}\nOUTPUT_DIRECTORY = {self.path('reference')}\n"
            run("doxygen", "-", code=code, input=options)


@unittest.skipIf(SANITIZED, "the library wants its sanitizer's runtime")
class Linked(Installation):
    """Programs that know nothing but where the library is."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mock = os.path.join(cls.directory, "mock.fits")
        answer = shearctl("mock", "--stamps", "40", "--size", "48", "--seed", "5", cls.mock)
        assert answer.code == 0, answer.err
        cls.measured = shearctl("measure", "--json", "--quiet", cls.mock).json()[0]

    def run_program(self, program, *args):
        return run(program, *args, env={**os.environ, "LD_LIBRARY_PATH": self.lib})

    def expect_right(self, program):
        """`program` gives the path of an example by its name."""
        number = r"g1 = (\S+) .*\ng2 = (\S+) "
        for name in ("file", "streaming"):
            told = re.match(number, self.run_program(program(name), self.mock))
            self.assertEqual([float(g) for g in told.groups()], [self.measured["g1"], self.measured["g2"]], name)
        lines = re.findall(r"(\S+) \+- (\S+), true (\S+)", self.run_program(program("arrays")))
        self.assertEqual(len(lines), 2)
        for g, error, truth in lines:
            self.assertLess(abs(float(g) - float(truth)), 4 * float(error))

    def flags(self):
        return run("pkg-config", "--cflags", "--libs", "libshear", env={
            **os.environ, "PKG_CONFIG_PATH": os.path.join(self.lib, "pkgconfig")}).split()

    @needs("pkg-config", "gcc")
    def test_pkg_config(self):
        flags = self.flags()
        self.assertIn("-lshear", flags)
        self.assertTrue(os.path.samefile(next(f[2:] for f in flags if f.startswith("-L")), self.lib))
        for name in EXAMPLES:
            run("gcc", *WARNINGS, "-o", self.path(name), os.path.join(ROOT, "examples", name + ".c"), *flags, "-lm")
        self.expect_right(self.path)

    @needs("pkg-config", "g++")
    def test_cpp(self):
        source = os.path.join(ROOT, "tests", "system", "link.cpp")
        run("g++", "-std=c++11", *WARNINGS, "-Wno-missing-field-initializers", "-o", self.path("cpp"), source, *self.flags())
        self.assertRegex(self.run_program(self.path("cpp")), r"^\d+\.\d+\.\d+\n$")

    def test_cmake(self):
        build = self.path("build")
        run(CMAKE, "-S", os.path.join(ROOT, "examples"), "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        run(CMAKE, "--build", build)
        self.expect_right(lambda name: os.path.join(build, "example_" + name))

    def test_cmake_asks_for_the_version(self):
        with open(self.path("CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write("cmake_minimum_required(VERSION 3.25)\nproject(x LANGUAGES C)\nfind_package(shear 99 REQUIRED)\n")
        self.assertIn("99", run(CMAKE, "-S", self.directory, "-B", self.path("other"),
                                f"-DCMAKE_PREFIX_PATH={self.prefix}", code=1))

    def test_nothing_of_the_build_is_in_it(self):
        for name in self.files:
            if "/cmake/shear/" in name or name.endswith(".pc"):
                with open(os.path.join(self.prefix, name), encoding="utf-8") as file:
                    text = file.read()
                for place in (BUILD, ROOT, self.prefix, os.path.join(self.directory, "first"), "/usr/"):
                    self.assertNotIn(place, text, name)


if __name__ == "__main__":
    unittest.main()
