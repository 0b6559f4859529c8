# SPDX-License-Identifier: GPL-3.0-or-later
"""What an operator sees: waiting jobs with the reason, disks, and ignored files; by status,
metrics, doctor and the log. FAULTSHIM (faultshim.c) makes disks fail."""
import gzip
import os
import re
import shutil
import subprocess
import unittest

from daemon import SHEARCTL, SHEARD, DaemonTest, content_of, mock, until
from test_daemon_clock import seconds

FAULTSHIM = os.path.abspath(os.environ["FAULTSHIM"])
SLOW = {"catalogues.enabled": "true", "retry.first_delay": "30s", "retry.max_delay": "1h"}
QUICK = {"catalogues.enabled": "true", "retry.first_delay": "100ms", "retry.max_delay": "200ms",
         "retry.attempts": "1000"}
NOBODY = 65534


def problems(status, about):
    return [p for p in status["problem_details"] if p["about"] == about]


class ProblemsTest(DaemonTest):
    def shearctl(self, d, *args):
        run = subprocess.run([SHEARCTL, *args, "--socket", d.socket], capture_output=True,
                             encoding="utf-8", errors="replace")
        return run.stdout

    def submit(self, d, n, first=0):
        """n jobs of different content."""
        numbers = []
        for i in range(first, first + n):
            path = mock(d.path("data", f"{i}.fits"), 16, 16, 1 + i)
            numbers.append(d.submit(path, field="f")["id"])
        return numbers

    def test_all_is_well(self):
        d = self.daemon({"catalogues.enabled": "true"})
        status = d.call("status")
        self.assertEqual((status["problems"], status["problem_details"]), ([], []))
        self.assertEqual([x["use"] for x in status["disks"]],
                         ["state", "spool", "catalogues", "scratch"])
        for x in status["disks"]:
            self.assertGreater(x["free_bytes"], 0)
            self.assertGreater(x["bytes"], x["free_bytes"])
            self.assertIsNone(x["problem"])
            if x["use"] != "scratch":  # it may lie on a disk of its own
                self.assertEqual(x["same_as"], None if x["use"] == "state" else "state")
        self.assertEqual(status["log"]["lost"], 0)
        self.assertEqual(status["spool"]["ignored"], 0)
        self.assertIn("on the disk of state", self.shearctl(d, "status"))

    def test_a_directory_is_gone(self):
        d = self.daemon(SLOW)
        os.rename(d.path("catalogues"), d.path("away"))
        numbers = self.submit(d, 3)
        for number in numbers:
            job = d.wait_state(number, "waiting")
        status = d.call("status")
        self.assertEqual(status["states"]["waiting"], 3)
        (waiting,) = problems(status, "jobs")
        self.assertEqual((waiting["code"], waiting["count"], waiting["attempts"]),
                         (job["code"], 3, 1))
        first = min(seconds(d.job(number)["not_before"]) for number in numbers)
        self.assertAlmostEqual(seconds(waiting["next_attempt"]), first, places=2)
        self.assertLessEqual(seconds(waiting["since"]), first)
        self.assertEqual([p["message"] for p in status["problem_details"]], status["problems"])
        (disk,) = [x for x in status["disks"] if x["use"] == "catalogues"]
        self.assertIn("No such file", disk["problem"])
        self.assertEqual([p["code"] for p in problems(status, "disk")], ["unusable"])
        text = self.shearctl(d, "status")
        self.assertRegex(text, r"problem +3 jobs wait \(\w+\): .*1 attempts so far; next attempt in ")
        self.assertIn("3 jobs wait", self.shearctl(d, "doctor"))
        self.assertIn("3 jobs wait", self.shearctl(d, "watch", "--count", "1"))
        metrics = d.call("metrics")["text"]
        self.assertIn(f'sheard_waiting_jobs{{reason="{job["code"]}"}} 3\n', metrics)
        self.assertIn('sheard_disk_usable{use="catalogues"} 0\n', metrics)
        # Each is in the log, with its reason and the time of the next attempt.
        for number in numbers:
            self.assertRegex(d.log_text(), rf"job {number} \(f\) waits: .*{job['code']}, attempt 1\);"
                             r" it is tried again at 20\d\d-\d\d-\d\dT")

    def test_it_goes_by(self):
        d = self.daemon(QUICK)
        os.rename(d.path("catalogues"), d.path("away"))
        (number,) = self.submit(d, 1)
        until(lambda: problems(d.call("status"), "jobs"), "it is told")
        since = problems(d.call("status"), "jobs")
        os.rename(d.path("away"), d.path("catalogues"))
        d.wait_state(number, "done")
        self.assertEqual(d.call("status")["problems"], [])
        self.assertTrue(since[0]["since"])

    def test_the_log_is_not_flooded(self):
        d = self.daemon(QUICK)
        os.rename(d.path("catalogues"), d.path("away"))
        numbers = self.submit(d, 10)
        until(lambda: all(d.job(n)["attempts"] >= 4 for n in numbers), "all were tried often")
        lines = re.findall(r"waits: ", d.log_text(1 << 20))
        self.assertTrue(5 <= len(lines) <= 15, len(lines))

    def test_a_full_disk(self):
        d = self.daemon(SLOW, preload=FAULTSHIM)
        self.assertEqual(d.stop(), 0)  # what is written there once is there
        d.env.update(FAULT_BELOW=d.path("catalogues"), FAULT_CALLS="s", FAULT_AT="1",
                     FAULT_LENGTH="1000000000", FAULT_HOW="ENOSPC")
        d.start()
        (number,) = self.submit(d, 1)
        d.wait_state(number, "waiting")
        (waiting,) = problems(d.call("status"), "jobs")
        self.assertEqual(waiting["code"], "disk_full")
        self.assertRegex(d.log_text(), rf"job {number} \(f\) waits: ")

    def test_a_full_state(self):
        """Nothing can be stored: status shows since when, how often, and that it is tried again."""
        d = self.daemon(SLOW, preload=FAULTSHIM, start=False)
        d.env.update(FAULT_BELOW=d.state, FAULT_CALLS="w", FAULT_AT="60", FAULT_HOW="ENOSPC",
                     FAULT_LENGTH="1000000000")
        d.start()
        path = mock(d.path("data", "a.fits"), 16, 16)

        def refused():
            try:
                d.submit(path, force=True)
            except Exception as e:
                return e
        until(refused, "the disk is full", 60)
        (trouble,) = until(lambda: problems(d.call("status"), "store"), "it is told")
        self.assertIn(trouble["code"], ("disk_full", "io"))
        self.assertGreaterEqual(trouble["count"], 1)
        self.assertTrue(trouble["since"] and trouble["next_attempt"])

    def test_permission_is_lost(self):
        d = self.daemon(SLOW, start=False)
        os.chmod(d.directory, 0o777)
        if os.geteuid() == 0:
            if shutil.which("setpriv") is None:
                self.skipTest("setpriv is not installed, and root may write everywhere")
            d.program = d.path("as-nobody")
            with open(d.program, "w", encoding="ascii") as f:
                f.write(f"#!/bin/sh\nexec setpriv --reuid={NOBODY} --regid={NOBODY} --clear-groups "
                        f"{SHEARD} \"$@\"\n")
            os.chmod(d.program, 0o755)
            probe = subprocess.run([d.program, "--version"], capture_output=True)
            if probe.returncode != 0:
                self.skipTest("nobody may not run it from where it lies")
        d.start()
        path = mock(d.path("data", "a.fits"), 16, 16)
        os.chmod(path, 0o644)
        os.chmod(d.path("catalogues"), 0o555)
        self.addCleanup(os.chmod, d.path("catalogues"), 0o755)
        number = d.submit(path, field="f")["id"]
        d.wait_state(number, "waiting")
        status = d.call("status")
        (disk,) = [x for x in status["disks"] if x["use"] == "catalogues"]
        self.assertIn("Permission denied", disk["problem"])
        (waiting,) = problems(status, "jobs")
        self.assertEqual((waiting["code"], waiting["count"]), ("io", 1))

    def test_the_watch_folder_is_gone(self):
        d = self.daemon()
        os.rename(d.spool, d.spool + ".away")
        (trouble,) = until(lambda: [p for p in problems(d.call("status"), "spool") if p["since"]],
                           "it is told")
        self.assertIn("watch folder", trouble["message"])
        os.rename(d.spool + ".away", d.spool)
        until(lambda: d.call("status")["problems"] == [], "it is there again")

    def test_left_lying(self):
        d = self.daemon()
        path = os.fsencode(d.folder("incoming"))
        os.symlink("/etc/passwd", os.path.join(path, b"link.fits"))
        os.mkfifo(os.path.join(path, b"pipe.fits"))
        os.mkdir(os.path.join(path, b"folder.fits"))
        for name in (b"notes.txt", b"a.fits.bz2", b"caf\xe9.fits", b"x" * 230 + b".fits",
                     b"new\nline.fits"):
            with open(os.path.join(path, name), "wb"):
                pass
        spool = until(lambda: (s := d.call("status")["spool"])["ignored"] == 8 and s, "all are told")
        reasons = {x["name"]: x["reason"] for x in spool["left_lying"]}
        self.assertEqual(len(reasons), 8)
        for name, reason in (("link.fits", "symbolic link"), ("pipe.fits", "named pipe"),
                             ("folder.fits", "directory"), ("notes.txt", "ends neither"),
                             ("a.fits.bz2", "ends neither"), ("caf\ufffd.fits", "not UTF-8"),
                             ("x" * 230 + ".fits", "too long"), ("new\nline.fits", "control")):
            self.assertIn(reason, reasons[name])
        (told,) = problems(d.call("status"), "incoming")
        self.assertEqual((told["code"], told["count"]), ("ignored_files", 8))
        text = self.shearctl(d, "status")
        self.assertIn("left lying", text)
        self.assertIn("folder.fits: it is a directory", text)
        self.assertNotIn("new\nline", text)
        self.assertIn("sheard_incoming_ignored 8\n", d.call("metrics")["text"])
        for i in range(20):
            open(d.folder("incoming", f"more{i}.txt"), "w").close()
        spool = until(lambda: (s := d.call("status")["spool"])["ignored"] == 28 and s, "all are told")
        self.assertEqual(len(spool["left_lying"]), 16)
        self.assertIn("and 12 more", self.shearctl(d, "status"))
        shutil.rmtree(d.folder("incoming", "folder.fits"))
        for name in os.listdir(path):
            os.unlink(os.path.join(path, name))
        until(lambda: d.call("status")["problems"] == [], "nothing is left lying")

    def test_what_is_taken(self):
        d = self.daemon()
        names = ("a.fits", "b.FITS", "c.fit", "d.Fit.GZ", "e.fits.gz", "f.fz", "g.FITS.FZ")
        for i, name in enumerate(names):
            content = content_of(mock(d.path("x.fits"), 16, 16, 1 + i))
            packed = name.lower().endswith(".gz")
            d.drop(None, name, gzip.compress(content) if packed else content)
        until(lambda: d.call("status")["states"]["done"] == len(names), "all are measured")
        self.assertEqual({j["field"] for j in d.jobs()}, set("abcdefg"))
        with open(d.folder("incoming", ".job"), "w", encoding="ascii") as f:
            f.write('{"path": "%s", "field": "j"}' % mock(d.path("data", "j.fits"), 16, 16, 99))
        os.rename(d.folder("incoming", ".job"), d.folder("incoming", "job.JSON"))
        until(lambda: any(j["field"] == "j" for j in d.jobs(states=["done"])), "a job file, too")


if __name__ == "__main__":
    unittest.main()
