# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job reads: galaxies, noise and PSF in separate files and HDUs, files that change while
they are read, and the rights with which they are opened when their turn comes."""
import json
import os
import subprocess
import sys
import unittest

import fitsfile
from daemon import (SLOW, SLOW_OPTIONS, DaemonTest, FINAL, content_of, measured, mock, numbers, stamps_for, until)
from tool import SHEARCTL
from test_daemon_access import OTHER, USER, as_user

PARTS = ("galaxy", "noise", "psf")


def options_of(parts):
    """A submit's parts as options of shearctl."""
    options = []
    for name, part in parts.items():
        hdu = part.get("extname", part.get("hdu"))
        options += [f"--{'catalog-in' if name == 'catalog' else name}",
                    part["path"] + ("" if hdu is None else f":{hdu}")]
    return options


def measured_parts(parts, *options):
    """The whole object of `shearctl measure --json` on these parts."""
    run = subprocess.run([SHEARCTL, "measure", "--json", *options, *options_of(parts)], check=True,
                         capture_output=True, encoding="utf-8")
    return json.loads(run.stdout)


class Sources(DaemonTest):
    def cut(self, daemon, stamps=12, seed=1, name="whole.fits"):
        """A mock field file, and the same cut into files of one extension each."""
        whole = mock(os.path.join(daemon.data, name), stamps, 32, seed)
        parts = {}
        for extname, content in fitsfile.hdus(content_of(whole))[1:]:
            path = os.path.join(daemon.data, f"{extname.lower()}-{seed}.fits")
            with open(path, "wb") as f:
                f.write(fitsfile.primary() + content)
            parts[extname.lower()] = {"path": path}
        return whole, parts


