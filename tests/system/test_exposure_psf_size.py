# SPDX-License-Identifier: GPL-3.0-or-later
"""A PSF that is not as wide as the stars of its exposure, which are in the catalog, but not selected."""
import math
import re
import unittest

from exposures import FWHM, ExposureTest, write
from fitsfile import image, primary, table
from tool import shearctl

HALF_LIGHT = 2.3  # px, of the stars of `shearctl expose`
UNLIKE = re.compile(r"its PSF is (\w+) \(half of its light within ")


class PsfSize(ExposureTest):
    def prepare(self):
        """An exposure whose catalog has 25 stars a chip, and FLUX_RADIUS of all."""
        self.draw("--stars", 30)
        truth = self.truth()
        n = len(truth["RA"])
        size = [HALF_LIGHT * (1 + 0.0003 * (i % 30)) if star else 3.0 + 0.01 * (i % 70)
                for i, star in enumerate(truth["IS_STAR"])]
        write(self.path("exp.cat"), primary() + table("SOURCES", [
            *((name, kind, truth[name]) for name, kind in (("NUMBER", "J"), ("RA", "D"), ("DEC", "D"))),
            ("FLUX_RADIUS", "D", size), *self.ellipses(n)]))

    def psf(self, factor):
        """A round PSF of another width."""
        alpha = factor * 0.5 * FWHM / math.sqrt(2 ** (1 / 3.5) - 1)
        pixels = [(1 + ((i - 32) ** 2 + (j - 32) ** 2) / alpha ** 2) ** -3.5 for j in range(65) for i in range(65)]
        return write(self.path("narrow.fits"), primary() + image("PSF", (65, 65), pixels, -64))

    def told(self, *more, **changed):
        """What measure and validate tell of the PSF, "" for nothing; they must agree."""
        options = [*self.options(**changed), *more]
        answers = [shearctl(command, *options) for command in ("measure", "validate")]
        told = {"".join(set(UNLIKE.findall(answer.out + answer.err))) for answer in answers}
        self.assertEqual(len(told), 1, answers[0].err + answers[1].out)
        return told.pop()

    def test_another_width_is_told(self):
        self.prepare()
        galaxies = ("--select", "FLUX_RADIUS > 2.6")
        self.assertEqual(self.told(*galaxies, psf=self.psf(0.8)), "narrower")
        self.assertEqual(self.told(*galaxies, psf=self.psf(1.3)), "broader")
        self.assertEqual(self.told(*galaxies), "")
        self.assertEqual(self.told(*galaxies, psf=self.psf(1.05)), "")

    def test_without_stars_nothing_is_known(self):
        """All are selected, or the faint are not."""
        self.prepare()
        self.assertEqual(self.told(psf=self.psf(0.8)), "")
        self.assertEqual(self.told("--select", "FLUX_RADIUS > 3.3 || FLUX_RADIUS < 2.6", psf=self.psf(0.8)), "")


if __name__ == "__main__":
    unittest.main()
