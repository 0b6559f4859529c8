# SPDX-License-Identifier: GPL-3.0-or-later
"""The shear of exposures: an extracted field has the exposure's bits; frames; true shears; distortion."""
import math
import os
import shutil
import subprocess
import unittest

from exposures import ExposureTest, keywords, psf_cube, read, write
from fitsfile import hdus
from tool import DONE, shearctl

SEXTRACTOR = shutil.which("source-extractor") or shutil.which("sex")
SURVEY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples", "survey")
FRAMES = ("sky", "sky-east", "pixel")


def ratio(pairs, groups=16):
    """sum of first / sum of second numbers, with its error by jackknife."""
    top, bottom = map(sum, zip(*pairs))
    parts = [tuple(map(sum, zip(*pairs[i::groups]))) for i in range(groups)]
    left = [(top - t) / (bottom - b) for t, b in parts]
    mean = sum(left) / groups
    return top / bottom, math.sqrt((groups - 1) / groups * sum((x - mean) ** 2 for x in left))


class Extracted(ExposureTest):
    def compare(self, options):
        """Exposure and extracted field, with one thread and with four, in all frames."""
        for frame in FRAMES:
            with self.subTest(frame=frame):
                results = [self.measure(*options, "--frame", frame, "--threads", n, keep=str(n)) for n in (1, 4)]
                field = self.path("field.fits")
                self.assertCode(shearctl("extract", *options, "--frame", frame, "-o", field, "--force", "--quiet"), DONE)
                results += [self.measure(field, "--threads", n, keep=f"field{n}") for n in (1, 4)]
                for other in results[1:]:
                    self.assertSameBits(results[0], other)
                self.assertEqual(keywords(hdus(read(self.path("1.shear.fits")))[-1][1])[0]["FRAME"], frame)
                self.assertGreater(results[0][0]["n_used"], 30)
                self.assertGreater(results[0][0]["n_flagged"], 2)

    def test_images_of_the_psf(self):
        options = self.draw("--cosmic-rays", 20, "--bad-columns", 1)
        write(self.path("psf.fits"), psf_cube())
        weight, mask = self.path("exp.weight.fits"), self.path("exp.mask.fits")
        self.compare([*options, "--weight", weight, "--mask", mask])

    @unittest.skipUnless(SEXTRACTOR and shutil.which("psfex"), "needs source-extractor and psfex")
    def test_psfex(self):
        self.draw("--spacing", 0, "--galaxies", 15, "--stars", 8, "--psf-variation", 0.05, "--cosmic-rays", 20)
        for name in os.listdir(SURVEY):
            shutil.copy(os.path.join(SURVEY, name), self.directory)
        detect = [SEXTRACTOR, "exp.fits", "-c", "survey.sex", "-WEIGHT_IMAGE", "exp.weight.fits",
                  "-FLAG_IMAGE", "exp.mask.fits"]
        for command in ([*detect, "-CATALOG_NAME", "exp.cat", "-CHECKIMAGE_NAME", "exp.seg.fits"],
                        [*detect, "-CATALOG_NAME", "stars.cat", "-PARAMETERS_NAME", "stars.param", "-CHECKIMAGE_TYPE",
                         "NONE"],
                        ["psfex", "stars.cat", "-c", "survey.psfex"]):
            subprocess.run(command, cwd=self.directory, check=True, timeout=600, capture_output=True)
        self.compare(self.options(weight=self.path("exp.weight.fits"), mask=self.path("exp.mask.fits"),
                                  segmentation=self.path("exp.seg.fits"), sources=self.path("exp.cat"),
                                  psf=self.path("stars.psf")))


