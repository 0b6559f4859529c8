# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl validate and plot of exposures: mock exposures, with their truth as the catalog and an image as the PSF."""
import math
import unittest

from fitsfile import image, primary, table
from test_plot import read_png
from tool import DONE, USAGE, ToolTest, shearctl

FWHM = 3.8


def moffat(side, step):
    """Moffat's profile of exponent 3.5, sampled `step` times per pixel."""
    r0 = FWHM * step / 2 / math.sqrt(2 ** (1 / 3.5) - 1)
    middle = side // 2
    return [(1 + ((x - middle) ** 2 + (y - middle) ** 2) / r0 ** 2) ** -3.5 for y in range(side) for x in range(side)]


class Exposure(ToolTest):
    def expose(self, *more):
        """Draw an exposure of round galaxies far from each other. Return the options that read it."""
        answer = shearctl("expose", self.path("exp.fits"), "--quiet", "--force", "--chip-size", "640x512", "--spacing", 100,
                          "--galaxies", 60, "--stars", 0, "--flux", "20000,40000", "--distortion", 0.02,
                          "--psf-variation", 0, *more)
        self.assertCode(answer, DONE)
        side = 65
        with open(self.path("psf.fits"), "wb") as file:
            file.write(primary() + image("PSF", (side, side), moffat(side, 1)))
        return ["--image", self.path("exp.fits"), "--mask", self.path("exp.mask.fits"),
                "--weight", self.path("exp.weight.fits"), "--sources", self.path("exp.truth.fits"),
                "--psf", self.path("psf.fits"), "--psf-kind", "cube"]

    def validate(self, *args):
        answer = shearctl("validate", "--json", "--quiet", *args)
        self.assertEqual(answer.err, "")
        (verdict,) = answer.json()
        return verdict


