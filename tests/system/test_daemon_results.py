# SPDX-License-Identifier: GPL-3.0-or-later
"""The service's results are those of `shearctl measure --json`, key by key: of a job and of its field,
for many settings and kinds of files.

What differs by nature:
  seconds        how long it took, in all and of each file
  estimators     both of them: measure's alone
  the row's own  digest, jobs, unfinished, partial, running, updated, contributions, more,
                 files_left_out, reason, culprit: measure has no jobs"""
import json
import math
import os
import subprocess
import unittest

import daemon
from daemon import SHEARCTL, DaemonTest, mock, until
from fitsfile import Field, gaussian

TIMED = ("seconds",)
MEASURE_ONLY = ("estimators",)
ROW_ONLY = {"digest", "jobs", "unfinished", "partial", "running", "updated", "contributions", "more",
            "files_left_out", "reason", "culprit"}

# Each: the options of the mock, the options of measure. The first ones are the files' kinds with the
# default settings, the others settings.
CASES = [
    ((), {}),
    (("--white", "0.3"), {}),
    (("--noise-ratio", "0.2"), {}),
    (("--white", "0.3", "--noise-stamps", "3"), {}),
    (("--no-r-gal",), {}),
    (("--no-r-gal", "--stamps", "200", "--white", "0.3"), {}),  # the core is found from the galaxies
    (("--psf-per-stamp",), {}),
    (("--psf-ids", "3"), {}),
    (("--layout", "mosaic"), {}),
    (("--bitpix", "-64"), {}),
    (("--r-psf", "0.8"), {"oversample": 8}),
    (("--psf", "b"), {}),
    (("--galaxy", "irregular"), {}),
    (("--rotate", "4"), {}),
    (("--shear", "0,0"), {}),
    (("--photons", "100"), {"background": "noise-mean"}),
    (("--photons", "100", "--subtract-background"), {}),
    ((), {"interpolation": "bilinear"}),
    ((), {"interpolation": "bicubic", "oversample": 2}),
    ((), {"interpolation": "spline", "oversample": 4}),
    ((), {"interpolation": "log-bicubic", "oversample": 2, "zeros": "floor"}),
    ((), {"interpolation": "log-spline", "oversample": 2, "pedestal": 0.5}),
    ((), {"beta": 2.5}),
    ((), {"beta-ratio": 1.7}),
    ((), {"filter": "none"}),
    (("--r-gal", "14"), {"filter": "none"}),  # its wings are cut off: warned
    (("--r-gal", "9"), {"core": 4.0, "width": 1.0}),  # the filter cuts the galaxy: warned
    ((), {"filter": "edge"}),
    ((), {"background": "noise-mean"}),
    ((), {"psf-threshold": 1e-6}),
    ((), {"power-tolerance": 0.01}),
    ((), {"noise-correction": False}),
    (("--white", "0.3"), {"shot-noise": "plateau"}),
    (("--white", "0.3"), {"estimator": "pdf-sym"}),
    (("--white", "0.3"), {"estimator": "pdf-sym-cross", "background": "noise-mean"}),
]


def options(settings):
    """As options of shearctl measure."""
    words = []
    for key, value in settings.items():
        if isinstance(value, bool):
            words.append(f"--{'' if value else 'no-'}{key}")
        else:
            words += [f"--{key}", str(value)]
    return words


def measure(paths, settings, *more):
    run = subprocess.run([SHEARCTL, "measure", "--json", "--quiet", *options(settings), *more, *paths],
                         check=True, capture_output=True, encoding="utf-8")
    return json.loads(run.stdout)


def without_times(report):
    report = {k: v for k, v in report.items() if k not in TIMED + MEASURE_ONLY}
    report["files"] = [{k: v for k, v in f.items() if k not in TIMED} for f in report["files"]]
    return report


