# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl's command line: subcommands, help, version, and errors about wrong options."""
import os
import re
import subprocess
import unittest

from fitsfile import Field
from tool import DONE, OTHER, SANITIZED, SHEARCTL, USAGE, ToolTest, shearctl

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SUBCOMMANDS = ["measure", "mock", "expose", "validate", "plot", "help", "version"]


class Front(ToolTest):
    def test_alone_and_help_list_the_subcommands(self):
        for args in ([], ["--help"], ["-h"], ["help"]):
            answer = shearctl(*args)
            self.assertCode(answer, DONE)
            self.assertEqual(answer.err, "")
            for name in SUBCOMMANDS:
                self.assertRegex(answer.out, rf"(?m)^  {name} ")

    def test_help_of_each_subcommand(self):
        for name in SUBCOMMANDS:
            by_help, by_option = shearctl("help", name), shearctl(name, "--help")
            self.assertCode(by_help, DONE)
            self.assertTrue(by_help.out.startswith(f"usage: shearctl {name}"), by_help.out)
            self.assertEqual(by_help.out, by_option.out)
            self.assertNotIn("@", by_help.out)

    def test_help_has_every_setting_with_its_default(self):
        text = shearctl("help", "measure").out
        for flag in ("--interpolation METHOD", "--oversample S", "--beta PX", "--beta-ratio X",
                     "--filter KIND", "--core PX", "--width PX", "--zeros POLICY",
                     "--pedestal VALUE", "--psf-threshold X", "--no-noise-correction",
                     "--noise-level KIND", "--shot-noise KIND"):
            self.assertIn(flag, text)
        self.assertIn("(default 1.4 px)", " ".join(text.split()))
        self.assertLessEqual(max(map(len, text.splitlines())), 100)

    def test_version(self):
        by_option, by_name = shearctl("--version"), shearctl("version")
        self.assertCode(by_option, DONE)
        self.assertEqual(by_option.out, by_name.out)
        self.assertRegex(by_option.out, r"^shearctl \d+\.\d+\.\d+\nlibshear +\d+\.\d+\.\d+\n")
        for library in ("fftw", "cfitsio", "jansson"):
            self.assertRegex(by_option.out, rf"(?m)^{library} +\d")

    def test_unknown_subcommand_names_the_nearest(self):
        for given, meant in (("mesure", "measure"), ("valdate", "validate"), ("plots", "plot")):
            self.assertFails(shearctl(given), USAGE, f'"{given}"', f'"shearctl {meant}"')
        far = shearctl("frobnicate")
        self.assertFails(far, USAGE, "frobnicate")
        self.assertNotIn("did you mean", far.err)
        self.assertFails(shearctl("help", "mesure"), USAGE, "measure")

    @unittest.skipUnless(os.path.exists("/dev/full"), "needs /dev/full")
    def test_a_full_standard_output_is_an_error(self):
        with open("/dev/full", "w", encoding="ascii") as full:
            process = subprocess.run([SHEARCTL, "help"], stdout=full, stderr=subprocess.PIPE,
                                     text=True, check=False)
        self.assertEqual(process.returncode, OTHER)
        self.assertIn("standard output", process.stderr)


class Options(ToolTest):
    def test_usage_errors(self):
        cases = [
            (["measure"], "which files"),
            (["validate"], "which files"),
            (["measure", "--beta-ration", "2", "x"], "--beta-ratio"),
            (["measure", "--frobnicate", "x"], "unknown option --frobnicate"),
            (["measure", "-q", "x"], "-q"),
            (["measure", "--be", "2", "x"], "ambiguous"),
            (["measure", "x", "--beta"], "--beta needs a value"),
            (["measure", "--json=yes", "x"], "--json takes no value"),
            (["measure", "--beta", "wide", "x"], "beta"),
            (["measure", "--beta", "-1", "x"], "beta"),
            (["measure", "--beta", "nan", "x"], "beta"),
            (["measure", "--oversample", "3", "x"], "oversample"),
            (["measure", "--interpolation", "cubic", "x"], "log-bicubic"),
            (["measure", "--filter", "none", "--core", "20", "x"], "core"),
            (["measure", "--interpolation", "none", "--pedestal", "3", "x"], "pedestal"),
            (["measure", "--interpolation", "none", "--oversample", "4", "x"], "oversample"),
            (["measure", "--threads", "0", "x"], "--threads"),
            (["measure", "--threads", "2x", "x"], "--threads"),
            (["measure", "--threads", "99999999999999999999", "x"], "--threads"),
            (["measure", "--jackknife", "1", "x"], "--jackknife"),
            (["measure", "--field", "", "x"], "--field"),
            (["validate", "--threads", "2", "x"], "unknown option --threads"),
            (["validate", "--filter", "none", "--core", "20", "x"], "core"),
            (["version", "now"], "version"),
            (["help", "a", "b"], "help"),
        ]
        for args, word in cases:
            with self.subTest(args=args):
                answer = shearctl(*args)
                self.assertFails(answer, USAGE, word)
                self.assertEqual(answer.out, "")

    def test_options_may_follow_files_be_shortened_and_negated(self):
        path = Field(n=4).write(self.path("a.fits"))
        result = self.measure_one(path, "--interp", "bilinear", "--oversample=4",
                                  "--no-noise-correction")
        self.assertEqual(result["settings"]["interpolation"], "bilinear")
        self.assertEqual(result["settings"]["oversample"], 4)
        self.assertIs(result["settings"]["noise-correction"], False)
        again = self.measure_one(path, "--no-noise-correction", "--noise-correction")
        self.assertIs(again["settings"]["noise-correction"], True)

    def test_a_preset_lies_beneath_the_others_in_any_order(self):
        path = Field(n=4).write(self.path("a.fits"))
        options = ("--beta-ratio", "3", "--noise-level", "field")
        first, last = (self.measure_one(path, *args)["settings"]
                       for args in (("--preset", "zhang2010", *options), (*options, "--preset", "zhang2010")))
        self.assertEqual(first, last)
        self.assertEqual((last["preset"], last["beta-ratio"], last["noise-level"], last["beta-floor"]),
                         ("zhang2010", 3, "field", 0))

    def test_double_dash_ends_the_options(self):
        Field(n=4).write(self.path("--json"))
        answer = shearctl("measure", "--", "--json", cwd=self.directory)
        self.assertCode(answer, DONE)
        self.assertTrue(answer.out.startswith("field gauss\n"), answer.out)


@unittest.skipIf(SANITIZED, "the same text, ten times slower")
class Readme(ToolTest):
    def test_shows_what_quickstart_prints(self):
        """The lines of the README's example are lines of the output, in this order, for the quickstart's first field."""
        with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
            shown = re.search(r"^```text\n(field plus\n.*?)^```", file.read(), re.M | re.S).group(1).splitlines()
        with open(os.path.join(ROOT, "quickstart"), encoding="utf-8") as file:
            script = file.read()
        galaxies = re.search(r"galaxies=\((.*?)\)", script, re.S).group(1).replace('"$stamps"', "2000").split()
        self.assertIn("\nstamps=2000\n", script)
        plus = self.path("plus.fits")
        self.assertCode(shearctl("mock", plus, "--field", "plus", "--shear", "0.02,-0.03", *galaxies), DONE)
        answer = shearctl("measure", plus, "--jackknife", "50")
        self.assertCode(answer, DONE)
        printed = answer.out.splitlines()
        self.assertEqual([line for line in printed if line in shown], shown)


if __name__ == "__main__":
    unittest.main()