class Validate(Exposure):
    def test_one_chip(self):
        options = self.expose()
        verdict = self.validate(*options)
        self.assertIs(verdict["good"], True, verdict["verdict"])
        exposure = verdict["exposure"]
        self.assertEqual(exposure["frame"], "sky")
        self.assertLess(exposure["distortion"]["max"], 0.022)
        self.assertGreater(exposure["distortion"]["max"], exposure["distortion"]["min"])
        (chip,) = exposure["chips"]
        self.assertEqual((chip["name"], chip["nx"], chip["ny"], chip["wcs"], chip["table"]), ("CHIP1", 640, 512, True, 0))
        self.assertEqual(chip["hdu"], {"image": 1, "weight": 1, "mask": 1, "segmentation": None})
        self.assertEqual(chip["psf"]["stars"], None)
        self.assertEqual(chip["n_measurable"], verdict["n_measurable"])
        self.assertEqual(chip["n_selected"], verdict["field"]["n_stamps"])
        self.assertEqual(chip["flags"], {name: flag["count"] for name, flag in verdict["flags"].items()})
        self.assertGreater(chip["flags"]["hole"], 0)
        self.assertTrue(0 < chip["masked"] < 0.05, chip["masked"])
        light = chip["centring"]
        self.assertGreaterEqual(light["looked_at"], chip["n_measurable"])
        self.assertGreater(light["found"], 0.9 * light["looked_at"])
        for axis in "xy":
            self.assertLess(abs(light[axis]), 0.15)

    def test_the_same_in_words(self):
        answer = shearctl("validate", *self.expose())
        self.assertCode(answer, DONE)
        for words in ("frame      sky: x to the West", "taken out", "chip       CHIP1: 640 x 512 px; ", "no segmentation",
                      "positions  light of", "hole ("):
            self.assertIn(words, answer.out)

    def test_an_origin_that_is_wrong_is_told(self):
        options = self.expose()
        for command in ("validate", "measure"):
            answer = shearctl(command, *options, "--origin", 0)
            self.assertIn("give --origin 1", answer.out + answer.err)
            answer = shearctl(command, *options)
            self.assertNotIn("--origin", answer.out + answer.err)

    def test_several_chips(self):
        verdict = self.validate(*self.expose("--chips", "2x1"))
        chips = verdict["exposure"]["chips"]
        self.assertEqual([c["name"] for c in chips], ["CHIP1", "CHIP2"])
        self.assertEqual([c["hdu"]["image"] for c in chips], [1, 2])
        self.assertEqual(sum(c["n_measurable"] for c in chips), verdict["n_measurable"])
        self.assertEqual(sum(c["n_selected"] for c in chips), verdict["field"]["n_stamps"])

    def test_another_catalog_is_told(self):
        options = self.expose()
        with open(self.path("other.fits"), "wb") as file:
            places = [(45 + 61 * (i % 10), 47 + 60 * (i // 10)) for i in range(70)]
            file.write(primary() + table("OBJECTS", [("X", "D", [float(x) for x, _ in places]),
                                                     ("Y", "D", [float(y) for _, y in places])]))
        options[options.index("--sources") + 1] = self.path("other.fits")
        self.assertRegex("\n".join(self.validate(*options)["warnings"]), "there is light near .* positions only")

    def test_a_catalog_of_another_field_is_told(self):
        """Few of its sources are on the chip."""
        options = self.expose()
        places = [100.0, 200.0, 300.0] + [5000.0 + i for i in range(27)]
        with open(self.path("other.fits"), "wb") as file:
            file.write(primary() + table("OBJECTS", [(name, "D", places) for name in "XY"]))
        options[options.index("--sources") + 1] = self.path("other.fits")
        verdict = self.validate(*options)
        (chip,) = verdict["exposure"]["chips"]
        self.assertEqual((chip["n_sources"], chip["n_selected"], chip["flags"]["no_position"]), (3, 30, 27))
        self.assertRegex("\n".join(verdict["warnings"]), "27 of 30 sources are not on it")
        self.assertIn("3 sources on it, 30 selected", shearctl("validate", *options).out)

    def test_a_mask_of_everything_is_told(self):
        verdict = self.validate(*self.expose(), "--mask-bad", "zero")
        self.assertIs(verdict["good"], False)
        self.assertRegex("\n".join(verdict["warnings"]), r"(9\d|100) % of its pixels are bad")

    def test_without_coordinates(self):
        options = self.expose()
        with open(self.path("exp.fits"), "rb") as file:
            content = file.read()
        with open(self.path("exp.fits"), "wb") as file:
            file.write(content.replace(b"CTYPE", b"XTYPE"))
        self.assertRegex("\n".join(self.validate(*options)["warnings"]), "it has no WCS")
        verdict = self.validate(*options, "--frame", "pixel")
        self.assertNotIn("WCS", "\n".join(verdict["warnings"]))
        self.assertEqual(verdict["exposure"]["distortion"], {"min": None, "max": None})


class Plot(Exposure):
    def plotted(self, *args, out="out.png"):
        answer = shearctl("plot", *args, "-o", self.path(out))
        self.assertCode(answer, DONE)
        self.assertEqual((answer.out, answer.err), (self.path(out) + "\n", ""))
        return read_png(self.path(out))

    def test_a_chip(self):
        options = self.expose("--chips", "2x1")
        width, height, first = self.plotted(*options, out="1.png")
        self.assertGreaterEqual(width, 1200)
        self.assertGreater(height, 600)
        self.assertTrue(self.plotted(*options, "--chip", 1, out="number.png")[2] == first)
        second = self.plotted(*options, "--chip", "chip2", out="2.png")[2]
        self.assertFalse(second == first)
        self.assertTrue(self.plotted(*options, "--chip", 2, out="number2.png")[2] == second)

    def test_what_is_drawn(self):
        """Other bad pixels, noise stamps, galaxies and frames give other pictures, and the same give the same."""
        options = self.expose()
        pictures = [self.plotted(*options, *more, out=f"{i}.png")[2]
                    for i, more in enumerate([[], [], ["--stamp-size", 48], ["--frame", "pixel"],
                                              ["--select", "NUMBER > 5"], ["--noise-stamps", 3]])]
        weight = options.index("--weight")
        del options[weight:weight + 2]
        pictures.append(self.plotted(*options, "--mask-bad", "bits=4", out="mask.png")[2])
        self.assertEqual(len({bytes(p) for p in pictures}), 6)
        self.assertTrue(pictures[0] == pictures[1])

    def test_stamps_of_an_exposure(self):
        options = self.expose()
        one = self.plotted(*options, "--stamp", 10, out="one.png")
        self.assertGreater(self.plotted(*options, "--stamps", 2, out="two.png")[1], one[1])
        self.assertFalse(self.plotted(*options, "--stamp", 10, "--stamp-size", 48, out="small.png")[2] == one[2])

    def test_options_that_do_not_fit(self):
        options = self.expose()
        self.assertFails(shearctl("plot", *options, "--chip", "nowhere"), USAGE, "no chip 'nowhere'", "CHIP1")
        self.assertFails(shearctl("plot", *options, "--chip", 0), USAGE, "no chip '0'")
        self.assertFails(shearctl("plot", *options, "--chip", 1, "--stamp", 1), USAGE, "--chip")
        self.assertFails(shearctl("plot", self.path("exp.truth.fits"), "--chip", 1), USAGE, "--chip")
        self.assertFails(shearctl("plot", *options, "-o", self.path("exp.mask.fits"), "--force"), USAGE, "input itself")
        self.assertFails(shearctl("plot"), USAGE, "one file")


if __name__ == "__main__":
    unittest.main()
