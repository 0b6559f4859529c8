# SPDX-License-Identifier: GPL-3.0-or-later
"""A missing data root stops nobody: the service starts and reloads, and reports it; jobs beneath it wait, however long, and
run once it exists."""
import datetime
import json
import os
import subprocess
import unittest

from daemon import SLOW, SHEARD, DaemonTest, measured, mock, until
from tool import SHEARCTL


class MissingRoot(DaemonTest):
    def setUp(self):
        super().setUp()
        self.missing = os.path.join(self.directory, "disk")
        self.away = os.path.join(self.directory, "away")

    def daemon_with(self, *roots, **settings):
        return self.daemon({"access.data_roots": ", ".join(roots), **settings})

    def told(self, d, path):
        return {root["path"]: root for root in d.call("status")["roots"]}[path]

    def test_the_service_starts(self):
        d = self.daemon_with(os.path.join(self.directory, "data"), self.missing)
        self.assertIn(f"data root {self.missing} is missing: No such file", d.log_text())
        status = d.call("status")
        self.assertEqual(status["roots"][0], {"path": d.data, "missing": False, "reason": None})
        self.assertTrue(status["roots"][1]["missing"])
        self.assertIn("No such file", status["roots"][1]["reason"])
        self.assertEqual(status["problems"], [status["roots"][1]["reason"]])
        self.assertEqual(status["config"], d.config)
        self.assertEqual(status["state_dir"], d.state)
        self.assertIsNone(status["catalogues"])
        self.assertEqual(d.submit(mock(d.data + "/a.fits"), wait=True)["state"], "done")
        with self.assertRefused("root_missing") as caught:
            d.submit(os.path.join(self.missing, "a.fits"))
        self.assertTrue(caught.exception.error["data"]["retry"])
        self.assertIn(self.missing, str(caught.exception))
        with self.assertRefused("outside_roots"):
            d.submit("/etc/passwd")
        os.mkdir(self.missing)
        path = mock(os.path.join(self.missing, "a.fits"), seed=2)
        self.assertEqual(d.submit(path, wait=True)["state"], "done")
        until(lambda: not self.told(d, self.missing)["missing"], "it is seen")
        self.assertEqual(d.call("status")["problems"], [])

    def test_accepted_jobs_wait(self):
        """More attempts than are allowed for anything else, and then at once, not at the next attempt's time."""
        os.mkdir(self.missing)
        d = self.daemon_with(self.missing, **{"retry.attempts": 2, "daemon.max_active_jobs": 1, "daemon.workers": 1})
        slow = mock(os.path.join(self.missing, "slow.fits"), 400, 32)
        path = mock(os.path.join(self.missing, "a.fits"), 16, 32, 3)
        expected = measured([path])
        job = d.held(d.submit(slow, settings=SLOW)["id"])
        waits = d.submit(path, field="late")["id"]
        os.rename(self.missing, self.away)
        d.call("cancel", id=job)
        d.go_on()
        until(lambda: d.job(waits)["attempts"] >= 4, "it was tried more often than others are")
        state = d.job(waits)
        self.assertEqual((state["class"], state["code"]), ("transient", "root_missing"))
        self.assertIn(state["state"], ("waiting", "running", "queued"))
        until(lambda: self.told(d, self.missing)["missing"], "it is told")
        self.assertIn("jobs beneath it wait", d.log_text())
        d.settings.update({"retry.first_delay": "1h", "retry.max_delay": "1h"})
        d.write_config()
        self.assertEqual(d.call("reload")["warnings"], [self.told(d, self.missing)["reason"]])
        later = (datetime.datetime.now(datetime.timezone.utc) + datetime.timedelta(minutes=30)).isoformat()
        until(lambda: (d.job(waits)["not_before"] or "") > later, "it waits for an hour")
        self.assertEqual(d.stop(), 0)
        d.start()
        self.assertTrue(self.told(d, self.missing)["missing"])
        os.rename(self.away, self.missing)
        self.assertEqual(d.wait_state(waits, "done", "failed")["state"], "done")
        self.assertRow(d, "late", expected, 1)

    def test_by_another_name(self):
        """The root is a link, and so is gone with what it leads to; the job knows its file by the real name."""
        os.mkdir(self.away)
        os.symlink("away", self.missing)
        d = self.daemon_with(self.missing, **{"daemon.max_active_jobs": 1})
        mock(os.path.join(self.away, "a.fits"))
        slow = mock(os.path.join(self.away, "slow.fits"), 400, 32)
        job = d.held(d.submit(slow, settings=SLOW)["id"])
        waits = d.submit(os.path.join(self.missing, "a.fits"))["id"]
        os.rename(self.away, self.away + "2")
        d.call("cancel", id=job)
        d.go_on()
        until(lambda: d.job(waits)["code"] == "root_missing", "it waits for the root")
        os.rename(self.away + "2", self.away)
        self.assertEqual(d.wait_state(waits, "done", "failed")["state"], "done")

    def test_reload(self):
        d = self.daemon({})
        d.settings["access.data_roots"] = f"{d.data}, {self.missing}"
        d.write_config()
        checked = subprocess.run([SHEARD, "--check-config", "--config", d.config], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout)
        self.assertRegex(checked.stdout, f"warning: .*{self.missing}")
        answer = d.call("reload")
        self.assertEqual(answer["changed"], ["access.data_roots"])
        self.assertEqual(len(answer["warnings"]), 1)
        self.assertIn(self.missing, answer["warnings"][0])
        said = subprocess.run([SHEARCTL, "reload", "--socket", d.socket], capture_output=True, text=True)
        self.assertEqual(said.returncode, 0)
        self.assertIn(f"warning: data root {self.missing} is missing", said.stdout)
        said = subprocess.run([SHEARCTL, "status", "--socket", d.socket], capture_output=True, text=True)
        self.assertIn(f"{self.missing} (missing)", said.stdout)

    def test_a_dropped_job_file_waits(self):
        """It is not a job yet, and becomes one when its root exists."""
        d = self.daemon_with(self.missing)
        d.drop(None, "k.json", json.dumps({"path": os.path.join(self.missing, "a.fits")}).encode())
        until(lambda: d.dropped("active"), "it is taken")
        os.mkdir(self.away)
        mock(os.path.join(self.away, "a.fits"))
        os.rename(self.away, self.missing)
        until(lambda: "k.json.json" in d.dropped("done"), "its job is done")


if __name__ == "__main__":
    unittest.main()
