# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposures that are broken, absurd, or given the wrong way round: each is refused at once, with the file, the HDU, the
keyword and a cure, or measured as far as it goes; in bounded memory, without a crash."""
import math
import os
import re
import struct
import subprocess
import sys

from exposures import ExposureTest, Image, images, ldac, psf_image, read, write, write_images
from fitsfile import BLOCK, big_endian, card, header, image, primary, table
from tool import DONE, INPUT, PATIENCE, SANITIZED, SANITIZERS, SHEARCTL, shearctl, unittest

PARTS = ("image", "sources", "psf", "weight", "mask", "segmentation", "wcs", "noise")
MEGABYTE = 1 << 20


class Hostile(ExposureTest):
    def setUp(self):
        super().setUp()
        self.draw()
        self.sky = images(self.path("exp.fits"))

    def refused(self, *words, **changed):
        answer = shearctl("measure", *self.options(**changed))
        self.assertFails(answer, INPUT, *words)
        self.assertLess(answer.seconds, 4 * PATIENCE)
        return answer

    def left_out(self, flag, stamps, *more, **changed):
        """No galaxy can be used, and all have this flag; the error says so, and what to do."""
        answer = shearctl("measure", "--json", *self.options(**changed), *more)
        self.assertFails(answer, INPUT, f"0 of {stamps} stamps are usable ({stamps} have the flag {flag})", "advice: ")
        self.assertEqual(answer.json()[0]["flags"][flag], stamps)
        return answer

    def write(self, name, content):
        return write(self.path(name), content)

    def filled(self, value, bitpix=-32):
        """An exposure like the drawn one with this value everywhere."""
        chips = []
        for chip in self.sky:
            one = Image(image(chip.name, (chip.nx, chip.ny), [value] * (chip.nx * chip.ny), bitpix))
            one.cards += [c for c in chip.cards if re.match(r"(C|PV|RADE|EQUI)", c)]
            chips.append(one)
        return write_images(self.path("filled.fits"), chips)


    def big(self, path, rows, row_of):
        """A table of that many rows, written in parts."""
        row = ">iddh"
        width, part = struct.calcsize(row), 50000
        head = header([("XTENSION", "BINTABLE"), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", width), ("NAXIS2", rows),
                       ("PCOUNT", 0), ("GCOUNT", 1), ("TFIELDS", 4), ("TTYPE1", "NUMBER"), ("TFORM1", "J"),
                       ("TTYPE2", "RA"), ("TFORM2", "D"), ("TTYPE3", "DEC"), ("TFORM3", "D"), ("TTYPE4", "FLAGS"),
                       ("TFORM4", "I"), ("EXTNAME", "BIG")])
        with open(path, "wb") as file:
            file.write(primary() + head)
            for first in range(0, rows, part):
                file.write(b"".join(struct.pack(row, *row_of(i)) for i in range(first, min(first + part, rows))))
            file.write(bytes(-(rows * width) % BLOCK))
        return path

    def peak(self, *options):
        """Exit code and largest resident memory of a measurement, bytes. Its parent is a process of its own: this one's
        memory would count."""
        program = ("import resource, subprocess, sys\n"
                   "code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode\n"
                   "print(code, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
        command = [sys.executable, "-c", program, SHEARCTL, "measure", "--quiet", *map(str, options)]
        process = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=True, text=True,
                                 timeout=60 * PATIENCE, env={**os.environ, **SANITIZERS})
        code, kilobytes = map(int, process.stdout.split())
        return code, 1024 * kilobytes


class Coordinates(Hostile):
    def with_keyword(self, key, value, hdu=b"CHIP2"):
        content = read(self.path("exp.fits"))
        at = content.index(key.ljust(8).encode() + b"= ", content.index(hdu))
        return self.write("wcs.fits", content[:at] + f"{key:<8}= {value:>20}".ljust(80).encode() + content[at + 80:])

    def test_keywords(self):
        for key, value, words in (("CRVAL1", "NaN", "not a finite number"), ("CRVAL1", "1E300", "-360 to 360"),
                                  ("CRVAL2", "95.0", "-90 to 90"), ("CD1_1", "NaN", "not a finite number"),
                                  ("CRPIX1", "-1E18", "no image is as large"), ("CUNIT2", "'furlong'", "'deg'"),
                                  ("PV1_7", "'x'", "not a finite number"), ("CTYPE1", "'RA---XYZ'", "one projection"),
                                  ("CTYPE2", "'GLAT-TPV'", "one projection"), ("CRVAL2", "", "is missing")):
            with self.subTest(key=key, value=value):
                self.refused("wcs.fits", "HDU CHIP2", key, words, "advice: ", image=self.with_keyword(key, value))

    def test_in_the_frame_of_pixels_they_do_not_count(self):
        sources = self.write("xy.cat", ldac([(c, [("X_IMAGE", "D", [float(100 + 9 * i) for i in range(50)]),
                                                  ("Y_IMAGE", "D", [350.0] * 50)]) for c in self.sky]))
        options = self.options(image=self.with_keyword("CRVAL1", "NaN"), sources=sources)
        self.assertFails(shearctl("measure", *options), INPUT, "CRVAL1")
        answer = shearctl("measure", "--json", *options, "--frame", "pixel")
        self.assertEqual(answer.json()[0]["n_stamps"], 100)
        self.refused("exp.cat", "RA and Dec only", image=self.with_keyword("CRVAL1", "NaN"), frame="pixel")

    def test_singular(self):
        for value in ("0.0", "1E300", "1E-300"):
            path = self.with_keyword("CD1_1", value)
            content = read(path)
            for key, other in (("CD1_2", "0.0"), ("CD2_1", "0.0")):
                at = content.index(key.ljust(8).encode(), content.index(b"CHIP2"))
                content = content[:at] + f"{key:<8}= {other:>20}".ljust(80).encode() + content[at + 80:]
            with self.subTest(value):
                answer = shearctl("measure", "--json", *self.options(image=self.write("wcs.fits", content)))
                if value == "0.0":
                    self.assertFails(answer, INPUT, "HDU CHIP2", "singular", "--frame pixel")
                self.assertIn(answer.code, (DONE, INPUT))

    def test_a_polynomial_that_explodes(self):
        for key, value in (("PV1_1", "1E308"), ("PV1_7", "-1E300"), ("PV2_2", "1E30"), ("PV2_1", "0.0")):
            with self.subTest(key):
                answer = shearctl("measure", "--json", *self.options(image=self.with_keyword(key, value)))
                self.assertCode(answer, DONE)  # by the other chip
                self.assertLess(answer.json()[0]["n_used"], 40)


class Sources(Hostile):
    def placed(self, value, names=("X_IMAGE", "Y_IMAGE")):
        n = 100
        return [("NUMBER", "J", list(range(n))), *((name, "D", [value] * n) for name in names), *self.ellipses(n)]

    def test_places_that_are_none(self):
        for value in (1e300, -1e300, math.nan, math.inf, -math.inf, 1e9, -1.0, 0.49):
            with self.subTest(value):
                pixels = self.write("bad.cat", ldac([(chip, self.placed(value)) for chip in self.sky]))
                self.refused("bad.cat", "none of 200 selected sources is on the image", "--columns", sources=pixels)
                sky = self.write("bad.cat", primary() + table("S", self.placed(value, ("RA", "DEC"))))
                self.refused("bad.cat", "none of 100 selected sources is on the image", "degrees", sources=sky)

    def test_ellipses_that_are_none(self):
        places = [50.0 + 6 * i for i in range(100)]
        for value, flag in ((1e300, "neighbour"), (math.inf, None), (math.nan, None), (-1.0, None)):
            objects = [("X_IMAGE", "D", places), ("Y_IMAGE", "D", places[::-1]),
                       *((name, "D", [value] * 100) for name in ("A_IMAGE", "B_IMAGE", "THETA_IMAGE"))]
            path = self.write("bad.cat", ldac([(chip, objects) for chip in self.sky]))
            with self.subTest(value):
                if flag:
                    self.left_out(flag, 200, sources=path)
                else:
                    answer = shearctl("measure", "--json", *self.options(sources=path))
                    self.assertIn(answer.code, (DONE, INPUT), answer.err)
                    self.assertEqual(answer.json()[0]["n_stamps"], 200)

    def test_empty(self):
        nothing = [(name, kind, []) for name, kind in (("NUMBER", "J"), ("RA", "D"), ("DEC", "D"))]
        self.refused("no sources: its tables are empty", sources=self.write("e.cat", primary() + table("S", nothing)))
        self.refused("no sources: its tables are empty",
                     sources=self.write("e.txt", b"#   1 NUMBER\n#   2 ALPHA_J2000\n#   3 DELTA_J2000\n"))
        self.refused("has no binary table", "advice: ", sources=self.write("e.cat", primary()))
        flagged = [("RA", "D", [150.1] * 9), ("DEC", "D", [2.2] * 9), ("FLAGS", "J", [4, 7, 16, 24, 255, 32767, -1, 4, 5])]
        path = self.write("f.cat", primary() + table("S", flagged))
        answer = shearctl("measure", *self.options(sources=path))
        self.assertRegex(answer.err, "no source is selected, of 9|1 of 9|0 of 1 stamps|none of 1 selected")
        self.refused("f.cat", "no source is selected, of 9", "--select", sources=path, select="FLAGS < -100")

    def test_many(self):
        """Half a million rows; ten millions, of which few are near the chips; and too many as a text."""
        truth = self.truth()
        places = list(zip(truth["RA"], truth["DEC"]))
        n = len(places)
        path = self.big(self.path("big.cat"), 500000, lambda i: (i, *places[i % n], 0 if i < n else 4))
        code, bytes_ = self.peak(*self.options(sources=path))
        self.assertEqual(code, DONE)
        if not SANITIZED:
            self.assertLess(bytes_, 150 * MEGABYTE)
        rows = 10 ** 7
        with open(path, "r+b") as file:
            content = file.read(3 * BLOCK).replace(card("NAXIS2", 500000), card("NAXIS2", rows))
            file.seek(0)
            file.write(content)
            size = 2 * BLOCK + 22 * rows
            file.truncate(size + -size % BLOCK)
        code, bytes_ = self.peak(*self.options(sources=path))
        self.assertEqual(code, DONE)
        if not SANITIZED:
            self.assertLess(bytes_, 150 * MEGABYTE)
        with open(self.path("big.txt"), "wb") as file:
            file.write(b"#   1 NUMBER\n#   2 ALPHA_J2000\n#   3 DELTA_J2000\n")
            for _ in range(450):
                file.write(b"1 2 3\n" * 10000)
        self.refused("big.txt", "line 4000004", "too many rows", "split the catalog", sources=self.path("big.txt"))


class Models(Hostile):
    def psfex(self, side, terms, degree, **changed):
        """The header of a PSFEx model with a plane of zeros for each term; the file is sparse."""
        keys = {"POLNAXIS": 2, "POLNAME1": "X_IMAGE", "POLNAME2": "Y_IMAGE", "POLZERO1": 350.0, "POLZERO2": 350.0,
                "POLSCAL1": 700.0, "POLSCAL2": 700.0, "POLGRP1": 1, "POLGRP2": 1, "POLNGRP": 1, "POLDEG1": degree,
                "PSF_SAMP": 1.0, "PSF_FWHM": 3.8, "PSFNAXIS": 3, "PSFAXIS1": side, "PSFAXIS2": side, "PSFAXIS3": terms,
                "ACCEPTED": 50, "LOADED": 60, "CHI2": 1.0, **changed}
        data = 4 * side * side * terms
        head = header([("XTENSION", "BINTABLE"), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", data), ("NAXIS2", 1), ("PCOUNT", 0),
                       ("GCOUNT", 1), ("TFIELDS", 1), ("TTYPE1", "PSF_MASK"), ("TFORM1", f"{data // 4}E"),
                       ("TDIM1", f"({side}, {side}, {terms})"), ("EXTNAME", "PSF_DATA"), *keys.items()])
        path = self.write("model.psf", primary() + head)
        os.truncate(path, os.path.getsize(path) + data + -data % BLOCK)
        return path

    def test_psfex(self):
        for side, terms, degree, changed, words in (
                (5, 10 ** 6, 1413, {}, "POLDEG1 is 1413"), (5, 499500, 998, {}, "POLDEG1 is 998"),
                (25, 91, 12, {}, "model.psf"), (25, 6, 2, {"PSF_SAMP": -1.0}, "PSF_SAMP"),
                (25, 6, 2, {"PSF_SAMP": 1e300}, "PSF_SAMP"), (25, 6, 2, {"POLSCAL1": 0.0}, "POLSCAL1"),
                (25, 6, 2, {"POLNAXIS": 1000000}, "POLNAXIS"), (25, 6, 2, {}, "model.psf"),
                (25, 6, 3, {}, "has 6 planes, but its polynomial (POLDEGn, POLGRPn) has 10 terms"),
                (25, 6, 2, {"ACCEPTED": 0}, "no PSF model can be used")):
            with self.subTest(words):
                self.refused("model.psf", words, "advice: ", psf=self.psfex(side, terms, degree, **changed))

    def test_cubes(self):
        n = 10 ** 6
        places = table("PLACES", [("X", "D", [float(i % 700) for i in range(10)]), ("Y", "D", [1.0] * 10)])
        head = header([("XTENSION", "IMAGE"), ("BITPIX", -32), ("NAXIS", 3), ("NAXIS1", 3), ("NAXIS2", 3), ("NAXIS3", n),
                       ("PCOUNT", 0), ("GCOUNT", 1), ("EXTNAME", "PSF")])
        path = self.write("cube.fits", primary() + head)
        os.truncate(path, os.path.getsize(path) + 36 * n + -(36 * n) % BLOCK)
        write(path, read(path) + places)
        self.refused("cube.fits", "1000000", psf=path)
        for pixels, words in (([0.0] * 81, "not positive"), ([math.nan] * 81, "not finite"), ([1.0] * 81, "flat"),
                              ([1e308] * 81, "cube.fits")):
            self.refused("cube.fits", "HDU PSF, image 0", words, "advice: ",
                         psf=self.write("cube.fits", primary() + image("PSF", (9, 9), pixels, -64)))
        self.refused("cube.fits", "2 x 2", psf=self.write("cube.fits", primary() + image("PSF", (2, 2), [1.0] * 4)))

    def test_stars(self):
        n, side = 100000, 15
        width = 4 * side * side + 16
        head = header([("XTENSION", "BINTABLE"), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", width), ("NAXIS2", n),
                       ("PCOUNT", 0), ("GCOUNT", 1), ("TFIELDS", 3), ("TTYPE1", "VIGNET"), ("TFORM1", f"{side * side}E"),
                       ("TDIM1", f"({side}, {side})"), ("TTYPE2", "X_IMAGE"), ("TFORM2", "D"), ("TTYPE3", "Y_IMAGE"),
                       ("TFORM3", "D"), ("EXTNAME", "STARS")])
        path = self.write("stars.fits", primary() + head)
        os.truncate(path, os.path.getsize(path) + width * n + -(width * n) % BLOCK)
        self.refused("stars.fits", "HDU STARS", "100000", psf=path)
        star = big_endian(psf_image(side), -32)
        dark = bytes(4 * side * side) + struct.pack(">dd", 9, 9)
        content = head.replace(card("NAXIS2", n), card("NAXIS2", 3)) + 3 * dark
        self.refused("stars.fits", "0 of 3 stamps look like stars", "advice: ",
                     psf=self.write("stars.fits", primary() + content + bytes(-(width * 3) % BLOCK)))
        few = b"".join(star + struct.pack(">dd", 100.0 * i, 100.0 * i * i) for i in range(3))
        content = content[:len(head)] + few
        answer = shearctl("measure", "--json", *self.options(psf=self.write("stars.fits", primary() + content +
                                                                            bytes(-(width * 3) % BLOCK))))
        self.assertIn(answer.code, (DONE, INPUT))


class Pixels(Hostile):
    def test_values(self):
        self.left_out("empty", 72, image=self.filled(7.0))
        self.left_out("empty", 72, image=self.filled(7.0), noise="white")
        self.left_out("hole", 72, image=self.filled(math.nan))
        self.left_out("hole", 72, image=self.filled(math.inf))
        for value in (1e308, -1e308, 1e-320):
            answer = shearctl("measure", "--json", *self.options(image=self.filled(value, -64)))
            self.assertFails(answer, INPUT, "0 of 72 stamps are usable")

    def test_weights_and_masks(self):
        self.left_out("hole", 72, weight=self.filled(0.0))
        self.left_out("hole", 72, weight=self.filled(math.nan))
        self.left_out("hole", 72, mask=self.filled(1.0))
        self.left_out("hole", 72, "--mask-bad", "zero", mask=self.filled(0.0))
        self.left_out("neighbour", 72, segmentation=self.filled(5, 32))
        self.left_out("neighbour", 72, segmentation=self.filled(math.nan))

    def test_sizes(self):
        """Chips that are smaller than the stamp, of one pixel, and of none."""
        for sides in ([(1, 1)], [(1, 1), (1, 1)], [(10, 10), (10, 10)], [(40, 700), (700, 40)], [(47, 47), (63, 63)]):
            chips = [Image(image(f"CHIP{i + 1}", side, [float(k % 13) for k in range(side[0] * side[1])]))
                     for i, side in enumerate(sides)]
            path = write_images(self.path("small.fits"), chips)
            sources = self.write("small.cat", ldac([(c, [("X_IMAGE", "D", [c.nx / 2 + 0.5]), ("Y_IMAGE", "D", [1.0])])
                                                    for c in chips]))
            with self.subTest(sides):
                self.left_out("edge", len(chips), image=path, sources=sources)
        for nx, ny, words in ((0, 0, "no 2-D image"), (2 ** 31, 2 ** 31, "NAXIS"), (60000, 60000, "bytes")):
            head = header([("XTENSION", "IMAGE"), ("BITPIX", -32), ("NAXIS", 2), ("NAXIS1", nx), ("NAXIS2", ny),
                           ("PCOUNT", 0), ("GCOUNT", 1), ("EXTNAME", "CHIP1")])
            self.refused("sizes.fits", words, image=self.write("sizes.fits", primary() + head))
        self.refused("cut.fits", "CHIP1", "truncated", image=self.write("cut.fits", read(self.path("exp.fits"))[:10 ** 6]))

    def test_sixty_chips(self):
        """One catalog of them all, most of whose sources are elsewhere, is not kept for each chip."""
        many, number = primary(), 0
        for _ in range(30):
            for chip in self.sky:
                number += 1
                name = card("EXTNAME", f"C{number:02}").decode()
                chip.cards = [name if c.startswith("EXTNAME") else c for c in chip.cards]
                many += chip.bytes()
        path = self.write("many.fits", many)
        answer = shearctl("measure", "--json", *self.options(image=path), timeout=60 * PATIENCE)
        self.assertCode(answer, DONE)
        self.assertEqual(answer.json()[0]["n_stamps"], 30 * 72)
        truth = self.truth()
        places = list(zip(truth["RA"], truth["DEC"])) + [(150.1 + 0.01 * i, 5.0) for i in range(1000)]
        sources = self.big(self.path("big.cat"), 200000,
                           lambda i: (i, *places[i % 1000 if i > 71 else i], 0 if i < 72 else 4))
        code, bytes_ = self.peak(*self.options(image=path, sources=sources))
        self.assertEqual(code, DONE)
        if not SANITIZED:
            self.assertLess(bytes_, 150 * MEGABYTE)


class WrongWayRound(Hostile):
    def test_exchanged(self):
        exposure, sources, psf = (self.path(name) for name in ("exp.fits", "exp.cat", "psf.fits"))
        self.refused("exp.cat", "has no 2-D image: it cannot be the image", image=sources, sources=exposure)
        self.refused("exp.fits", "has no binary table", "give a catalog", sources=exposure)
        self.refused("exp.fits", "2 images, none of which is called PSF", psf=exposure)
        self.refused("exp.cat", "holds no PSF", "PSFEx", psf=sources)
        self.refused("exp.cat", "RA and Dec only", "--wcs", image=psf)
        self.refused("psf.fits", "has no binary table", sources=psf)

    def test_one_file_twice(self):
        exposure, mask = self.path("exp.fits"), self.path("exp.mask.fits")
        for part in ("weight", "mask", "segmentation"):
            self.refused("exp.fits", "HDU CHIP1", f"image and {part} are the same HDU", **{part: exposure})
        self.refused("exp.fits", "both as image and as noise", "--noise near", noise=exposure)
        self.left_out("hole", 72, weight=mask, mask=mask)

    def test_hdus(self):
        exposure, sources = self.path("exp.fits"), self.path("exp.cat")
        for hdu, words in (("7", "no HDU number 7"), ("0", "HDU 0 is no 2-D image"), ("CHIP9", "CHIP1, CHIP2")):
            self.refused("exp.fits", words, image=f"{exposure}:{hdu}")
        self.refused("exp.cat", "no HDU 2", sources=f"{sources}:2")
        self.refused("psf.fits", "no HDU number 9", psf=self.path("psf.fits") + ":9")
        self.assertIn("from 0 to", shearctl("measure", *self.options(image=f"{exposure}:{10 ** 20}")).err)

    def test_what_is_no_file(self):
        os.mkfifo(self.path("fifo"))
        secret = self.write("secret", b"x")
        os.chmod(secret, 0)
        text, empty = self.write("text", b"hello world\n" * 100), self.write("empty", b"")
        for part in PARTS:
            with self.subTest(part):
                self.refused("is a directory", **{part: self.directory})
                self.refused("is a FIFO", **{part: self.path("fifo")})
                self.refused("is a device", **{part: "/dev/zero"})
                self.refused("cannot be opened: No such file", **{part: self.path("nothing")})
                self.refused(text, **{part: text})
                self.refused(empty, **{part: empty})
                if os.geteuid() != 0:
                    self.refused("Permission denied", **{part: secret})

    def test_settings(self):
        for option, value, words in (("stamp", "7", "8"), ("stamp", "1025", "1024"), ("noise-stamps", "65", "64"),
                                     ("origin", "2", "0 to 1"), ("frame", "galactic", "sky"),
                                     ("psf-kind", "shapelets", "psfex"),
                                     ("mask-bad", "bits=x", "bits"), ("mask-bad", "bits=-1", "bits"),
                                     ("weight-kind", "sigma", "rms"), ("columns", "x", "="), ("columns", "flux=A", "flux"),
                                     ("select", "NUMBER <", "NUMBER <"), ("select", "NOWHERE > 1", "no column 'NOWHERE'"),
                                     ("select", "gtifilter()", "gtifilter"), ("columns", "x=A", "y")):
            with self.subTest(option=option, value=value):
                answer = shearctl("measure", *self.options(mask=self.path("exp.mask.fits")), f"--{option}", value)
                self.assertNotEqual(answer.code, DONE)
                self.assertRegex(answer.err, r"^shearctl: error: ")
                self.assertIn(words, answer.err)


if __name__ == "__main__":
    unittest.main()
