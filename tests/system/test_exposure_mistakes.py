# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposures that are given by mistake in a way that could pass without a word, or with the wrong one."""
import unittest

from exposures import ExposureTest, images, write, write_images
from fitsfile import card, image, primary, table
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


class Astray(ExposureTest):
    """One chip of several has finite, but senseless coordinates, and one catalog of RA and Dec serves all."""

    def astray(self, *changes):
        """Change keywords of the second chip: (key, function of its number)."""
        chips = images(self.path("exp.fits"))
        for key, change in changes:
            (i,) = [i for i, card in enumerate(chips[1].cards) if card.startswith(key.ljust(8))]
            value = float(chips[1].cards[i][10:].split("/")[0])
            chips[1].cards[i] = card(key, change(value)).decode("ascii")
        write_images(self.path("exp.fits"), chips)

    def scaled(self, factor):
        self.astray(*((f"CD{i}_{j}", lambda v: v * factor) for i in (1, 2) for j in (1, 2)))

    def assertTold(self, *words):
        answer = shearctl("measure", *self.options())
        self.assertCode(answer, DONE)
        told = [line for line in answer.err.splitlines() if "chip 2 (CHIP2)" in line]
        self.assertEqual(len(told), 1, answer.err)
        self.assertNotIn("chip 1", answer.err)
        answer = shearctl("validate", *self.options())
        self.assertEqual(answer.code, INPUT)
        (verdict,) = [line for line in answer.out.splitlines() if line.startswith("  bad ")]
        for word in ("no source of the catalog is on it", *words):
            self.assertIn(word, told[0])
            self.assertIn(word, verdict)
        self.assertIn("CHIP2", verdict)
        self.assertIn("1 of 2 chips, the first CHIP2: no source of the catalog is on it", answer.out)

    def test_far_away(self):
        self.draw()
        self.astray(("CRVAL2", lambda v: v + 10.0))
        self.assertTold("the nearest is 9.", "deg from its middle")

    def test_a_scale_of_nothing(self):
        self.draw()
        self.scaled(1e-6)
        self.assertTold("the nearest is 0.0", "its corners")

    def test_no_place_on_the_sky(self):
        self.draw()
        self.scaled(1e6)
        self.assertTold()

    def test_a_dead_chip_is_not_bad(self):
        """Sources begin at its edges: measure and validate say that it has none, no more."""
        self.draw()
        self.assertNotIn("no source of the catalog", shearctl("validate", *self.options()).out)
        truth = self.truth()
        rows = [i for i, chip in enumerate(truth["CHIP"]) if chip == 1]
        write(self.path("exp.cat"), primary() + table("SOURCES", [
            *((name, kind, [truth[name][i] for i in rows]) for name, kind in (("NUMBER", "J"), ("RA", "D"), ("DEC", "D"))),
            *self.ellipses(len(rows))]))
        self.assertIn("chip 2 (CHIP2): no source of the catalog is on it", shearctl("measure", *self.options()).err)
        answer = shearctl("validate", *self.options())
        self.assertCode(answer, DONE)
        self.assertIn("the first CHIP2: no source of the catalog is on it: the nearest is 0.0", answer.out)


if __name__ == "__main__":
    unittest.main()