class Separate(Sources):
    def setUp(self):
        super().setUp()
        self.d = self.daemon()

    def test_equals_measure_to_the_last_bit(self):
        whole, parts = self.cut(self.d)
        expected = measured_parts(parts)
        self.assertEqual(numbers(expected), measured([whole]))
        job = self.d.call("submit", **parts, wait=True)["job"]
        self.assertEqual((job["state"], job["field"]), ("done", "galaxy-1"))
        self.assertEqual(numbers(job["result"]), numbers(expected))
        self.assertEqual(job["checksum"], expected["files"][0]["checksum"])
        self.assertEqual({k: v["path"] for k, v in job["source"].items() if v},
                         {k: v["path"] for k, v in parts.items()})
        self.assertRow(self.d, "galaxy-1", numbers(expected), 1)
        self.assertEqual(job["result"]["files"][0]["path"],
                         " + ".join(part["path"] for part in parts.values()))

    def test_every_way_of_naming_is_the_same_input(self):
        whole, parts = self.cut(self.d)
        first = self.d.call("submit", **parts, field="f", wait=True)["job"]
        named = {name: {**part, "extname": name.upper()} for name, part in parts.items()}
        numbered = {name: {**part, "hdu": 1} for name, part in parts.items()}
        for same in (named, numbered):
            job = self.d.call("submit", **same, field="f", wait=True)["job"]
            self.assertEqual((job["outcome"], job["duplicate_of"]), ("duplicate", first["id"]))
            self.assertEqual(measured_parts(same)["files"][0]["checksum"], first["checksum"])
        self.assertRow(self.d, "f", measured([whole]), 1)
        # All in one field file: that is the file, whichever way it comes.
        inside = {name: {"path": whole} for name in PARTS}
        job = self.d.call("submit", **inside, field="g", wait=True)["job"]
        again = self.d.submit(whole, field="g", wait=True)
        self.assertEqual((again["outcome"], again["duplicate_of"]), ("duplicate", job["id"]))
        # Another choice of HDUs is another input: noise and galaxies the other way round.
        swapped = {**inside, "galaxy": {"path": whole, "extname": "NOISE"},
                   "noise": {"path": whole, "extname": "GALAXY"}}
        job = self.d.call("submit", **swapped, field="g", wait=True)["job"]
        self.assertEqual((job["state"], job["outcome"]), ("done", "counted"))

    def test_catalog(self):
        _, parts = self.cut(self.d)
        rows = [("FLAGS", "J", [i % 3 for i in range(12)]), ("WEIGHT", "D", [1.5] * 12)]
        table = os.path.join(self.d.data, "stars.fits")
        with open(table, "wb") as f:
            f.write(fitsfile.primary() + fitsfile.table("STARS", rows))
        parts["catalog"] = {"path": table}
        expected = measured_parts(parts)
        self.assertEqual((expected["n_stamps"], expected["flags"]["masked"]), (12, 8))
        job = self.d.call("submit", **parts, wait=True)["job"]
        self.assertEqual(numbers(job["result"]), numbers(expected))
        self.assertEqual(job["source"]["catalog"], {"path": table, "hdu": None, "extname": None})

    def test_shearctl(self):
        _, parts = self.cut(self.d)
        run = subprocess.run([SHEARCTL, "submit", "--wait", "--json", *options_of(parts)],
                             env={**os.environ, "SHEARD_SOCKET": self.d.socket}, check=True,
                             capture_output=True, encoding="utf-8")
        job = json.loads(run.stdout)["job"]
        self.assertEqual(numbers(job["result"]), numbers(measured_parts(parts)))

    def test_another_catalog_for_a_field_file(self):
        whole, _ = self.cut(self.d)
        table = os.path.join(self.d.data, "cut.fits")
        with open(table, "wb") as f:
            f.write(fitsfile.primary() + fitsfile.table("CATALOG", [("FLAGS", "J", [i % 3 for i in range(12)])]))
        run = subprocess.run([SHEARCTL, "submit", "--wait", "--json", whole, "--catalog-in", table],
                             env={**os.environ, "SHEARD_SOCKET": self.d.socket}, check=True,
                             capture_output=True, encoding="utf-8")
        job = json.loads(run.stdout)["job"]
        self.assertEqual(job["result"]["flags"]["masked"], 8)
        self.assertEqual(job["field"], measured_parts({}, whole, "--catalog-in", table)["field"])

    def test_job_file_in_the_watch_folder(self):
        _, parts = self.cut(self.d)
        self.d.drop(None, "j.json", json.dumps({**parts, "field": "dropped"}).encode())
        missing = {**parts, "noise": {"path": self.d.data + "/no.fits"}}
        self.d.drop(None, "k.json", json.dumps(missing).encode())
        self.d.wait_idle()
        self.assertEqual(self.d.dropped("done"), ["j.json", "j.json.json"])
        self.assertRow(self.d, "dropped", numbers(measured_parts(parts)), 1)
        self.assertEqual(self.d.side("done", "j.json")["job"]["source"]["psf"]["path"],
                         parts["psf"]["path"])
        self.assertEqual(self.d.side("failed", "k.json")["code"], "no_such_file")

    def test_refusals(self):
        _, parts = self.cut(self.d)
        os.mkdir(os.path.join(self.d.data, "folder"))
        os.symlink(parts["psf"]["path"], os.path.join(self.directory, "link.fits"))
        cases = [("no_such_file", "noise.path", {"noise": {"path": self.d.data + "/no.fits"}}),
                 ("not_regular", "galaxy.path", {"galaxy": {"path": self.d.data + "/folder"}}),
                 ("outside_roots", "psf.path", {"psf": {"path": self.directory + "/link.fits"}}),
                 ("outside_roots", "catalog.path", {"catalog": {"path": "/etc/passwd"}}),
                 ("bad_parameter", "psf.hdu", {"psf": {**parts["psf"], "hdu": 1, "extname": "PSF"}}),
                 ("missing_parameter", "noise", {"noise": None})]
        for code, parameter, change in cases:
            with self.subTest(parameter=parameter), self.assertRefused(code) as caught:
                self.d.call("submit", **{**parts, **change})
            self.assertEqual(caught.exception.error["data"]["parameter"], parameter)
        self.assertEqual(self.d.jobs(), [])

    def test_parts_that_do_not_fit(self):
        _, parts = self.cut(self.d)
        _, other = self.cut(self.d, 11, 2, "other.fits")
        for change, word in (({"noise": other["noise"]}, "11 stamps"),
                             ({"psf": {**parts["psf"], "hdu": 7}}, "HDU number 7"),
                             ({"psf": {**parts["psf"], "extname": "KERNEL"}}, "no HDU KERNEL"),
                             ({"noise": parts["galaxy"]}, "both as galaxy and as noise"),
                             ({"galaxy": {**parts["galaxy"], "hdu": 0}}, "2 or 3 axes")):
            job = self.d.call("submit", **{**parts, **change}, wait=True)["job"]
            self.assertEqual((job["state"], job["class"], job["code"]),
                             ("failed", "data", "bad_file"), word)
            self.assertIn(word, job["message"])
        self.assertEqual(self.d.call("fields")["fields"], [])

    def test_a_part_that_goes(self):
        self.d.settings["daemon.max_active_jobs"] = 1
        self.d.write_config()
        self.d.call("reload")
        slow = mock(os.path.join(self.d.data, "slow.fits"), stamps_for(3, 32, *SLOW_OPTIONS), 32, 7)
        first = self.d.submit(slow, settings=SLOW)["id"]
        self.d.held(first)
        _, parts = self.cut(self.d)
        job = self.d.call("submit", **parts)["job"]["id"]
        os.rename(parts["psf"]["path"], parts["psf"]["path"] + ".away")
        self.d.call("cancel", id=first)
        self.d.go_on()
        job = self.d.wait_state(job, *FINAL)
        self.assertEqual((job["state"], job["class"], job["code"]),
                         ("failed", "transient", "file_vanished"))
        with self.assertRefused("no_such_file"):
            self.d.call("retry", id=job["id"])
        os.rename(parts["psf"]["path"] + ".away", parts["psf"]["path"])
        self.d.call("retry", id=job["id"])
        self.assertEqual(self.d.wait_state(job["id"], *FINAL)["state"], "done")

    def test_resumes_after_a_kill(self):
        _, parts = self.cut(self.d, stamps_for(4, 32, *SLOW_OPTIONS), 5)
        job = self.d.call("submit", **parts, settings=SLOW)["job"]["id"]
        until(lambda: self.d.job(job)["progress"]["done"], "it measures")
        self.d.kill()
        self.d.start()
        self.assertEqual(self.d.wait_state(job, *FINAL)["state"], "done")
        self.assertRow(self.d, "galaxy-5", numbers(measured_parts(parts, *SLOW_OPTIONS)), 1)