class ResultsTest(DaemonTest):
    def assertSame(self, ours, theirs, what):
        self.assertEqual(list(ours), list(theirs), what)
        for key in theirs:
            self.assertEqual(ours[key], theirs[key], f"{what}: {key}")

    def assertSeconds(self, report):
        for at in (report, *report["files"]):
            self.assertTrue(math.isfinite(at["seconds"]) and at["seconds"] >= 0.0, at["seconds"])

    def row(self, d, field, **params):
        (row,) = d.call("field", field=field, **params)["rows"]
        self.assertEqual(ROW_ONLY - set(row), set())
        return row

    def report_of(self, row):
        return {k: v for k, v in row.items() if k not in ROW_ONLY}

    def test_jobs_and_fields(self):
        d = self.daemon()
        warned = found = 0
        for i, (how, settings) in enumerate(CASES):
            field = f"f{i}"
            path = mock(d.path("data", f"{i}.fits"), 48, 32, 1 + i, *how)
            expected = measure([path], settings, "--field", field)
            number = d.submit(path, field=field, settings=settings)["id"]
            job = d.wait_state(number, *daemon.FINAL)
            with self.subTest(how=how, settings=settings):
                self.assertEqual(job["state"], "done", job["message"])
                self.assertSame(without_times(job["result"]), without_times(expected), "job")
                row = self.report_of(self.row(d, field))
                self.assertSame(without_times(row), without_times(expected), "field")
                self.assertSeconds(job["result"])
                self.assertSeconds(row)
                self.assertIsNotNone(row["resolved"])
                self.assertIsNotNone(row["truth"])
            found += "200" in how and job["result"]["resolved"]["filter"] == "paper"
            warned += len(expected["warnings"])
        self.assertGreaterEqual(warned, 2, "no case of these warns: the test is blunt")
        self.assertEqual(found, 1, "no core was found from the galaxies: the test is blunt")

    def test_doubtful_psfs(self):
        """Warnings about PSFs are kept with the file, even when the job is no longer listed."""
        d = self.daemon({"retention.jobs_max_count": "1"})
        for own in (False, True):
            field = Field(n=4, name=f"own-{own}")
            bad = [p + 0.02 * max(field.psf) for p in field.psf]
            if own:
                field.psf_cube = [field.psf, bad, field.psf, [0.5] * len(bad)]
            else:
                field.psf = bad
            path = field.write(d.path("data", f"{own}.fits"))
            expected = measure([path], {}, "--field", field.name)
            self.assertEqual(len(expected["warnings"]), 1 + own)
            self.assertIn("the PSF's border is at 2 % of its peak", expected["warnings"][-1])
            job = d.wait_state(d.submit(path)["id"], "done")
            self.assertEqual(job["result"]["warnings"], expected["warnings"])
        until(lambda: len(d.jobs()) == 1, "a job is forgotten", step=0.1)
        self.assertEqual(len(self.row(d, "own-False")["warnings"]), 1)
        self.assertEqual(self.row(d, "own-True")["warnings"], expected["warnings"])

    def test_doubtful_psfs_of_later_files(self):
        """As `shearctl measure` of the files in this order reports them."""
        d, paths = self.daemon(), []
        for i, level in enumerate((0.0, 0.02, 0.0, 0.03)):
            field = Field(n=4 + i, name="several")
            field.psf = [p + level * max(field.psf) for p in field.psf]
            paths.append(field.write(d.path("data", f"{i}.fits")))
            d.wait_state(d.submit(paths[-1])["id"], "done")
        (words,) = self.row(d, "several")["warnings"]
        self.assertIn("2 of 3 files after the first have doubtful PSFs: " + paths[1], words)
        self.assertEqual([words], measure(paths, {}, "--field", "several")["warnings"])

    def several(self, d, field, *hows):
        """Files of one field, counted in this order."""
        paths = []
        for i, how in enumerate(hows):
            paths.append(mock(d.path("data", f"{field}{i}.fits"), 32, 32, 1 + i, *how))
            d.wait_state(d.submit(paths[-1], field=field)["id"], "done")
        return paths

    def test_several_files(self):
        d = self.daemon()
        truths = {"same": ((), ("--white", "0.2")), "other": ((), ("--shear", "0.02,0.01")),
                  "shapes": ((), ("--r-psf", "1.7"), ("--no-r-gal",))}
        for field, hows in truths.items():
            with self.subTest(field):
                paths = self.several(d, field, *hows)
                expected = measure(paths, {}, "--field", field)
                row = self.row(d, field)
                self.assertSame(without_times(self.report_of(row)), without_times(expected), field)
                self.assertEqual(row["truth"] is None, field == "other")
                self.assertEqual(row["files_left_out"], 0)
                self.assertAlmostEqual(row["seconds"], sum(f["seconds"] for f in row["files"]),
                                       places=5)

    def test_files_by_pages(self):
        d = self.daemon()
        paths = self.several(d, "p", (), (), (), ())
        whole = self.row(d, "p")
        self.assertEqual([f["path"] for f in whole["files"]], paths)
        seen, after = [], 0
        for left in (3, 3, 3, 3):
            page = self.row(d, "p", limit=1, after=after)
            self.assertEqual(page["files_left_out"], left)
            self.assertEqual((page["resolved"], page["truth"], page["warnings"], page["n_stamps"]),
                             (whole["resolved"], whole["truth"], whole["warnings"], whole["n_stamps"]))
            seen += page["files"]
            after = page["contributions"][-1]["id"]
        self.assertEqual(seen, whole["files"])
        none = self.row(d, "p", limit=0)
        self.assertEqual((none["files"], none["files_left_out"], none["resolved"]),
                         ([], 4, whole["resolved"]))

    def test_it_outlives_the_jobs_and_a_restart(self):
        d = self.daemon({"retention.jobs_max_count": "1"})
        paths = self.several(d, "r", (), ("--white", "0.2"), ())
        until(lambda: len(d.jobs()) == 1, "the jobs are forgotten", step=0.1)
        expected = measure(paths, {}, "--field", "r")
        self.assertSame(without_times(self.report_of(self.row(d, "r"))), without_times(expected), "r")
        d.kill()
        d.start()
        self.assertSame(without_times(self.report_of(self.row(d, "r"))), without_times(expected), "r")

    def test_a_duplicate_and_a_dropped_file(self):
        d = self.daemon()
        (path,) = self.several(d, "x", ())
        before = self.row(d, "x")
        again = d.wait_state(d.submit(path, field="x")["id"], "done")
        self.assertEqual(again["outcome"], "duplicate")
        after = self.row(d, "x")
        self.assertEqual((after["files"], after["seconds"]), (before["files"], before["seconds"]))
        d.drop(path, "dropped.fits")
        until(lambda: d.jobs(field="dropped", states=["done"]), "it is measured")
        (file,) = self.row(d, "dropped")["files"]
        self.assertEqual(os.path.basename(file["path"]), "dropped.fits")

    def test_no_shear(self):
        """Galaxy and noise swapped: the job is counted, and job and field give the reason as measure does."""
        d = self.daemon()
        path = mock(d.path("data", "swapped.fits"), 48, 32, 1, "--white", "0.3")
        parts = {"galaxy": {"path": path, "hdu": 2}, "noise": {"path": path, "hdu": 1},
                 "psf": {"path": path, "hdu": 3}}
        names = [w for name, p in parts.items() for w in (f"--{name}", f"{path}:{p['hdu']}")]
        run = subprocess.run([SHEARCTL, "measure", "--json", "--field", "s", *names], capture_output=True,
                             encoding="utf-8")
        self.assertEqual(run.returncode, 3)
        self.assertIn("swapped?", run.stderr)
        expected = json.loads(run.stdout)
        self.assertEqual((expected["no_shear"], expected["g1"]), ("swapped", None))
        job = d.wait_state(d.call("submit", field="s", **parts)["job"]["id"], *daemon.FINAL)
        self.assertEqual((job["state"], job["outcome"]), ("done", "counted"))
        self.assertSame(without_times(job["result"]), without_times(expected), "job")
        row = self.row(d, "s")
        self.assertSame(without_times(self.report_of(row)), without_times(expected), "row")
        for reason in (row["reason"], d.call("fields")["fields"][0]["reason"], d.shearctl("show", str(job["id"])),
                       d.shearctl("field", "s")):
            self.assertIn("swapped?", reason)

    def test_in_the_same_words(self):
        """show and field describe the processing in the lines of measure; a field's as ranges over its files."""
        d = self.daemon()
        paths = [mock(d.path("data", f"{r}.fits"), 64, 48, int(r), "--no-r-gal", "--white", "0.3", "--r-gal", r)
                 for r in ("4", "5")]
        names = "method", "filter", "background", "artefacts", "level", "influence"

        def lines(text):
            return [line for line in text.splitlines() if line.strip().split(" ")[0] in names]

        def told(*files):
            return lines(subprocess.run([SHEARCTL, "measure", "--field", "w", *files], capture_output=True,
                                        encoding="utf-8", check=True).stdout)

        for k, path in enumerate(paths):
            job = d.wait_state(d.submit(path, field="w")["id"], "done")
            self.assertEqual(lines(d.shearctl("show", str(job["id"]))), told(path))
            self.assertEqual(lines(d.shearctl("field", "w")), told(*paths[:k + 1]))
        self.assertEqual(len(told(*paths)), len(names))

    def test_a_psf_that_is_too_broad(self):
        """Of a job and of its field, as by measure; its counts leave the field with it."""
        d = self.daemon()
        field = Field(n=40, nx=48, ny=48, r_psf=1.5, name="b")
        field.galaxy[::5] = [gaussian(48, 48, 1000, (2.25, 2.25, 0.0)) for _ in range(8)]
        good = field.write(d.path("data", "good.fits"))
        field.psf = gaussian(48, 48, 1.0, (1.8 ** 2, 1.8 ** 2, 0.0))
        bad = field.write(d.path("data", "bad.fits"))
        first = d.wait_state(d.submit(good)["id"], "done")
        self.assertEqual(first["result"]["resolution"]["sharp"], 0)
        second = d.wait_state(d.submit(bad)["id"], "done")
        self.assertSame(without_times(second["result"]), without_times(measure([bad], {})), "job")
        self.assertIn("sharper than their PSF", "".join(second["result"]["warnings"]))
        both = self.report_of(self.row(d, "b"))
        self.assertEqual((both["resolution"]["bright"], both["resolution"]["sharp"]), (80, 8))
        self.assertIn("8 of 80 bright stamps", "".join(both["warnings"]))
        d.call("retract", id=second["id"])
        alone = self.report_of(self.row(d, "b"))
        self.assertEqual(alone["resolution"], first["result"]["resolution"])
        self.assertEqual(alone["warnings"], first["result"]["warnings"])

    def test_separate_parts(self):
        d = self.daemon()
        path = mock(d.path("data", "parts.fits"), 48, 32)
        parts = {"galaxy": {"path": path, "hdu": 1}, "noise": {"path": path, "hdu": 2},
                 "psf": {"path": path, "hdu": 3}}
        names = [w for name, p in parts.items() for w in (f"--{name}", f"{path}:{p['hdu']}")]
        expected = measure([], {}, "--field", "p", *names)
        job = d.call("submit", field="p", **parts)["job"]
        job = d.wait_state(job["id"], *daemon.FINAL)
        self.assertEqual(job["state"], "done", job["message"])
        self.assertSame(without_times(job["result"]), without_times(expected), "job")
        self.assertSame(without_times(self.report_of(self.row(d, "p"))), without_times(expected), "row")


if __name__ == "__main__":
    unittest.main()
