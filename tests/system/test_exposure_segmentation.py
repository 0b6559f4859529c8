# SPDX-License-Identifier: GPL-3.0-or-later
"""A segmentation that is not of the catalog's run: its objects are elsewhere, or too few."""
import unittest

from exposures import ExposureTest, images, write_images
from tool import DONE, shearctl

TOLD = "by the segmentation there is sky where "


class Segmentation(ExposureTest):
    def segmentation(self, shift=0, every=1):
        """Squares of 7 px at the positions of galaxies, or of some, with their numbers as values."""
        truth = self.truth()
        chips = images(self.path("exp.mask.fits"))
        for i, (number, chip, x, y) in enumerate(zip(*(truth[key] for key in ("NUMBER", "CHIP", "X", "Y")))):
            image = chips[chip - 1]
            inside = 5 < x + shift < image.nx - 5 and 5 < y < image.ny - 5
            if inside and i % every == 0:
                image.fill(x + shift, y, number, half=3)
        return write_images(self.path("seg.fits"), chips)

    def told(self, path):
        """How often measure and validate tell; they must agree."""
        options = self.options(segmentation=path)
        answer = shearctl("measure", *options)
        self.assertCode(answer, DONE)
        self.assertEqual(TOLD in answer.err, TOLD in shearctl("validate", *options).out, answer.err)
        return answer.err.count(TOLD)

    def test_is_told(self):
        self.draw()
        self.assertEqual(self.told(self.segmentation()), 0)
        self.assertEqual(self.told(self.segmentation(shift=2)), 0)
        self.assertEqual(self.told(self.segmentation(shift=40)), 2)  # of both chips
        self.assertEqual(self.told(self.segmentation(every=2)), 2)
        self.assertEqual(self.told(None), 0)


if __name__ == "__main__":
    unittest.main()