class Frames(ExposureTest):
    def test_the_sign_of_g2(self):
        options = self.draw()
        sky, east = (self.measure(*options, "--frame", frame) for frame in FRAMES[:2])
        self.assertEqual(east[0]["g1"], sky[0]["g1"])
        self.assertEqual(east[0]["g2"], -sky[0]["g2"])
        self.assertEqual(east[0]["cov12"], -sky[0]["cov12"])
        for name in ("g1_err", "g2_err", "n_used"):
            self.assertEqual(east[0][name], sky[0][name])
        for name, values in sky[1].items():
            sign = -1 if name in ("N2", "V", "M11", "NOISE_N2") else 1
            self.assertEqual(list(map(repr, east[1][name])), [repr(sign * v) for v in values], name)

    def measured(self, name, g1, g2, *options):
        return self.measure(*self.draw("--shear", f"{g1},{g2}", *options, name=name), keep=name)

    def test_true_shears(self):
        """The same galaxies and noise with opposite shears, on a mirrored, turned and distorted image."""
        for seed in (1, 2):
            results = [self.measured("exp", sign * 0.03, sign * -0.02, "--seed", seed)[1] for sign in (1, -1)]
            both = [not (f or h) for f, h in zip(*(r["FLAGS"] for r in results))]
            self.assertGreater(sum(both), 50)
            for name, g in (("N1", 0.03), ("N2", -0.02)):
                rows = [(a - b, d + e) for a, b, d, e, good in
                        zip(results[0][name], results[1][name], results[0]["D"], results[1]["D"], both) if good]
                found, error = ratio(rows)
                self.assertLess(error, 0.001)
                self.assertLess(abs(found - g), 4 * error + 0.005 * abs(g), (seed, name, found, error))

    def test_exposures_add_up(self):
        """Two exposures that are turned by 95 degrees."""
        results, fields = [], []
        for name, rotation in (("first", 10), ("second", 105)):
            options = self.draw("--shear", "0.03,-0.02", "--rotation", rotation, name=name)
            results.append(self.measure(*options, "--noise-level", "none", keep=name))
            fields.append(self.path(name + ".field.fits"))
            self.assertCode(shearctl("extract", *options, "-o", fields[-1], "--field", "both", "--quiet"), DONE)
        for name, g in (("g1", 0.03), ("g2", -0.02)):
            for one in results:
                self.assertLess(abs(one[0][name] - g), 4 * one[0][name + "_err"])
        joined = self.measure_one(*fields, "--quiet", "--noise-level", "none")
        self.assertEqual(joined["field"], "both")
        self.assertEqual(joined["n_used"], sum(r[0]["n_used"] for r in results))
        for name, top in (("g1", "N1"), ("g2", "N2")):
            sums = [sum(v for r in results for v, f in zip(r[1][c], r[1]["FLAGS"]) if f == 0) for c in (top, "D")]
            self.assertAlmostEqual(joined[name], sums[0] / sums[1], 12)
        # In pixels the shears are nearly opposite.
        pixel = [self.measure(*self.options(name), "--frame", "pixel")[0] for name in ("first", "second")]
        self.assertLess(pixel[0]["g1"] * pixel[1]["g1"] + pixel[0]["g2"] * pixel[1]["g2"], 0)

    def test_other_frames_do_not_join(self):
        options = self.draw()
        paths = []
        for frame in FRAMES[1:]:
            paths.append(self.path(frame + ".fits"))
            self.assertCode(shearctl("extract", *options, "-o", paths[-1], "--frame", frame, "--quiet"), DONE)
        answer = shearctl("measure", *paths, "--field", "one")
        self.assertRegex(answer.err, "frame")
        self.assertNotEqual(answer.code, DONE)

    def test_what_distortion_does(self):
        """In the pixel frame round galaxies have the shear GF1, GF2."""
        options = self.draw("--shear", "0,0", "--distortion", 0.1, "--skew", "0.03,-0.04", "--ellipticity", 0)
        _, rows = self.measure(*options, "--frame", "pixel")
        for gf, n in (("GF1", "N1"), ("GF2", "N2")):
            used = [(v * g, d * g * g) for v, g, d, f in zip(rows[n], rows[gf], rows["D"], rows["FLAGS"]) if f == 0]
            slope, error = ratio(used)
            self.assertLess(error, 0.03)
            self.assertLess(abs(slope - 1), 4 * error + 0.01, (gf, slope, error))

    def test_the_truth_s_jacobians(self):
        """GF1 and GF2 are those of the mock's own Jacobians."""
        options = self.draw("--skew", "0.03,-0.04")
        _, rows = self.measure(*options)
        truth = self.truth()
        self.assertEqual(len(rows["GF1"]), len(truth["X"]))
        for i, number in enumerate(truth["NUMBER"]):
            k = rows["ID"].index(number)
            a, b, c, d = (truth[name][i] for name in ("DUDX", "DUDY", "DVDX", "DVDY"))
            for name in ("X", "Y", "RA", "DEC"):
                self.assertAlmostEqual(rows[name][k], truth[name][i], 6)
            # The shear of a circle of the sky in pixels: of (J^T J)^-1.
            xx, yy, xy = b * b + d * d, a * a + c * c, -(a * b + c * d)
            root = 2 * abs(a * d - b * c)
            self.assertAlmostEqual(rows["GF1"][k], (xx - yy) / (xx + yy + root), 6)
            self.assertAlmostEqual(rows["GF2"][k], 2 * xy / (xx + yy + root), 6)


if __name__ == "__main__":
    unittest.main()
