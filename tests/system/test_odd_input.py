# SPDX-License-Identifier: GPL-3.0-or-later
"""Odd input that is good, or bad for a reason of its own."""
import math
import os
import unittest

import fitsfile
from fitsfile import Field
from tool import DONE, INPUT, ToolTest, shearctl

# What a file may be called and a field may not.
NAMES = ["x" * 72 + ".fits", "Übung.fits", " blank.fits", "tab\there.fits", "r\u202egnol.fits"]


class DefaultName(ToolTest):
    def test_not_needed_with_field(self):
        for name in NAMES:
            path = Field(n=4, nx=24, ny=24, name=None).write(self.path(name))
            answer = shearctl("measure", "--json", "--field", "mine", path)
            self.assertCode(answer, DONE)
            self.assertEqual(answer.json()[0]["field"], "mine")

    def test_needed_without(self):
        for name in NAMES:
            path = Field(n=4, nx=24, ny=24, name=None).write(self.path(name))
            self.assertFails(shearctl("measure", path), INPUT, "the field's name (from the file's name)",
                             "keyword FIELD")
            verdict = shearctl("validate", path)
            self.assertCode(verdict, INPUT)
            self.assertIn("the field's name", verdict.out)

    def test_catalog_without_a_name(self):
        path = Field(n=4, nx=24, ny=24, name=None).write(self.path("Übung.fits"))
        out = self.path("out.fits")
        self.assertCode(shearctl("measure", "--field", "mine", "--catalog", out, path), DONE)
        self.assertCode(shearctl("plot", out, "--output", self.path("p.pdf")), DONE)


class HduNumbers(ToolTest):
    def test_messages_count_as_options_do(self):
        field = Field(n=4, nx=24, ny=24)
        content = field.content()
        galaxy = dict(fitsfile.hdus(content))["GALAXY"]
        path = self.path("two.fits")
        with open(path, "wb") as f:
            f.write(content + galaxy)
        self.assertFails(shearctl("measure", path), INPUT, "two HDUs (1 and 4, counted from 0)")
        for number in (1, 4):
            answer = shearctl("measure", "--galaxy", f"{path}:{number}", "--noise", f"{path}:2",
                              "--psf", f"{path}:3")
            self.assertCode(answer, DONE)
        self.assertFails(shearctl("measure", "--galaxy", f"{path}:5", "--noise", f"{path}:2",
                                  "--psf", f"{path}:3"),
                         INPUT, "no HDU number 5 (its last is 4)")


class Weights(ToolTest):
    def measured(self, weights):
        field = Field(n=len(weights), nx=24, ny=24, sigma=0.1)
        field.columns = [("WEIGHT", "D", weights)]
        return shearctl("measure", "--json", field.write(self.path("w.fits")))

    def test_too_small(self):
        """Their squares are lost, and with them the errors: no result with an error of nan."""
        self.assertFails(self.measured([1e-300] * 6), INPUT, "0 of 6 stamps are usable")
        (some,) = self.measured([1.0, 2.0, 1e-300, 1.0, 5e-324, 1.0]).json()
        self.assertEqual(some["flags"]["bad_weight"], 2)
        self.assertTrue(math.isfinite(some["g1_err"]) and some["g1_err"] > 0)

    def test_only_ratios_count(self):
        (one,) = self.measured([1.0, 2.0, 3.0, 4.0]).json()
        for scale in (2.0 ** -300, 2.0 ** 100):
            (other,) = self.measured([scale * w for w in (1, 2, 3, 4)]).json()
            self.assertEqual((one["g1"], one["g1_err"]), (other["g1"], other["g1_err"]))

    def test_pixels_too_faint_for_errors(self):
        field = Field(n=6, nx=24, ny=24)
        field.bitpix = -64
        field.galaxy = [[1e-80 * p for p in stamp] for stamp in field.galaxy]
        answer = shearctl("measure", field.write(self.path("faint.fits")))
        self.assertFails(answer, INPUT, "errors of the shear could not be computed")


if __name__ == "__main__":
    unittest.main()