class Changing(Sources):
    """A separate process that writes to a file which is being measured."""

    def setUp(self):
        super().setUp()
        self.d = self.daemon({"retry.first_delay": "50ms"})

    def write(self, program, *arguments):
        """While the job waits in the middle of its measurement."""
        subprocess.run([sys.executable, "-c", program, *arguments], check=True)
        self.d.go_on()

    def running(self, **source):
        return self.d.held(self.d.call("submit", **source, settings=SLOW)["job"]["id"])

    def check(self, job, name, expected):
        """The attempt failed and was repeated, and only the second was counted."""
        job = self.d.wait_state(job, *FINAL)
        self.assertEqual(job["state"], "done", job)
        history = self.d.call("job", id=job["id"])["history"]
        self.assertEqual([(a["ending"], a["class"], a["code"]) for a in history],
                         [("failed", "transient", "file_changed"), ("done", None, None)])
        self.assertIn(name, history[0]["message"])
        self.assertRow(self.d, job["field"], expected, 1)

    def other(self, stamps):
        """Another field of the same size, out of the way."""
        return mock(os.path.join(self.directory, "other.fits"), stamps, 32, 99)

    def test_rewritten_in_place(self):
        """The same name, inode, size and time of modification: only the change time differs."""
        stamps = stamps_for(3, 32, *SLOW_OPTIONS)
        path = mock(os.path.join(self.d.data, "a.fits"), stamps, 32, 98)
        job = self.running(path=path)
        self.write("import os, sys\n"
                   "before = os.stat(sys.argv[1])\n"
                   "data = open(sys.argv[2], 'rb').read()\n"
                   "assert len(data) == before.st_size\n"
                   "with open(sys.argv[1], 'r+b') as f:\n"
                   "    f.write(data)\n"
                   "os.utime(sys.argv[1], ns=(before.st_atime_ns, before.st_mtime_ns))\n",
                   path, self.other(stamps))
        self.check(job, "a.fits", measured([path], *SLOW_OPTIONS))

    def test_replaced(self):
        stamps = stamps_for(3, 32, *SLOW_OPTIONS)
        path = mock(os.path.join(self.d.data, "a.fits"), stamps, 32, 98)
        job = self.running(path=path)
        self.write("import os, sys\nos.rename(sys.argv[2], sys.argv[1])\n", path, self.other(stamps))
        self.check(job, "a.fits", measured([path], *SLOW_OPTIONS))

    def test_one_of_several(self):
        _, parts = self.cut(self.d, stamps_for(3, 32, *SLOW_OPTIONS))
        job = self.running(**parts)
        self.write("import sys\nwith open(sys.argv[1], 'r+b') as f:\n"
                   "    f.seek(-2880, 2)\n    f.write(b'\\0' * 8)\n", parts["noise"]["path"])
        self.check(job, "noise-1.fits", numbers(measured_parts(parts, *SLOW_OPTIONS)))

    def test_truncated(self):
        """The reader fails at data that have been removed: the reason is the change, not bad
        data."""
        path = mock(os.path.join(self.d.data, "a.fits"), stamps_for(3, 32, *SLOW_OPTIONS), 32, 98)
        job = self.running(path=path)
        self.write("import sys\nopen(sys.argv[1], 'r+b').truncate(20000)\n", path)
        until(lambda: any(a["ending"] == "failed" for a in self.d.call("job", id=job)["history"]),
              "the attempt failed")
        first = self.d.call("job", id=job)["history"][0]
        self.assertEqual((first["class"], first["code"]), ("transient", "file_changed"))

    def test_gives_up(self):
        """A file that keeps changing: the job fails after the configured attempts, nothing is counted."""
        self.d.settings["retry.attempts"] = 2
        self.d.write_config()
        self.d.call("reload")
        path = mock(os.path.join(self.d.data, "a.fits"), stamps_for(2, 32, *SLOW_OPTIONS), 32, 98)
        job = self.d.submit(path, settings=SLOW)["id"]
        until(lambda: os.utime(path) or self.d.job(job)["state"] in FINAL, "it is given up",
              step=0.2)
        job = self.d.job(job)
        self.assertEqual((job["state"], job["class"], job["code"]),
                         ("failed", "transient", "file_changed"))
        self.assertEqual(self.d.call("fields")["fields"], [])


