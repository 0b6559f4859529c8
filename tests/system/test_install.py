#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What an installation and the Debian package consist of, and that programs find their parts wherever they lie: nothing of
the build directory or of its prefix may be in them. BUILD is the build directory, CMAKE the program."""
import gzip
import os
import re
import shutil
import tempfile
import unittest

from daemon import DaemonTest, measured, mock, until
from install import BUILD, CMAKE, CPACK, files_of, installed_and_moved, run
from tool import SANITIZED


class Installed(DaemonTest):
    """Beneath a prefix that was not known when it was built, and moved from there once more."""

    def setUp(self):
        super().setUp()
        self.prefix = installed_and_moved(self.directory)

    def path(self, *names):
        return os.path.join(self.prefix, *names)

    def installed(self):
        daemon = self.daemon(start=False, name="service")
        daemon.program = self.path("sbin/sheard")
        return daemon

    def test_the_service_finds_its_reader(self):
        daemon = self.installed().start()
        source = mock(os.path.join(daemon.data, "a.fits"))
        daemon.drop(source, "a.fits")
        until(lambda: daemon.dropped("done"), "the dropped file is measured")
        self.assertRow(daemon, "a", measured([source]), 1)

    def test_without_its_reader_it_does_not_start_and_says_where_it_looked(self):
        os.remove(self.path("libexec/sheard/sheard-reader"))
        daemon = self.installed().spawn()
        self.assertEqual(daemon.ended(), 1)
        self.assertIn(f"sheard-reader is neither in {self.path('sbin')} nor at {self.path('sbin')}/../libexec/sheard/",
                      daemon.log_text())

    def test_it_finds_its_configuration(self):
        sheard, own = self.path("sbin/sheard"), self.path("etc/sheard/sheard.conf")
        self.assertIn(f"(default {own})", run(sheard, "--help"))
        with open(own, "a", encoding="utf-8") as file:
            file.write("\n[daemon]\nworkers = 7\n")
        self.assertIn("workers = 7", run(sheard, "--print-config"))
        run(CMAKE, "--install", BUILD, "--prefix", self.prefix)
        self.assertIn("workers = 7", run(sheard, "--print-config"), "a new installation replaced the administrator's file")
        os.remove(own)
        self.assertIn("(default /etc/sheard/sheard.conf)", run(sheard, "--help"))


@unittest.skipIf(SANITIZED, "nobody packages programs with sanitizers")
@unittest.skipUnless(shutil.which("dpkg-shlibdeps"), "dpkg-dev is not installed")
class Packages(unittest.TestCase):
    """`cpack -G DEB` in this build directory, whatever its prefix."""

    NAMES = ("libshear0", "libshear-dev", "sheard")
    DOCUMENTS = ("README.md", "copyright", "changelog.gz", "CHANGELOG.md", "home-data.conf", "config/sheard.conf",
                 "docs/field-files.md", "docs/method.md", "docs/protocol.md", "docs/protocol.schema.json")

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        run(CPACK, "-G", "DEB", "-B", directory.name, cwd=BUILD)
        cls.debs = {name.split("_")[0]: os.path.join(directory.name, name) for name in os.listdir(directory.name)
                    if name.endswith(".deb")}
        cls.roots = {name: os.path.join(directory.name, name) for name in cls.debs}
        for name, deb in cls.debs.items():
            run("dpkg-deb", "-R", deb, cls.roots[name])
        cls.files = {name: files_of(root) for name, root in cls.roots.items()}
        cls.root = cls.roots["sheard"]

    def text(self, name, package="sheard"):
        with open(os.path.join(self.roots[package], name), encoding="utf-8") as file:
            return file.read()

    def field(self, package, name):
        return run("dpkg-deb", "-f", self.debs[package], name).strip()

    def test_there_are_three(self):
        self.assertEqual(sorted(self.debs), sorted(self.NAMES))
        self.assertEqual(len({self.field(name, "Version") for name in self.NAMES}), 1)
        files = [name for package in self.NAMES for name in self.files[package] if not name.startswith("DEBIAN/")]
        self.assertEqual(len(files), len(set(files)), "two packages have a file in common")

    def test_its_parts_are_where_they_are_looked_for(self):
        for name in ("usr/sbin/sheard", "usr/bin/shearctl", "usr/libexec/sheard/sheard-reader", "etc/sheard/sheard.conf",
                     "usr/lib/systemd/system/sheard.service", "usr/lib/systemd/system/sheard.socket",
                     "usr/lib/systemd/system/sheard.path", "usr/lib/sysusers.d/sheard.conf",
                     "usr/lib/tmpfiles.d/sheard.conf"):
            self.assertIn(name, self.files["sheard"])
        self.assertIn("(default /etc/sheard/sheard.conf)", run(os.path.join(self.root, "usr/sbin/sheard"), "--help"))
        self.assertIn("--config /etc/sheard/sheard.conf\n", self.text("usr/lib/systemd/system/sheard.service"))
        self.assertFalse([name for name in self.files["sheard"] if not re.match("usr/|etc/sheard/|DEBIAN/", name)])

    def test_the_library_and_what_is_needed_to_build_on_it(self):
        for package in self.NAMES:
            names = [name for name in self.files[package] if re.search(r"/libshear\.so|/include/|\.pc$|\.cmake$", name)]
            libraries = [name for name in names if "/libshear.so." in name]
            if package == "libshear0":
                self.assertEqual(names, libraries)
                self.assertIn("libshear.so.0", {os.path.basename(name) for name in libraries})
            elif package == "libshear-dev":
                self.assertFalse(libraries)
                for wanted in ("/libshear.so", "/include/shear.h", "/libshear.pc", "/shear-config.cmake"):
                    self.assertTrue([name for name in names if name.endswith(wanted)], wanted)
                self.assertIn("usr/share/doc/libshear-dev/examples/arrays.c", self.files[package])
            else:
                self.assertFalse(names)

    @unittest.skipUnless(shutil.which("doxygen"), "doxygen is not installed (scripts/setup test)")
    def test_reference_pages(self):
        for name in ("usr/share/man/man3/shear_plan_new.3.gz", "usr/share/doc/libshear-dev/html/index.html"):
            self.assertIn(name, self.files["libshear-dev"])

    def test_nothing_of_the_build_is_in_it(self):
        """/usr/local is the default prefix; the client only looks for programs there, and systemd documents do."""
        for package in self.NAMES:
            for name in self.files[package]:
                if os.path.islink(os.path.join(self.roots[package], name)):
                    continue
                with open(os.path.join(self.roots[package], name), "rb") as file:
                    content = file.read()
                content = gzip.decompress(content) if name.endswith(".gz") else content
                for place in (BUILD, "/usr/local/libexec", "/usr/local/etc", "/usr/local/lib", "/usr/local/share"):
                    self.assertNotIn(place.encode(), content, name)

    def test_manual_pages_are_compressed_and_name_the_configuration(self):
        for name in ("man1/shearctl.1", "man5/sheard.conf.5", "man8/sheard.8"):
            with gzip.open(os.path.join(self.root, "usr/share/man", name + ".gz"), "rt", encoding="utf-8") as file:
                page = file.read()
            if "shearctl" not in name:
                self.assertIn("/etc/sheard/sheard.conf", page)

    def test_documents(self):
        for name in self.DOCUMENTS:
            self.assertIn("usr/share/doc/sheard/" + name, self.files["sheard"])
        for package in self.NAMES:
            for name in ("copyright", "changelog.gz"):
                self.assertIn(f"usr/share/doc/{package}/{name}", self.files[package])

    def test_control(self):
        self.assertEqual(self.text("DEBIAN/conffiles"), "/etc/sheard/sheard.conf\n")
        self.assertEqual(self.text("DEBIAN/triggers", "libshear0"), "activate-noawait ldconfig\n")
        self.assertRegex(self.text("DEBIAN/shlibs", "libshear0"), r"^libshear 0 libshear0 \(>= \S+\)\n$")
        self.assertRegex(self.field("sheard", "Depends"), "systemd.*libcfitsio.*libsqlite3")
        self.assertRegex(self.field("libshear0", "Depends"), "libcfitsio.*libfftw3")
        self.assertNotIn("shear", self.field("sheard", "Depends"))
        self.assertEqual(self.field("libshear-dev", "Depends"), f"libshear0 (= {self.field('libshear0', 'Version')})")

    def test_the_single_package_of_0_1_is_replaced(self):
        for package in ("libshear0", "libshear-dev"):
            for field in ("Breaks", "Replaces"):
                older = re.fullmatch(r"sheard \(<< (\S+)\)", self.field(package, field))[1]
                run("dpkg", "--compare-versions", "0.1.0", "lt", older)
                run("dpkg", "--compare-versions", self.field("sheard", "Version"), "ge", older)

    @unittest.skipUnless(shutil.which("lintian"), "lintian is not installed (scripts/setup boot)")
    def test_lintian_says_nothing(self):
        self.assertEqual(run("lintian", "--allow-root", "--fail-on", "error,warning", *self.debs.values()), "")


if __name__ == "__main__":
    unittest.main()
