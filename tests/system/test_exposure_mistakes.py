# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposures that are given by mistake in a way that could pass without a word, or with the wrong one."""
import unittest

from exposures import ExposureTest, write
from fitsfile import image, primary, table
from tool import DONE, INPUT, shearctl


class Meds(ExposureTest):
    """Multi-epoch cut-outs look like a catalog with images of one axis."""

    def meds(self, *names):
        content = primary()
        for name in names:
            content += image(name, (64,), [1.0] * 64) if name.lower().endswith("cutouts") else \
                table(name, [("id", "K", [1, 2]), ("ra", "D", [150.1, 150.1]), ("dec", "D", [2.2, 2.2])])
        return write(self.path("many.fits"), content)

    def test_is_told(self):
        self.draw()
        for names in (("object_data", "image_info", "metadata", "image_cutouts", "weight_cutouts"),
                      ("IMAGE_CUTOUTS", "IMAGE_INFO", "OBJECT_DATA")):
            path = self.meds(*names)
            for given in ([path], ["--galaxy", path, "--noise", path, "--psf", self.path("psf.fits")],
                          *(self.options(**{part: path}) for part in ("image", "weight", "mask", "segmentation", "psf"))):
                self.assertFails(shearctl("measure", *given), INPUT, "many.fits", "is a MEDS file", "image_cutouts",
                                 "advice: give the exposures")
            answer = shearctl("validate", path)
            self.assertEqual(answer.code, INPUT)
            self.assertIn("is a MEDS file", answer.out)

    def test_a_part_of_it_is_none(self):
        """A table of that name alone; and its objects may serve as sources."""
        self.assertNotIn("MEDS", shearctl("measure", self.meds("object_data", "image_cutouts")).err)
        self.draw()
        path = self.meds("object_data", "image_info", "image_cutouts")
        answer = shearctl("measure", *self.options(sources=path), "--quiet")
        self.assertNotIn("MEDS", answer.err)
        self.assertNotEqual(answer.code, DONE)  # two sources


if __name__ == "__main__":
    unittest.main()
