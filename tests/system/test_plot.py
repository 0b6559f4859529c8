# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl plot: pictures of field files and catalogs, their paths, and error messages."""
import os
import stat
import struct
import unittest
import zlib

from fitsfile import Field
from tool import DONE, INPUT, OTHER, USAGE, ToolTest, shearctl


def read_png(path):
    """Width, height and rows of a PNG of 8-bit colours; every checksum is checked."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    at, body, size = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        assert zlib.crc32(kind + chunk) == struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0]
        if kind == b"IHDR":
            size = struct.unpack(">IIBB", chunk[:10])
        if kind == b"IDAT":
            body += chunk
        at += 12 + length
    assert kind == b"IEND"
    width, height, depth, colour = size
    assert (depth, colour) == (8, 2)
    raw = zlib.decompress(body)
    assert len(raw) == height * (3 * width + 1)
    return width, height, raw


class Plot(ToolTest):
    def field(self, name="a.fits", **keys):
        return Field(**{"n": 6, **keys}).write(self.path(name))

    def plotted(self, *args, out="out.png"):
        answer = shearctl("plot", *args, "-o", self.path(out))
        self.assertCode(answer, DONE)
        self.assertEqual((answer.out, answer.err), (self.path(out) + "\n", ""))
        return read_png(self.path(out))

    def test_sheet_has_a_row_for_each_stamp(self):
        path = self.field()
        heights = [self.plotted(path, "--stamps", n, out=f"{n}.png")[1] for n in (1, 2, 5)]
        self.assertEqual(heights[2] - heights[0], 4 * (heights[1] - heights[0]))
        self.assertGreater(heights[1], heights[0])
        self.assertEqual(self.plotted(path)[1] - heights[0], 3 * (heights[1] - heights[0]))  # default 4
        self.assertEqual(self.plotted(path, "--stamps", 12, out="all.png")[1] - heights[0],
                         5 * (heights[1] - heights[0]))  # no more than there are

    def test_the_sheet_shows_what_the_settings_do(self):
        path = self.field()
        pictures = {self.plotted(path, "--stamp", 2, *more, out=f"{i}.png")[2]
                    for i, more in enumerate([[], ["--filter", "edge"], ["--interpolation", "spline"],
                                              ["--beta-ratio", "3"], ["--no-noise-correction"]])}
        self.assertEqual(len(pictures), 5)
        again = self.plotted(path, "--stamp", 2, out="again.png")[2]
        self.assertIn(again, pictures)  # the same picture, byte by byte

    def test_default_name_is_the_inputs_here(self):
        path = self.field("deep.field.fits")
        here = self.path("here")
        os.mkdir(here)
        answer = shearctl("plot", path, cwd=here)
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out, "deep.field.png\n")
        self.assertEqual(os.listdir(here), ["deep.field.png"])
        self.assertFails(shearctl("plot", path, cwd=here), OTHER, "deep.field.png exists", "--force")
        self.assertCode(shearctl("plot", "--force", path, cwd=here), DONE)

    def test_the_picture_follows_the_umask(self):
        before = os.umask(0o027)
        self.addCleanup(os.umask, before)
        self.plotted(self.field())
        self.assertEqual(stat.S_IMODE(os.stat(self.path("out.png")).st_mode), 0o640)

    def test_catalog(self):
        catalog = self.path("a.shear.fits")
        self.assertCode(shearctl("measure", self.field(n=40), "--catalog", catalog), DONE)
        width, height, raw = self.plotted(catalog)
        self.assertEqual((width, height), (1280, 840))
        self.assertGreater(len(set(raw[i:i + 3] for i in range(1, 200000, 3))), 20)
        self.assertFails(shearctl("plot", catalog, "--stamp", "1"), USAGE, "catalog")
        self.assertFails(shearctl("plot", catalog, "--beta", "3"), USAGE, "catalog")

    def test_stamps_that_are_left_out_can_be_looked_at(self):
        field = Field(n=3)
        field.columns = [("FLAGS", "J", [1, 1, 1])]
        path = field.write(self.path("masked.fits"))
        self.plotted(path)
        self.plotted(path, "--stamp", 2, out="one.png")

    def test_stamps_that_are_not_there(self):
        path = self.field()
        for number in ("6", "9223372036854775807"):
            self.assertFails(shearctl("plot", path, "--stamp", number), USAGE, number, "6")
        for wrong in (["--stamp", "-1"], ["--stamp", "x"], ["--stamps", "0"], ["--stamps", "13"]):
            self.assertFails(shearctl("plot", path, *wrong), USAGE, wrong[0].lstrip("-"))

    def test_usage(self):
        self.assertFails(shearctl("plot"), USAGE, "one file")
        self.assertFails(shearctl("plot", "a", "b"), USAGE, "one file")
        self.assertFails(shearctl("plot", "a", "--beta", "-1"), USAGE, "beta")
        self.assertFails(shearctl("plot", "a", "--outptu", "b"), USAGE, "--output")
        self.assertFails(shearctl("plot", self.field(), "--core", "3", "--filter", "none"), USAGE, "core")

    def test_bad_input(self):
        with open(self.path("text.fits"), "w", encoding="ascii") as file:
            file.write("no FITS at all")
        self.assertFails(shearctl("plot", self.path("text.fits")), INPUT, "neither a field file", "catalog")
        self.assertFails(shearctl("plot", self.path("missing.fits")), INPUT, "missing.fits")
        self.assertFails(shearctl("plot", self.directory), INPUT, "directory")
        os.mkfifo(self.path("fifo"))
        self.assertFails(shearctl("plot", self.path("fifo"), timeout=10), INPUT, "fifo")
        self.assertFails(shearctl("plot", self.field(), "--beta", "0.3"), INPUT, "beta", "smallest")
        self.assertEqual([n for n in os.listdir(self.directory) if n.endswith((".png", ".part"))], [])

    def test_the_input_is_never_replaced(self):
        path = self.field()
        with open(path, "rb") as file:
            before = file.read()
        os.symlink(path, self.path("link.png"))
        for out in (path, self.path("link.png")):
            self.assertFails(shearctl("plot", path, "--force", "-o", out), USAGE, "input")
        with open(path, "rb") as file:
            self.assertEqual(file.read(), before)

    def test_unwritable_output(self):
        path = self.field()
        for out in (self.path("none/x.png"), self.directory, "/dev/null"):
            self.assertFails(shearctl("plot", path, "--force", "-o", out), OTHER, out)
        self.assertFails(shearctl("plot", path, "-o", self.path("big.png"), file_size=1000), OTHER, "big.png")
        self.assertEqual(sorted(os.listdir(self.directory)), ["a.fits"])


if __name__ == "__main__":
    unittest.main()
