# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl validate: reports on good files and on those that are partly good. Bad files are in
test_bad_input.py."""
import math
import random
import unittest

from fitsfile import Field, gaussian
from tool import DONE, INPUT, PARTLY, ToolTest, shearctl

KEYS = ["path", "good", "verdict", "advice", "field", "settings", "resolved", "psf",
        "warnings", "n_measurable",
        "flags", "negative", "lowest_pixel", "noise", "weight_follows_flux", "no_shear", "noise_level", "influence",
        "resolution", "version"]


class Validate(ToolTest):
    def validate(self, *args):
        answer = shearctl("validate", "--json", *args)
        self.assertCode(answer, DONE)
        self.assertEqual(answer.err, "")
        (verdict,) = answer.json()
        self.assertEqual(list(verdict), KEYS)
        return verdict

    def test_good_file_in_words(self):
        field = Field(n=5, nx=40, ny=32)
        field.columns = [("ID", "K", list(range(5))), ("WEIGHT", "D", [1.0] * 5)]
        answer = shearctl("validate", field.write(self.path("a.fits")))
        self.assertCode(answer, DONE)
        for words in ("5 pairs of 40 x 32 pixels, a cube of 32-bit floats",
                      "one for all stamps, 40 x 40 samples",
                      "ID, WEIGHT", "g1 +0.03, g2 -0.02", "interpolation none, R_PSF 1.5",
                      "good       would measure 5 of 5 stamps"):
            self.assertIn(words, answer.out)

    def test_good_file_in_json(self):
        verdict = self.validate(Field(n=5).write(self.path("a.fits")), "--filter", "edge")
        self.assertIs(verdict["good"], True)
        self.assertEqual(verdict["n_measurable"], 5)
        self.assertEqual(verdict["field"]["n_stamps"], 5)
        self.assertEqual((verdict["field"]["nx"], verdict["field"]["layout"],
                          verdict["field"]["bitpix"]),
                         (48, "cube", -32))
        self.assertEqual(verdict["resolved"]["filter"], "edge")
        self.assertEqual(verdict["settings"]["filter"], "edge")
        self.assertTrue(all(f == {"count": 0, "first": []} for f in verdict["flags"].values()))

    def test_flags_agree_with_measure(self):
        field = Field(n=30, nx=16, ny=16, size=1.5, r_psf=1.1)
        for i in range(10, 20):
            field.galaxy[i][i] = math.nan
        field.galaxy[5] = [0.0] * 256
        field.noise[6][0] = -math.inf
        field.columns = [("FLAGS", "J", [int(i in (7, 11)) for i in range(30)]),
                         ("WEIGHT", "D", [math.nan if i == 8 else 1.0 for i in range(30)]),
                         ("R_GAL", "D", [0.0 if i == 9 else 1.5 for i in range(30)])]
        path = field.write(self.path("a.fits"))
        for args in ((), ("--filter", "none")):
            with self.subTest(args=args):
                verdict = self.validate(path, *args)
                result = self.measure_one(path, *args)
                self.assertEqual({k: f["count"] for k, f in verdict["flags"].items()},
                                 result["flags"])
                self.assertEqual(verdict["n_measurable"], result["n_used"])
                self.assertEqual(verdict["resolved"], result["resolved"])
        flags = self.validate(path)["flags"]
        self.assertEqual(flags["galaxy_not_finite"], {"count": 10, "first": list(range(10, 18))})
        self.assertEqual(flags["masked"], {"count": 2, "first": [7, 11]})
        self.assertEqual(flags["bad_r_gal"], {"count": 1, "first": [9]})
        text = shearctl("validate", path).out
        self.assertIn("10 galaxy_not_finite", text)
        self.assertIn("stamps 10, 11, 12, 13, 14, 15, 16, 17, ...", text)

    def test_blank_pixels(self):
        field = Field(n=4, nx=16, ny=16, size=1.5, r_psf=1.1)
        field.bitpix, field.blank = 16, -32768
        field.galaxy[1][20] = field.noise[2][30] = math.nan
        path = field.write(self.path("a.fits"))
        verdict = self.validate(path)
        self.assertEqual(verdict["flags"]["galaxy_not_finite"], {"count": 1, "first": [1]})
        self.assertEqual(verdict["flags"]["noise_not_finite"], {"count": 1, "first": [2]})
        self.assertEqual(verdict["field"]["bitpix"], 16)
        self.assertEqual(self.measure_one(path)["n_used"], 2)

    def test_psfs_chosen_by_id(self):
        field = Field(n=6, nx=16, ny=16, size=1.5, r_psf=1.1)
        field.columns = [("PSF_ID", "J", [0, 1, 2, 0, 1, 5])]
        nan = [math.nan] * 256
        field.psf_cube = [field.psf, nan, field.psf]
        path = field.write(self.path("a.fits"))
        verdict = self.validate(path)
        result = self.measure_one(path)
        self.assertEqual(verdict["flags"]["psf_unusable"], {"count": 3, "first": [1, 4, 5]})
        self.assertEqual(result["flags"]["psf_unusable"], 3)
        self.assertEqual((verdict["n_measurable"], result["n_used"]), (3, 3))
        self.assertEqual((verdict["field"]["psf_layout"], verdict["field"]["n_psf"]), ("by_id", 3))

    def test_several_noise_stamps(self):
        path = self.path("several.fits")
        self.assertCode(shearctl("mock", path, "--stamps", "6", "--size", "24", "--r-gal", "3", "--white", "0.2",
                                 "--noise-stamps", "3", "--rotate", "1", "--quiet"), DONE)
        verdict = self.validate(path)
        self.assertEqual((verdict["good"], verdict["field"]["noise_stamps"]), (True, 3))
        self.assertIn("3 stamps per galaxy", shearctl("validate", path).out)
        with open(path, "r+b") as f:  # a NaN in the last noise stamp of the third galaxy
            data = f.read()
            noise = data.index(b"'NOISE   '")
            start = (noise // 2880 + 1) * 2880
            f.seek(start + (3 * 2 + 2) * 24 * 24 * 4 + 4 * 77)
            f.write(b"\x7f\xc0\x00\x00")
        self.assertEqual(self.validate(path)["flags"]["noise_not_finite"], {"count": 1, "first": [2]})
        self.assertEqual(self.measure_one(path)["flags"]["noise_not_finite"], 1)

    def test_too_few_stamps(self):
        field = Field(n=3)
        field.columns = [("FLAGS", "J", [1, 0, 1])]
        answer = shearctl("validate", field.write(self.path("a.fits")))
        self.assertCode(answer, INPUT)
        self.assertIn("only 1 of 3 stamps could be measured", answer.out)

    def test_masked_stamps_may_be_negative_under_a_log(self):
        field = Field(n=4)
        field.galaxy[2][0] = -5.0
        field.columns = [("FLAGS", "J", [0, 0, 1, 0])]
        path = field.write(self.path("a.fits"))
        args = ("--interpolation", "log-bilinear", "--oversample", 2)
        verdict = self.validate(path, *args)
        self.assertEqual((verdict["negative"]["count"], verdict["n_measurable"]), (0, 3))
        self.assertEqual(verdict["lowest_pixel"], -5.0)
        self.assertEqual(self.measure_one(path, *args)["n_used"], 3)

    def test_weights_of_the_flux(self):
        """Weights made of the stamps' own flux are reported, by rank; others, and few ones, are not."""
        field = Field(n=60, nx=24, ny=24, sigma=2.0)
        fluxes = [sum(stamp) for stamp in field.galaxy]
        self.assertIsNone(self.validate(field.write(self.path("none.fits")))["weight_follows_flux"])
        rng = random.Random(5)
        for name, weights, suspect in (("flux", [1 / f ** 2 for f in fluxes], True),
                                       ("brightness", [f ** 3 for f in fluxes], True),
                                       ("steps",
                                        [1 + (f > sorted(fluxes)[20]) + (f > sorted(fluxes)[40]) for f in fluxes], True),
                                       ("level", [rng.uniform(0.5, 2.0) for _ in fluxes], False),
                                       ("partly", [1e4 + 0.3 * f + rng.uniform(0, 1e4) for f in fluxes], False),
                                       ("equal", [3.0] * 60, False)):
            field.columns = [("WEIGHT", "D", weights)]
            path = field.write(self.path(name + ".fits"))
            verdict = self.validate(path)
            self.assertTrue(verdict["good"])
            self.assertEqual("--estimator pdf-sym" in verdict["advice"], suspect, name)
            self.assertEqual("they bias the shear" in shearctl("validate", path).out, suspect, name)
        few = Field(n=24, nx=24, ny=24)
        few.columns = [("WEIGHT", "D", [1 / sum(stamp) for stamp in few.galaxy])]
        verdict = self.validate(few.write(self.path("few.fits")))
        self.assertLess(verdict["weight_follows_flux"], -0.95)
        self.assertEqual(verdict["advice"], "")

    def test_background(self):
        field = Field(n=16, sigma=2.0)
        path = field.write(self.path("a.fits"))
        verdict = self.validate(path, "--core", 10)
        noise = verdict["noise"]
        self.assertLess(abs(noise["mean"]), 5 * noise["mean_err"])
        self.assertLess(abs(noise["mean_err"] * math.sqrt(16 * 48 * 48) / 2 - 1), 0.9)
        self.assertLess(abs(noise["rms"] / 2 - 1), 0.05)
        self.assertEqual(verdict["advice"], "")
        for stamps in (field.galaxy, field.noise):
            stamps[:] = [[p + 5.0 for p in stamp] for stamp in stamps]
        path = field.write(self.path("b.fits"))
        bright = self.validate(path, "--core", 10, "--background", "keep")
        self.assertLess(abs(bright["noise"]["mean"] - noise["mean"] - 5), 1e-3)
        self.assertLess(abs(bright["noise"]["rms"] - noise["rms"]), 1e-3)
        self.assertTrue(bright["good"])
        self.assertIn("--background noise-mean", bright["advice"])
        for harmless in (("--core", 10), ("--core", 10, "--background", "noise-mean"),
                         ("--filter", "none"),
                         ("--core", 10, "--estimator", "pdf-sym-cross")):
            self.assertEqual(self.validate(path, *harmless)["advice"], "")

    def spoilt(self, field, *args):
        """The verdict on a file that would give no shear, and the message of measure."""
        path = field.write(self.path("spoilt.fits"))
        answer = shearctl("validate", "--json", path, *args)
        self.assertCode(answer, INPUT)
        (verdict,) = answer.json()
        measured = shearctl("measure", "--json", path, *args)
        self.assertFails(measured, INPUT, "no shear could be measured")
        (result,) = measured.json()
        self.assertEqual((verdict["good"], verdict["no_shear"]), (False, result["no_shear"]))
        self.assertIsNone(result["g1"])
        self.assertIn(verdict["verdict"], measured.err)
        self.assertIn(verdict["advice"], measured.err)
        return verdict

    def test_why_there_is_no_shear(self):
        field = Field(n=16, sigma=1.0)
        swapped = Field(n=16, sigma=1.0)
        swapped.galaxy, swapped.noise = field.noise, field.galaxy
        verdict = self.spoilt(swapped)
        self.assertEqual(verdict["no_shear"], "swapped")
        self.assertIn("swapped?", verdict["verdict"])
        swapped.noise = swapped.galaxy
        verdict = self.spoilt(swapped)
        self.assertEqual(verdict["no_shear"], "same_stamps")
        self.assertIn("the same", verdict["verdict"])
        field.columns = [("WEIGHT", "D", [0.0] * 16)]
        verdict = self.spoilt(field)
        self.assertEqual(verdict["no_shear"], "no_weight")
        self.assertIn("weights are 0", verdict["verdict"])
        self.assertIn("WEIGHT", verdict["advice"])
        faint = Field(n=16, sigma=300.0)
        self.assertEqual(self.spoilt(faint)["no_shear"], "no_signal")

    def test_oversamp_forgotten(self):
        field = Field(n=16, sigma=0.5, psf_oversample=3)
        self.assertIsNone(self.validate(field.write(self.path("a.fits")))["no_shear"])
        field.oversample = 1
        verdict = self.spoilt(field)
        self.assertEqual(verdict["no_shear"], "too_narrow")
        self.assertIn("OVERSAMP", verdict["verdict"])
        self.assertIn("OVERSAMP", verdict["advice"])

    def test_it_measures_what_measure_does(self):
        """To the last bit, also if blocks of stamps end within one read."""
        field = Field(n=37, nx=32, ny=32, size=2.0, r_psf=1.5, sigma=2.0)
        field.columns = [("WEIGHT", "D", [1.0 + 0.1 * i for i in range(37)])]
        path = field.write(self.path("a.fits"))
        verdict, result = self.validate(path), self.measure_one(path)
        for key in ("noise_level", "no_shear", "resolution", "warnings"):
            self.assertEqual(verdict[key], result[key], key)
        self.assertEqual({**verdict["influence"], "top_file": path}, result["influence"])

    def noisy(self, under, beside, n=64):
        """Galaxies in noise of `under` sigma per pixel with noise stamps of `beside`."""
        field = Field(n=n, nx=32, ny=32, size=2.0)
        rng = random.Random(11)
        for stamps, sigma in ((field.galaxy, under), (field.noise, beside)):
            stamps[:] = [[p + rng.gauss(0, sigma) for p in stamp] for stamp in stamps]
        return field

    def test_the_noise_level(self):
        quiet = self.validate(self.noisy(6.0, 6.0).write(self.path("a.fits")))
        level = quiet["noise_level"]
        self.assertLess(abs(level["alpha"] - 1), 4 * level["alpha_err"])
        self.assertLess(level["alpha_err"], 0.02)
        self.assertEqual(quiet["warnings"], [])
        for under, words in ((7.0, "stronger than in the noise stamps"), (5.0, "weaker than in the noise stamps"),
                             (12.0, "not of the galaxies' noise")):
            with self.subTest(under=under):
                verdict = self.validate(self.noisy(under, 6.0).write(self.path("a.fits")))
                level = verdict["noise_level"]
                self.assertLess(abs(level["alpha"] - (under / 6) ** 2), 4 * level["alpha_err"])
                self.assertAlmostEqual(level["effect"], (level["alpha"] - 1) * level["share"], delta=1e-12)
                (warning,) = verdict["warnings"]
                self.assertIn(words, warning)
                self.assertEqual(self.measure_one(self.path("a.fits"))["warnings"], [warning])
        self.assertIn("stronger", shearctl("validate", self.noisy(7.0, 6.0).write(self.path("a.fits"))).out)

    def test_too_few_for_the_estimator(self):
        field = Field(n=12, nx=32, ny=32, size=2.0, sigma=1.0)
        self.assertTrue(self.validate(field.write(self.path("a.fits")))["good"])
        verdict = self.spoilt(field, "--estimator", "pdf-sym")
        self.assertEqual(verdict["no_shear"], "no_symmetry")
        self.assertIn("12 usable stamps", verdict["verdict"])

    def test_the_noise_s_spectrum(self):
        field = self.noisy(6.0, 0.0)
        rng = random.Random(12)
        for stamp in field.noise:  # each pixel and its neighbour to the right, of the same variance
            white = [rng.gauss(0, 6.0 / math.sqrt(2)) for _ in range(len(stamp) + 1)]
            stamp[:] = [a + b for a, b in zip(white, white[1:])]
        answer = shearctl("validate", "--json", field.write(self.path("a.fits")))
        self.assertCode(answer, INPUT)
        (verdict,) = answer.json()
        (warning,) = verdict["warnings"]
        self.assertIn("different spectrum", warning)
        self.assertIn("different spectrum", verdict["verdict"])

    def test_a_psf_that_is_too_broad(self):
        """Eight of 40 sources are points."""
        field = Field(n=40, nx=48, ny=48, r_psf=1.5)
        field.galaxy[::5] = [gaussian(48, 48, 1000, (2.25, 2.25, 0.0)) for _ in range(8)]
        verdict = self.validate(field.write(self.path("a.fits")))
        self.assertEqual((verdict["resolution"]["bright"], verdict["resolution"]["sharp"]), (40, 0))
        self.assertEqual((verdict["good"], verdict["warnings"]), (True, []))
        field.psf = gaussian(48, 48, 1.0, (1.8 ** 2, 1.8 ** 2, 0.0))
        answer = shearctl("validate", "--json", field.write(self.path("b.fits")))
        self.assertCode(answer, INPUT)
        (verdict,) = answer.json()
        self.assertIn("sharper than their PSF", verdict["verdict"])
        self.assertEqual(verdict["resolution"]["sharp"], 8)
        (warning,) = verdict["warnings"]
        self.assertTrue(warning.startswith("8 of 40 bright stamps are sharper than their PSF"), warning)
        self.assertEqual(self.measure_one(self.path("b.fits"))["warnings"], [warning])

    def test_one_stamp_that_decides(self):
        field = Field(n=60, nx=32, ny=32, size=2.0, sigma=1.0)
        field.galaxy[23] = [200.0 * p for p in field.galaxy[23]]
        verdict = self.validate(field.write(self.path("a.fits")))
        self.assertEqual(verdict["influence"]["top_stamp"], 23)
        self.assertGreater(verdict["influence"]["top_share"], 0.9)
        self.assertLess(verdict["influence"]["n_eff"], 1.1)
        self.assertIn("stamp 23 has", verdict["warnings"][0])
        for warning in self.validate(self.path("a.fits"), "--estimator", "pdf-sym")["warnings"]:
            self.assertNotIn("of the sum of w D", warning)  # it counts once, as all do
        other = Field(n=20, nx=32, ny=32, size=2.0, sigma=1.0, seed=2).write(self.path("b.fits"))
        result = self.measure_one(other, self.path("a.fits"), "--field", "both")
        self.assertIn("stamp 23 of " + self.path("a.fits"), result["warnings"][0])
        self.assertEqual(result["influence"]["top_file"], self.path("a.fits"))

    def test_good_and_bad_files(self):
        good = Field(n=4).write(self.path("a.fits"))
        answer = shearctl("validate", "--json", good, self.path("none.fits"))
        self.assertCode(answer, PARTLY)
        self.assertEqual([v["good"] for v in answer.json()], [True, False])
        self.assertIsNone(answer.json()[1]["field"])


if __name__ == "__main__":
    unittest.main()
