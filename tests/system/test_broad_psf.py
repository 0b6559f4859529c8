# SPDX-License-Identifier: GPL-3.0-or-later
"""A PSF that is too broad for one chip of an exposure, or one file of a field, is told by stamps that are sharper."""
import unittest

from exposures import ExposureTest, images, write_images
from fitsfile import Field, gaussian
from tool import INPUT, shearctl


class BroadPsf(ExposureTest):
    def test_one_chip(self):
        """Of four chips with stars among the galaxies, one was seen through a PSF that is a fifth narrower."""
        drawn = "--chips", "4x1", "--stars", 40, "--galaxies", 40, "--star-flux", "100000,200000", "--seed", 3
        self.draw(*drawn, "--fwhm", 3.1, name="sharp")
        options = self.draw(*drawn)
        self.assertEqual(self.measure_one(*options)["warnings"], [])
        good = images(self.path("exp.fits"))
        write_images(self.path("exp.fits"), [good[0], images(self.path("sharp.fits"))[1], *good[2:]])
        warnings = self.measure_one(*options)["warnings"]
        (chip,) = [w for w in warnings if w.startswith("1 of 4 chips, the first CHIP2: ")]
        self.assertIn("bright stamps are sharper than their PSF, which no galaxy is", chip)
        answer = shearctl("validate", "--json", *options)
        self.assertCode(answer, INPUT)
        (verdict,) = answer.json()
        self.assertEqual(verdict["warnings"], warnings)
        chips = verdict["exposure"]["chips"]
        self.assertEqual([c["n_sharp"] > 0 for c in chips], [False, True, False, False])
        for key in ("bright", "sharp"):
            self.assertEqual(sum(c["n_" + key] for c in chips), verdict["resolution"][key])

    def test_one_file(self):
        field = Field(n=40, nx=48, ny=48, name="b")
        good = field.write(self.path("good.fits"))
        field.galaxy[::5] = [gaussian(48, 48, 1000, (2.25, 2.25, 0.0)) for _ in range(8)]
        field.psf = gaussian(48, 48, 1.0, (1.8 ** 2, 1.8 ** 2, 0.0))
        broad = field.write(self.path("broad.fits"))
        warnings = self.measure_one(good, broad)["warnings"]
        self.assertIn("1 of 2 files, the first " + broad + ": 8 of 40 bright stamps", "\n".join(warnings))
        self.assertEqual(self.measure_one(good)["warnings"], [])


if __name__ == "__main__":
    unittest.main()
