# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposures for tests: drawn by `shearctl expose`, with a PSF image made here, taken apart and changed; and the rows of
FITS tables."""
import array
import math
import os
import re
import struct
import sys

from fitsfile import TYPECODES, big_endian, header, hdus, image, pad, primary, table
from tool import DONE, ToolTest, shearctl

SIZES = {"L": 1, "A": 1, "B": 1, "I": 2, "J": 4, "K": 8, "E": 4, "D": 8}
FWHM = 3.8  # px, of shearctl expose
FLAG = {name: 1 << (10 + i) for i, name in enumerate(("edge", "hole", "saturated", "neighbour", "no_noise", "no_position"))}
PSF_UNUSABLE = 16


def cards_of(hdu):
    """The cards of an HDU, END left out, and where its data begin."""
    at, cards = 0, []
    while not hdu[at:at + 80].startswith(b"END     "):
        cards.append(hdu[at:at + 80].decode("ascii"))
        at += 80
    return cards, at + 80 + -(at + 80) % 2880


def keywords(hdu):
    cards, begin = cards_of(hdu)
    return {c[:8].strip(): c[10:].split(" /")[0].strip().strip("'").strip() for c in cards if c[8:10] == "= "}, begin


def columns(hdu):
    """A table's columns by name: lists of numbers."""
    keys, begin = keywords(hdu)
    width, n = int(keys["NAXIS1"]), int(keys["NAXIS2"])
    found, offset = {}, 0
    for i in range(1, int(keys["TFIELDS"]) + 1):
        count, kind = re.match(r"(\d*)(\w)", keys[f"TFORM{i}"]).groups()
        count = int(count or 1)
        if count == 1 and kind in "IJKED":
            form = ">" + kind.translate(str.maketrans("IJKED", "hiqfd"))
            found[keys[f"TTYPE{i}"]] = [struct.unpack_from(form, hdu, begin + row * width + offset)[0] for row in range(n)]
        offset += count * SIZES[kind]
    return found


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, content):
    with open(path, "wb") as file:
        file.write(content)
    return path


def catalog(path):
    """The columns of the last HDU of a file."""
    return columns(hdus(read(path))[-1][1])


