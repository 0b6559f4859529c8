#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The real service behind what the shipped unit does to its system calls (unit_filter.py): does it measure? The list in
test_systemd.py says what must be allowed; this finds what that list lacks. SHEARD_SERVICE is the unit as built.

As root, the service runs as nobody, as a service does; else as whoever runs the test."""
import gzip
import grp
import os
import pwd
import shutil
import subprocess
import sys
import unittest

import unit_filter
from daemon import FINAL, SHEARD, DaemonTest, content_of, measured, mock, until
from tool import SANITIZED

SERVICE = os.environ["SHEARD_SERVICE"]
FILTER = os.path.abspath(unit_filter.__file__)
LANDLOCK = " landlock_create_ruleset landlock_add_rule landlock_restrict_self"


def filters_work():
    """Whether this kernel and this container let a process filter itself."""
    run = subprocess.run([sys.executable, "-B", FILTER, SERVICE, "-", shutil.which("true")], capture_output=True,
                         check=False)
    return run.returncode == 0


@unittest.skipIf(SANITIZED, "a sanitizer's runtime makes calls of its own, which the unit need not allow")
@unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze is not installed (Debian package systemd)")
class UnderTheUnit(DaemonTest):
    def setUp(self):
        super().setUp()
        if not filters_work():
            self.skipTest("no program can be run behind a system-call filter here")
        self.root = os.geteuid() == 0
        self.user = pwd.getpwnam("nobody") if self.root else pwd.getpwuid(os.geteuid())

    def under(self, unit):
        """A service in a directory of its own, not started; its programs are where its user can run them."""
        group = grp.getgrgid(self.user.pw_gid).gr_name
        daemon = self.daemon({"daemon.nice": 5, "daemon.socket_group": group, "catalogues.enabled": "true"},
                             start=False)
        programs, path = daemon.path("bin"), daemon.path("sheard.service")
        os.mkdir(programs)
        for name in ("sheard", "sheard-reader"):
            shutil.copy(os.path.join(os.path.dirname(SHEARD), name), programs)
        with open(path, "w", encoding="utf-8") as file:
            file.write(unit)
        daemon.prefix = [sys.executable, "-B", FILTER, path, str(self.user.pw_uid) if self.root else "-"]
        daemon.program = os.path.join(programs, "sheard")
        self.give(daemon)
        return daemon

    def give(self, daemon):
        """All of the directory to the service's user."""
        if self.root:
            os.chmod(self.directory, 0o755)
            for folder, _, names in os.walk(daemon.directory):
                for path in [folder, *(os.path.join(folder, name) for name in names)]:
                    os.chown(path, self.user.pw_uid, self.user.pw_gid)

    def files(self, daemon):
        plain = mock(os.path.join(daemon.data, "plain.fits"), seed=1)
        packed = os.path.join(daemon.data, "folder", "packed.fits.gz")
        os.mkdir(os.path.dirname(packed))
        with gzip.open(packed, "wb") as file:
            file.write(content_of(mock(os.path.join(daemon.data, "whole.fits"), seed=2)))
        return plain, packed

    def test_dropped_and_submitted_files_are_measured(self):
        daemon = self.under(unit_filter.text_of(SERVICE))
        plain, packed = self.files(daemon)
        self.give(daemon)
        daemon.start()
        daemon.drop(mock(os.path.join(daemon.data, "third.fits"), seed=3), "dropped.fits")
        submitted = [daemon.submit(path, field="x")["id"] for path in (plain, packed)]
        for number in submitted:
            job = daemon.wait_state(number, "waiting", *FINAL)
            self.assertEqual((job["state"], job["message"]), ("done", None))
        until(lambda: daemon.dropped("done") + daemon.dropped("failed"), "the dropped file is measured")
        self.assertIn("dropped.fits", daemon.dropped("done"))
        self.assertRow(daemon, "x", measured([plain, packed]), 2)
        names = os.listdir(daemon.settings["catalogues.directory"])
        self.assertEqual(len([n for n in names if n[0] != "."]), 3)
        self.assertTrue(daemon.call("probe")["ok"])
        self.assertEqual(daemon.call("status")["problems"], [])
        with open(f"/proc/{daemon.process.pid}/status", encoding="ascii") as file:
            self.assertIn("Seccomp:\t2\n", file.read())
        self.assertEqual(os.getpriority(os.PRIO_PROCESS, daemon.process.pid), 5)
        self.assertEqual(daemon.stop(), 0)
        self.assertNotRegex(daemon.log_text(), "(?i)error|warning|not permitted")

    def test_a_unit_without_a_call_that_is_needed_would_be_seen(self):
        unit = unit_filter.text_of(SERVICE)
        self.assertEqual(unit.count(LANDLOCK), 1)
        daemon = self.under(unit.replace(LANDLOCK, ""))
        plain, _ = self.files(daemon)
        self.give(daemon)
        daemon.start()
        job = daemon.wait_state(daemon.submit(plain)["id"], "waiting", *FINAL)
        self.assertNotEqual(job["state"], "done")
        probed = daemon.call("probe")
        self.assertFalse(probed["ok"])
        for message in (job["message"], probed["message"]):
            self.assertIn("the reader's sandbox: Landlock: Operation not permitted", message)


if __name__ == "__main__":
    unittest.main()
