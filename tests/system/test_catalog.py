# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl measure --catalog: where the catalogs go, what is never overwritten, and outputs that
cannot be written."""
import os
import unittest

from fitsfile import Field
from tool import SANITIZED, DONE, OTHER, USAGE, ToolTest, shearctl


def read(path):
    with open(path, "rb") as f:
        return f.read()


class Places(ToolTest):
    def test_one_input_one_file(self):
        path = Field(n=5).write(self.path("a.fits"))
        out = self.path("out.fits")
        result = self.measure_one(path, "--catalog", out)
        self.assertEqual(sorted(os.listdir(self.directory)), ["a.fits", "out.fits"])
        text = read(out).decode("latin-1")
        self.assertIn("'SHEAR   '", text)
        self.assertIn("NAXIS2  =                    5", text)
        self.assertIn(result["files"][0]["checksum"], text)

    def test_existing_file_needs_force(self):
        path = Field(n=5).write(self.path("a.fits"))
        out = self.path("out.fits")
        with open(out, "w", encoding="ascii") as f:
            f.write("precious")
        answer = shearctl("measure", path, "--catalog", out)
        self.assertFails(answer, OTHER, "out.fits", "exists", "--force")
        self.assertEqual(answer.out, "")
        self.assertEqual(read(out), b"precious")
        self.measure_one(path, "--catalog", out, "--force")
        self.assertTrue(read(out).startswith(b"SIMPLE  ="))

    def test_directory(self):
        paths = [Field(n=3, seed=k).write(self.path(name))
                 for k, name in enumerate(("a.fits", "b.x.fits"))]
        os.mkdir(self.path("out"))
        self.measure_one(*paths, "--catalog", self.path("out"))
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["a.shear.fits", "b.x.shear.fits"])
        self.assertFails(shearctl("measure", *paths, "--catalog", self.path("out")), OTHER,
                         "a.shear.fits", "--force")
        self.measure_one(*paths, "--catalog", self.path("out"), "--force")

    def test_several_inputs_need_a_directory(self):
        paths = [Field(n=3, seed=k).write(self.path(f"{k}.fits")) for k in range(2)]
        self.assertFails(shearctl("measure", *paths, "--catalog", self.path("out")), USAGE,
                         "existing directory")
        self.assertFails(shearctl("measure", paths[0], "--catalog", self.path("out/")), OTHER,
                         "no such directory")
        self.assertEqual(len(os.listdir(self.directory)), 2)

    def test_inputs_of_the_same_name_clash(self):
        for name in "ab":
            os.mkdir(self.path(name))
        paths = [Field(n=3, seed=k).write(self.path(f"{d}/x.fits")) for k, d in enumerate("ab")]
        answer = shearctl("measure", *paths, "--catalog", self.directory)
        self.assertFails(answer, USAGE, "a/x.fits", "b/x.fits", "x.shear.fits")

    def test_never_onto_an_input(self):
        path = Field(n=3).write(self.path("a.fits"))
        before = read(path)
        os.symlink(path, self.path("link.fits"))
        for out in (path, self.path("link.fits")):
            self.assertFails(shearctl("measure", path, "--catalog", out, "--force"), USAGE, "input")
        self.assertEqual(read(path), before)


class Unwritable(ToolTest):
    def setUp(self):
        super().setUp()
        self.input = Field(n=200, nx=8, ny=8, size=0.8, r_psf=1.0).write(self.path("a.fits"))

    def check(self, out, *words):
        answer = shearctl("measure", self.input, "--catalog", out)
        self.assertFails(answer, OTHER, *words)
        self.assertEqual(answer.out, "")
        self.assertEqual(os.listdir(self.directory), ["a.fits"])

    def test_missing_directory(self):
        self.check(self.path("no/out.fits"), "no/out.fits", "No such file or directory")

    def test_file_as_directory(self):
        self.check(self.input + "/out.fits", "Not a directory")

    @unittest.skipUnless(os.path.isdir("/proc/self"), "needs /proc")
    def test_file_system_that_takes_no_files(self):
        self.check("/proc/self/out.fits", "out.fits")

    @unittest.skipUnless(os.path.exists("/dev/null"), "needs /dev/null")
    def test_device_is_not_replaced(self):
        answer = shearctl("measure", self.input, "--catalog", "/dev/null", "--force")
        self.assertFails(answer, OTHER, "regular file")
        self.assertFalse(os.path.isfile("/dev/null"))

    @unittest.skipIf(SANITIZED, "a thread sanitizer keeps files of its own, which this limit would cut")
    def test_file_that_grows_too_large(self):
        answer = shearctl("measure", self.input, "--catalog", self.path("out.fits"), file_size=9000)
        self.assertFails(answer, OTHER, "out.fits")
        self.assertEqual(os.listdir(self.directory), ["a.fits"])


class PlainNames(ToolTest):
    """CFITSIO's file-name syntax must not be obeyed: names are names."""

    def test_outputs(self):
        path = Field(n=3).write(self.path("a.fits"))
        for name in ("!b.fits", "b.fits(c.fits)", "b.fits[1]", "b.fits.gz"):
            with self.subTest(name=name):
                before = set(os.listdir(self.directory))
                answer = shearctl("measure", path, "--catalog", name, cwd=self.directory)
                self.assertCode(answer, DONE)
                self.assertEqual(set(os.listdir(self.directory)) - before, {name})
                self.assertTrue(read(self.path(name)).startswith(b"SIMPLE  ="))

    def test_inputs(self):
        for name in ("a.fits[1]", "a.fits(copy.fits)", "a.fits+1", "a.fits[galaxy]", "mem:a.fits",
                     "@a.fits"):
            with self.subTest(name=name):
                Field(n=3).write(self.path(name))
                answer = shearctl("measure", name, cwd=self.directory)
                self.assertCode(answer, DONE)
                self.assertIn("3 of 3 used", answer.out)
                self.assertEqual(os.listdir(self.directory), [name])
                os.unlink(self.path(name))


if __name__ == "__main__":
    unittest.main()