class Image:
    """An image HDU, whose pixels can be changed: pixels[(y - 1) nx + x - 1] at (x, y)."""

    def __init__(self, hdu):
        self.cards, begin = cards_of(hdu)
        keys, _ = keywords(hdu)
        self.name, self.bitpix = keys.get("EXTNAME", ""), int(keys["BITPIX"])
        self.nx, self.ny = int(keys["NAXIS1"]), int(keys["NAXIS2"])
        self.pixels = array.array(TYPECODES[self.bitpix])
        self.pixels.frombytes(hdu[begin:begin + self.nx * self.ny * abs(self.bitpix) // 8])
        if sys.byteorder == "little":
            self.pixels.byteswap()

    def fill(self, x, y, value, half=0):
        """Set the pixel nearest to (x, y), and those within `half` of it."""
        for j in range(round(y) - half, round(y) + half + 1):
            for i in range(round(x) - half, round(x) + half + 1):
                self.pixels[(j - 1) * self.nx + i - 1] = value

    def bytes(self):
        head = b"".join(c.encode("ascii") for c in self.cards) + b"END".ljust(80)
        return pad(head, b" ") + pad(big_endian(self.pixels, self.bitpix))


def images(path):
    return [Image(hdu) for _, hdu in hdus(read(path))[1:]]


def write_images(path, chips):
    return write(path, primary() + b"".join(chip.bytes() for chip in chips))


def ldac(chips):
    """A FITS_LDAC catalog of (image, columns of its objects), the columns as for table()."""
    content = primary()
    for chip, objects in chips:
        cards = "".join(chip.cards) + "END".ljust(80)
        content += header([("XTENSION", "BINTABLE"), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", len(cards)), ("NAXIS2", 1),
                           ("PCOUNT", 0), ("GCOUNT", 1), ("TFIELDS", 1), ("TTYPE1", "Field Header Card"),
                           ("TFORM1", f"{len(cards)}A"), ("TDIM1", f"(80, {len(cards) // 80})"),
                           ("EXTNAME", "LDAC_IMHEAD")])
        content += pad(cards.encode("ascii")) + table("LDAC_OBJECTS", objects)
    return content


def psf_image(side=65, e1=0.02, e2=-0.01):
    """Moffat's profile of exponent 3.5, integrated over the pixels, as `shearctl expose --psf-variation 0` draws it."""
    alpha = 0.5 * FWHM / math.sqrt(2 ** (1 / 3.5) - 1)
    norm = math.sqrt(1 - e1 * e1 - e2 * e2) * alpha
    middle, pixels = side // 2, []
    nodes = ((-0.5 * math.sqrt(0.6), 5 / 18), (0.0, 8 / 18), (0.5 * math.sqrt(0.6), 5 / 18))
    for j in range(side):
        for i in range(side):
            value = 0.0
            for dy, wy in nodes:
                for dx, wx in nodes:
                    x, y = i - middle + dx, j - middle + dy
                    u, v = ((1 - e1) * x - e2 * y) / norm, (-e2 * x + (1 + e1) * y) / norm
                    value += wx * wy * (1 + u * u + v * v) ** -3.5
            pixels.append(value)
    return pixels


def psf_cube():
    """Two images with their places, as different as the mock's PSF from one side to the other."""
    flat = psf_image(33) + psf_image(33, 0.0, 0.03)
    return primary() + image("PSF", (33, 33, 2), flat, -64) + table("PLACES", [("X", "D", [200.0, 500.0]),
                                                                               ("Y", "D", [350.0, 350.0])])


class ExposureTest(ToolTest):
    """Exposures of two chips with bright galaxies far from each other, without defects, unless options say more."""
    DRAWN = ("--chips", "2x1", "--chip-size", 700, "--spacing", 110, "--galaxies", 60, "--stars", 0, "--bad-columns", 0,
             "--cosmic-rays", 0, "--flux", "100000,200000", "--psf-variation", 0, "--distortion", 0.05, "--rotation", 30,
             "--mirrored", "--fours", "--quiet", "--force")

    def draw(self, *options, name="exp"):
        """Draw an exposure, and make its catalog of RA, Dec and ellipses."""
        self.assertCode(shearctl("expose", self.path(name + ".fits"), *self.DRAWN, *options), DONE)
        truth, psf = self.truth(name), self.path("psf.fits")
        write(self.path(name + ".cat"), primary() + table("SOURCES", [
            ("NUMBER", "J", truth["NUMBER"]), ("RA", "D", truth["RA"]), ("DEC", "D", truth["DEC"]),
            *self.ellipses(len(truth["RA"]))]))
        if not os.path.exists(psf):
            write(psf, primary() + image("PSF", (65, 65), psf_image(), -64))
        return self.options(name)

    @staticmethod
    def ellipses(n):
        """Columns of circles of 9 px."""
        return [("A_IMAGE", "D", [3.0] * n), ("B_IMAGE", "D", [3.0] * n), ("THETA_IMAGE", "D", [0.0] * n)]

    def options(self, name="exp", **changed):
        """The options that say what is where; `changed` replaces, None leaves out."""
        parts = {"image": self.path(name + ".fits"), "sources": self.path(name + ".cat"),
                 "psf": self.path("psf.fits"), "stamp": 48, **changed}
        return [word for part, path in parts.items() if path is not None for word in (f"--{part}", path)]

    def truth(self, name="exp"):
        return catalog(self.path(name + ".truth.fits"))

    def measure(self, *options, keep="result"):
        """(JSON, columns) of a measurement that must go well."""
        path = self.path(keep + ".shear.fits")
        answer = self.measure_one(*options, "--quiet", "--catalog", path, "--force")
        return answer, catalog(path)

    def assertSameBits(self, one, other, but=()):
        """Of two measurements: numbers, flags and catalogs; columns in `but` may differ."""
        for answer in (one[0], other[0]):  # a field file has no chips to warn of
            answer["warnings"] = [line for line in answer["warnings"]
                                  if re.match(r"chip |\d+ of \d+ chips", line) is None]
        for key in one[0]:
            if key not in ("files", "seconds", "influence", "version", "field"):
                self.assertEqual(one[0][key], other[0][key], key)
        self.assertEqual(one[1].keys(), other[1].keys())
        for name, values in one[1].items():
            if name not in but:
                self.assertEqual(list(map(repr, values)), list(map(repr, other[1][name])), name)

    def flagged(self, result, name):
        """IDs of the rows with a flag."""
        bit = FLAG.get(name, PSF_UNUSABLE)
        return {int(i) for i, flags in zip(result[1]["ID"], result[1]["FLAGS"]) if flags & bit}