@unittest.skipUnless(os.getuid() == 0, "only root can become somebody else")
class Rights(Sources):
    """Files are opened with the groups that the peer had when it asked."""
    GROUP = 65510

    def setUp(self):
        super().setUp()
        self.d = self.daemon({"daemon.socket_mode": "0666", "daemon.max_active_jobs": 1})

    def shared(self, name="shared.fits"):
        path = mock(os.path.join(self.d.data, name), 8, 32)
        os.chown(path, 0, self.GROUP)
        os.chmod(path, 0o640)
        return path

    def submit_as(self, uid, groups, **source):
        as_user(self, uid, lambda: self.d.call("submit", **source, key="k"), groups)
        return next(job["id"] for job in self.d.jobs() if job["owner"] == uid)

    def busy(self):
        path = mock(os.path.join(self.d.data, "slow.fits"), stamps_for(3, 32, *SLOW_OPTIONS), 32)
        return self.d.held(self.d.submit(path, settings=SLOW)["id"])

    def test_groups_of_the_connection(self):
        path = self.shared()
        job = self.submit_as(USER, [self.GROUP], path=path)
        self.assertEqual(self.d.wait_state(job, *FINAL)["state"], "done")
        self.assertRow(self.d, "shared", measured([path]), 1)

    def test_they_are_kept_over_a_restart(self):
        self.busy()
        path = self.shared()
        job = self.submit_as(USER, [self.GROUP], path=path)
        self.d.kill()
        self.d.start()
        self.assertEqual(self.d.wait_state(job, *FINAL)["state"], "done")

    def test_no_other_groups(self):
        """The file is not measured if its user loses the rights between submission and start."""
        slow, path = self.busy(), self.shared()
        job = self.submit_as(USER, [self.GROUP], path=path)
        os.chown(path, 0, self.GROUP + 1)
        self.d.call("cancel", id=slow)
        self.d.go_on()
        job = self.d.wait_state(job, *FINAL)
        self.assertEqual((job["state"], job["class"], job["code"]),
                         ("failed", "data", "not_readable"))

    def test_every_part_by_itself(self):
        _, parts = self.cut(self.d)
        os.chmod(parts["noise"]["path"], 0o600)

        def ask():
            with self.assertRefused("not_readable") as caught:
                self.d.call("submit", **parts)
            self.assertEqual(caught.exception.error["data"]["parameter"], "noise.path")
        as_user(self, OTHER, ask)
        os.chown(parts["noise"]["path"], OTHER, OTHER)
        job = self.submit_as(OTHER, [], **parts)
        self.assertEqual(self.d.wait_state(job, *FINAL)["state"], "done")


if __name__ == "__main__":
    unittest.main()
