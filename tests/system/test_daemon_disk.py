# SPDX-License-Identifier: GPL-3.0-or-later
"""A full disk, on a small file system of its own (so root is needed): refusals give the reason;
once there is room again, work continues and nothing is lost."""
import errno
import os
import subprocess
import unittest

from daemon import DaemonTest, RpcError, content_of, measured, mock, named, until

SIZE_KIB = 6144


class Full(DaemonTest):
    def setUp(self):
        super().setUp()
        self.disk = os.path.join(self.directory, "disk")
        os.mkdir(self.disk)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SIZE_KIB}k", "sheard-test",
                                  self.disk], stderr=subprocess.DEVNULL).returncode == 0
        if not mounted:
            self.skipTest("cannot mount a tmpfs here: the full disk is not tested")
        self.addCleanup(subprocess.run, ["umount", "-l", self.disk], check=True)
        self.d = self.daemon(state=self.disk + "/state", spool=self.disk + "/spool")
        self.part = mock(os.path.join(self.d.data, "part.fits"), 8, 32)
        self.expected = measured([self.part])

    def fill(self):
        """Fill it to the last byte."""
        with open(self.disk + "/filler", "ab", buffering=0) as f:
            for size in (1 << 16, 1 << 12, 1):
                try:
                    while True:
                        f.write(b"\0" * size)
                except OSError as error:
                    self.assertEqual(error.errno, errno.ENOSPC)

    def empty(self):
        os.unlink(self.disk + "/filler")

    def submit_until_refused(self, prefix):
        """Submit one after the other; return the ids of the accepted ones, and the refusal."""
        accepted = {}
        while len(accepted) < 5000:
            key = f"{prefix}{len(accepted)}"
            try:
                job = self.d.call("submit", path=self.part, field=key, key=key)["job"]
                accepted[key] = job["id"]
            except RpcError as error:
                return accepted, error
        raise AssertionError("the full disk was never noticed")

    def test_socket(self):
        before = self.d.submit(self.part, field="before", wait=True)
        self.fill()
        accepted, refusal = self.submit_until_refused("f")
        self.assertEqual(refusal.code, "disk_full", refusal)
        self.assertTrue(refusal.error["data"]["retry"])
        self.assertIn(self.disk, str(refusal), "the message names the disk")
        self.assertIn("free space", refusal.error["data"]["advice"])
        self.assertTrue(self.d.call("status")["problems"], "status is silent about it")
        self.assertEqual(self.d.job(before["id"])["state"], "done")
        self.empty()

        def again():
            try:
                return self.d.call("submit", path=self.part, field="again", key="again")["job"]
            except RpcError as error:
                self.assertTrue(error.error["data"]["retry"], error)
                return None
        accepted["again"] = until(again, "there is room, and a job is accepted")["id"]
        self.d.wait_idle()
        self.assertEqual(self.d.call("status")["problems"], [])
        for field, number in {**accepted, "before": before["id"]}.items():
            self.assertEqual(self.d.job(number)["state"], "done", field)
            self.assertRow(self.d, field, self.expected, 1)

    def test_watch_folder(self):
        content = content_of(self.part)
        names = [f"d{i}.fits" for i in range(4)]
        for name in names:
            with open(self.d.folder("incoming", "." + name), "wb") as f:
                f.write(named(content, name[:-5]))
        self.fill()
        for name in names:
            os.rename(self.d.folder("incoming", "." + name), self.d.folder("incoming", name))
        until(lambda: "full" in self.d.log_text() or "No space" in self.d.log_text(),
              "the log says that the disk is full")
        self.d.call("status")
        self.empty()
        self.d.wait_idle()
        self.assertEqual(self.d.dropped("done"), sorted(names + [n + ".json" for n in names]))
        for name in names:
            self.assertRow(self.d, name[:-5], self.expected, 1)

    def test_catalogs(self):
        """No room for a catalog: the job waits, says why, and is done when there is room."""
        where = self.disk + "/catalogues"
        daemon = self.daemon({"catalogues.enabled": "true", "catalogues.directory": where,
                              "retry.attempts": 2}, name="other")
        part = mock(os.path.join(daemon.data, "part.fits"), 200, 32)
        self.fill()
        job = daemon.submit(part, field="f")["id"]
        until(lambda: (j := daemon.job(job))["state"] == "waiting" and j["attempts"] > 2,
              "it waits, however often it was tried")
        waiting = daemon.job(job)
        self.assertEqual((waiting["class"], waiting["code"]), ("transient", "disk_full"), waiting)
        self.assertIn(where, waiting["message"])
        self.empty()
        done = daemon.wait_state(job, "done")
        self.assertGreater(os.path.getsize(done["catalogue"]), 0)
        self.assertRow(daemon, "f", measured([part]), 1)
        self.assertEqual(set(os.listdir(where)), {".sheard-database", os.path.basename(done["catalogue"])})

    def test_restart_when_full(self):
        """A start on a full disk works or reports why not, and loses nothing."""
        job = self.d.submit(self.part, field="f", wait=True)
        self.d.kill()
        self.fill()
        self.d.spawn()
        until(lambda: not self.d.alive() or self.d.ready(), "it serves, or has ended")
        if self.d.alive():
            self.assertEqual(self.d.job(job["id"])["state"], "done")
            self.d.kill()
        else:
            self.assertEqual(self.d.process.returncode, 1)
        self.empty()
        self.d.start()
        self.assertRow(self.d, "f", self.expected, 1)


if __name__ == "__main__":
    unittest.main()
