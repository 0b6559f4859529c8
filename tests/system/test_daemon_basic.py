# SPDX-License-Identifier: GPL-3.0-or-later
"""The service as its users meet it: jobs by socket and watch folder, and what becomes of them."""
import gzip
import json
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

from daemon import (SLOW, SLOW_OPTIONS, DaemonTest, FINAL, content_of, measured, mock, named, numbers, stamps_for,
                    until)


class Jobs(DaemonTest):
    def setUp(self):
        super().setUp()
        self.d = self.daemon(self.settings())

    def settings(self):
        return {}

    def data(self, name, stamps=12, seed=1):
        return mock(os.path.join(self.d.data, name), stamps, 32, seed)

    def slow(self, name="slow.fits", seconds=3):
        """A job that runs for about so long, running."""
        stamps = stamps_for(seconds, 32, *SLOW_OPTIONS)
        return self.d.submit(self.data(name, stamps, 77), settings=SLOW)["id"]

    def held(self, name="slow.fits"):
        """A job in the middle of its measurement, which it does not leave before self.d.go_on()."""
        return self.d.held(self.slow(name))


class Submit(Jobs):
    def test_submit_and_wait(self):
        path = self.data("a.fits")
        result = self.d.call("submit", path=path, wait=True)
        job = result["job"]
        self.assertFalse(result["known"])
        self.assertEqual((job["state"], job["outcome"], job["field"]), ("done", "counted", "a"))
        self.assertEqual((job["attempts"], job["owner"]), (1, os.getuid()))
        expected = measured([path])
        self.assertEqual(numbers(job["result"]), expected)
        self.assertRow(self.d, "a", expected, 1)

    def test_duplicate_and_force(self):
        path = self.data("a.fits")
        shutil.copy(path, os.path.join(self.d.data, "copy.fits"))
        first = self.d.submit(path, field="f", wait=True)
        again = self.d.submit(os.path.join(self.d.data, "copy.fits"), field="f", wait=True)
        self.assertEqual((again["outcome"], again["duplicate_of"]), ("duplicate", first["id"]))
        self.assertRow(self.d, "f", measured([path]), 1)
        other = self.d.submit(path, field="g", wait=True)
        self.assertEqual(other["outcome"], "counted")
        forced = self.d.submit(path, field="f", force=True, wait=True)
        self.assertEqual(forced["outcome"], "counted")
        row = self.d.call("field", field="f")["rows"][0]
        self.assertEqual((row["jobs"], row["n_stamps"]), (2, 24))
        self.assertEqual(row["g1"], first["result"]["g1"])

    def test_key(self):
        path, other = self.data("a.fits"), self.data("b.fits", seed=2)
        first = self.d.call("submit", path=path, key="k")
        again = self.d.call("submit", path=path, key="k", wait=True)
        self.assertEqual((first["known"], again["known"]), (False, True))
        self.assertEqual(first["job"]["id"], again["job"]["id"])
        with self.assertRefused("key_reused"):
            self.d.submit(other, key="k")
        self.assertEqual(len(self.d.jobs()), 1)

    def test_many_files_any_order(self):
        paths = [self.data(f"p{i}.fits", 4 + 3 * i, i + 1) for i in range(6)]
        random.Random(4).shuffle(paths)
        with self.d.client() as client:
            asked = [client.ask("submit", {"path": path, "field": "f"}) for path in paths[:4]]
            for number in asked:
                client.answer(number)
        for path in paths[4:]:
            name = os.path.basename(path)
            self.d.drop(None, name, named(content_of(path), "f"))
        self.d.wait_idle()
        self.assertRow(self.d, "f", measured(sorted(paths)), 6)

    def test_bad_file(self):
        path = os.path.join(self.d.data, "bad.fits")
        with open(path, "wb") as f:
            f.write(content_of(self.data("a.fits"))[:20000])
        job = self.d.submit(path, wait=True)
        self.assertEqual((job["state"], job["class"], job["code"]), ("failed", "data", "bad_file"))
        self.assertTrue(job["message"] and job["attempts"] == 1)
        shutil.copy(self.data("good.fits"), path)
        self.assertEqual(self.d.call("retry", id=job["id"])["attempts"], 0)
        self.assertEqual(self.d.wait_state(job["id"], *FINAL)["state"], "done")
        with self.assertRefused("wrong_state"):
            self.d.call("retry", id=job["id"])

    def test_mixed_settings(self):
        path = self.data("a.fits")
        self.d.submit(path, wait=True)
        self.d.submit(path, settings={"beta-ratio": 1.6}, wait=True)
        field = self.d.call("field", field="a")
        self.assertTrue(field["mixed"])
        self.assertEqual(len({row["digest"] for row in field["rows"]}), 2)
        got = sorted((numbers(row) for row in field["rows"]), key=str)
        expected = [measured([path]), measured([path], "--beta-ratio", "1.6")]
        self.assertEqual(got, sorted(expected, key=str))
        self.assertTrue(all(line["mixed"] for line in self.d.call("fields")["fields"]))
        with self.assertRefused("bad_setting"):
            self.d.submit(path, settings={"beta": -1})

    def test_refusals(self):
        os.mkdir(os.path.join(self.d.data, "folder"))
        for code, method, params in (("no_such_job", "job", {"id": 99}),
                                     ("no_such_job", "cancel", {"id": 99}),
                                     ("no_such_job", "wait", {"ids": [99]}),
                                     ("no_such_field", "field", {"field": "none"}),
                                     ("unknown_method", "nothing", {}),
                                     ("unknown_parameter", "status", {"x": 1}),
                                     ("bad_cursor", "jobs", {"cursor": "x"}),
                                     ("no_such_file", "submit", {"path": self.d.data + "/no"}),
                                     ("not_regular", "submit", {"path": self.d.data + "/folder"})):
            with self.subTest(method=method, code=code), self.assertRefused(code):
                self.d.call(method, **params)


class Running(Jobs):
    """What concerns a job that runs."""

    def settings(self):
        return {"daemon.max_active_jobs": 1}

    def test_partial_field_priority_and_cancel(self):
        slow = self.held()
        total = self.d.job(slow)["progress"]["total"]
        row = self.d.call("field", field="slow")["rows"][0]
        self.assertTrue(row["partial"])
        self.assertEqual((row["jobs"], row["unfinished"], row["running"]), (0, 1, [slow]))
        until(lambda: 0 < self.d.call("field", field="slow")["rows"][0]["n_stamps"] < total,
              "the field shows a part of the job")
        low = self.d.submit(self.data("low.fits"), priority=-5)["id"]
        high = self.d.submit(self.data("high.fits", seed=2), priority=-1)["id"]
        gone = self.d.submit(self.data("gone.fits", seed=3))["id"]
        self.assertEqual(self.d.call("cancel", id=gone)["state"], "cancelled")
        self.assertTrue(self.d.call("cancel", id=slow)["cancel_asked"])
        self.d.go_on()
        job = self.d.wait_state(slow, *FINAL)
        self.assertEqual(job["state"], "cancelled")
        self.d.wait_idle()
        self.assertLess(self.d.job(high)["started"], self.d.job(low)["started"])
        with self.assertRefused("no_such_field"):
            self.d.call("field", field="slow")
        with self.assertRefused("wrong_state"):
            self.d.call("cancel", id=low)

    def test_wait(self):
        slow = self.held()
        result = self.d.call("wait", ids=[slow], timeout_s=0)
        self.assertTrue(result["timed_out"])
        self.assertEqual(result["jobs"][0]["state"], "running")
        with self.d.client() as client:
            asked = client.ask("wait", {"ids": [slow]})
            self.assertEqual(client.call("status")["states"]["running"], 1)
            self.d.call("cancel", id=slow)
            self.d.go_on()
            self.assertEqual(client.answer(asked)["jobs"][0]["state"], "cancelled")

    def test_drain(self):
        slow = self.held()
        queued = self.d.submit(self.data("q.fits"))["id"]
        self.assertEqual(self.d.call("drain")["state"], "draining")
        with self.assertRefused("draining"):
            self.d.submit(self.data("r.fits"))
        self.d.drop(self.data("s.fits"), "s.fits")
        self.d.go_on()
        self.assertEqual(self.d.call("wait", ids=[slow, queued])["jobs"][1]["state"], "done")
        self.assertEqual(self.d.dropped("incoming"), ["s.fits"])
        self.assertEqual(self.d.stop(), 0)
        self.d.start().wait_idle()
        self.assertEqual(self.d.dropped("done"), ["s.fits", "s.fits.json"])

    def test_sigterm_finishes_what_runs(self):
        slow = self.held()
        queued = self.d.submit(self.data("q.fits"))["id"]
        self.d.signal(signal.SIGTERM)
        until(lambda: self.d.call("status")["state"] == "stopping", "it stops")
        self.d.go_on()
        self.assertEqual(self.d.ended(), 0)
        self.d.start()
        history = self.d.call("job", id=slow)["history"]
        self.assertEqual([a["ending"] for a in history], ["done"])
        self.assertEqual(self.d.wait_state(queued, *FINAL)["state"], "done")

    def test_second_sigterm_stops_at_once(self):
        slow = self.held()
        self.d.signal(signal.SIGTERM)
        until(lambda: self.d.call("status")["state"] == "stopping", "it stops")
        self.d.signal(signal.SIGTERM)
        until(lambda: "stopping at once" in self.d.log_text(), "it stops at once")
        self.d.go_on()
        self.assertEqual(self.d.ended(), 0)
        self.d.start()
        until(lambda: self.d.job(slow)["progress"]["done"], "it goes on")
        self.assertEqual(self.d.call("job", id=slow)["history"][0]["ending"], "released")
        self.d.call("cancel", id=slow)
        self.assertEqual(self.d.wait_state(slow, *FINAL)["state"], "cancelled")

    def test_shutdown_now_resumes(self):
        slow = self.held()
        self.assertEqual(self.d.call("shutdown", mode="now")["state"], "stopping")
        self.d.go_on()
        self.assertEqual(self.d.ended(), 0)
        self.d.start()
        self.assertEqual(self.d.call("job", id=slow)["history"][0]["ending"], "released")
        self.assertEqual(self.d.wait_state(slow, *FINAL)["state"], "done")
        path = os.path.join(self.d.data, "slow.fits")
        self.assertRow(self.d, "slow", measured([path], *SLOW_OPTIONS), 1)

    def notices(self, client, method, enough):
        """Read until enough(params of these notifications); return all of them."""
        def found():
            return [n["params"] for n in client.notices if n["method"] == method]
        while not enough(found()):
            client.notices.append(client.receive())
        return found()

    def test_subscribe(self):
        with self.d.client() as client:
            client.call("subscribe", all=True, progress=True)
            job = self.held()
            progress = self.notices(client, "job_progress",
                                    lambda all_: all_ and all_[-1]["progress"]["done"])[-1]
            self.assertEqual(progress["id"], job)
            self.assertTrue(0 < progress["progress"]["done"] < progress["progress"]["total"])
            self.d.go_on()
            told = self.notices(client, "job_changed",
                                lambda all_: all_ and all_[-1]["job"]["state"] == "done")
        states = [n["job"]["state"] for n in told]
        self.assertEqual([s for i, s in enumerate(states) if i == 0 or states[i - 1] != s],
                         ["queued", "running", "done"])

    def test_end_of_a_drain_is_told(self):
        with self.d.client() as client:
            client.call("subscribe", all=True)
            self.held()
            waiting = self.d.submit(self.data("a.fits"))["id"]
            left = client.call("drain")
            self.assertEqual((left["state"], left["running"], left["queued"]), ("draining", 1, 1))
            self.d.go_on()
            told = self.notices(client, "server_state", lambda seen: len(seen) == 2)
            self.assertEqual(told[0], left)
            self.assertEqual(told[1], {"state": "draining", "running": 0, "queued": 0})
            self.assertEqual(self.d.job(waiting)["state"], "done")

    def test_subscriptions_end_with_their_jobs(self):
        done = self.d.submit(self.data("a.fits"), wait=True)["id"]
        slow = self.held()
        with self.d.client() as client:
            with self.assertRefused("no_such_job"):
                client.call("subscribe", jobs=[slow, 999])
            self.assertEqual(client.call("subscribe", jobs=[done, slow])["jobs"], 1)
            self.d.go_on()
            self.notices(client, "job_changed",
                         lambda seen: seen and seen[-1]["job"]["state"] == "done")
            self.assertEqual(client.call("subscribe", fields=["slow"])["jobs"], 0)
            with self.d.client() as other:
                self.assertEqual(other.call("subscribe", jobs=[done])["jobs"], 0)

    def test_field_changes_are_told_once_a_second(self):
        """Many jobs of one field: few notifications, and the last one includes all jobs."""
        count = 12
        paths = [self.data(f"part{i}.fits", seed=i + 1) for i in range(count)]
        with self.d.client() as client:
            client.call("subscribe", fields=["many"])
            begun = time.monotonic()
            for path in paths:
                self.d.submit(path, field="many")
            told = self.notices(client, "field_changed",
                                lambda seen: seen and seen[-1]["field"]["jobs"] == count)
            self.assertLessEqual(len(told), time.monotonic() - begun + 1)
        self.assertEqual(numbers_of(told[-1]["field"]),
                         numbers_of(self.d.call("fields", prefix="many")["fields"][0]))

    def test_a_learned_name_is_told(self):
        with self.d.client() as client:
            client.call("subscribe", all=True)
            self.held("named.fits")
            self.notices(client, "job_changed", lambda all_: len(all_) == 3)
            self.d.go_on()
            seen = self.notices(client, "job_changed",
                                lambda all_: all_ and all_[-1]["job"]["state"] == "done")
        self.assertEqual([(n["job"]["state"], n["job"]["field"]) for n in seen],
                         [("queued", None), ("running", None), ("running", "named"),
                          ("done", "named")])


def numbers_of(summary):
    return {key: summary[key] for key in ("g1", "g1_err", "g2", "g2_err", "n_stamps", "n_used")}


class ManyWorkers(DaemonTest):
    def test_more_workers_than_turns(self):
        """Workers race for the last turns of each job: none may end a job that another one is in."""
        d = self.daemon({"daemon.workers": 16, "limits.queue": 1000})
        path = mock(os.path.join(d.data, "a.fits"), 64, 16)
        ids = [d.submit(path, field=f"f{i}")["id"] for i in range(400)]
        d.wait_idle()
        self.assertEqual({(d.job(i)["outcome"], d.job(i)["attempts"]) for i in ids}, {("counted", 1)})


class Folder(Jobs):
    def test_compressed(self):
        path = self.data("a.fits")
        with gzip.open(self.d.folder("incoming", ".z"), "wb") as f:
            f.write(content_of(path))
        os.rename(self.d.folder("incoming", ".z"), self.d.folder("incoming", "a.fits.gz"))
        self.d.wait_idle()
        self.assertEqual(self.d.dropped("done"), ["a.fits.gz", "a.fits.gz.json"])
        self.assertRow(self.d, "a", measured([path]), 1)

    @unittest.skipUnless(shutil.which("fpack"), "there is no fpack to make a .fits.fz")
    def test_tile_compressed(self):
        path = self.data("b.fits")
        subprocess.run(["fpack", "-g", "-q", "0", path], check=True)
        self.d.drop(path + ".fz", "b.fits.fz")
        self.d.wait_idle()
        self.assertEqual(self.d.dropped("done"), ["b.fits.fz", "b.fits.fz.json"])
        self.assertRow(self.d, "b", measured([path + ".fz"]), 1)

    def test_job_file(self):
        path = self.data("a.fits")
        job = {"path": path, "field": "mine", "settings": {"beta-ratio": 1.7}, "priority": -3}
        self.d.drop(None, "j.json", json.dumps(job, indent=1).encode())
        self.d.drop(None, "bad.json", b'{"path": 3}')
        self.d.drop(None, "gone.json", json.dumps({"path": self.d.data + "/no.fits"}).encode())
        self.d.wait_idle()
        self.assertEqual(self.d.dropped("done"), ["j.json", "j.json.json"])
        self.assertRow(self.d, "mine", measured([path], "--beta-ratio", "1.7"), 1)
        self.assertEqual(self.d.side("done", "j.json")["job"]["origin"], "spool")
        self.assertEqual(self.d.side("failed", "bad.json")["code"], "bad_parameter")
        self.assertIsNone(self.d.side("failed", "bad.json")["job"])
        self.assertEqual(self.d.side("failed", "gone.json")["code"], "no_such_file")

    def test_names(self):
        """Never overwritten; unfinished and hidden ones are left alone; a written file is taken
        when it is closed."""
        one, two = content_of(self.data("1.fits")), content_of(self.data("2.fits", seed=2))
        self.d.drop(None, "a.fits", one)
        self.d.wait_idle()
        self.d.drop(None, "a.fits", two)
        for name in (".hidden.fits", "x.tmp", "x.fits.part"):
            shutil.copy(self.d.data + "/1.fits", self.d.folder("incoming", name))
        until(lambda: len(self.d.dropped("done")) == 4, "the second a.fits is done")
        self.assertEqual(self.d.dropped("done"),
                         ["a.1.fits", "a.1.fits.json", "a.fits", "a.fits.json"])
        self.assertEqual(content_of(self.d.folder("done", "a.fits")), one)
        self.assertEqual(content_of(self.d.folder("done", "a.1.fits")), two)
        self.assertEqual(self.d.dropped("incoming"), ["x.fits.part", "x.tmp"])
        with open(self.d.folder("incoming", "slow.fits"), "wb") as f:
            f.write(one[:30000])
            f.flush()
            until(lambda: self.d.call("status"), "a turn went by")
            self.assertIn("slow.fits", self.d.dropped("incoming"))
            f.write(one[30000:])
        until(lambda: "slow.fits.json" in self.d.dropped("done"), "it is taken once closed")


class Operation(Jobs):
    def test_reload(self):
        self.d.settings["limits.queue"] = 7
        self.d.write_config()
        answer = self.d.call("reload")
        self.assertEqual((answer["changed"], answer["restart"]), (["limits.queue"], []))
        self.assertEqual(self.d.call("hello")["limits"]["queue"], 7)
        self.d.settings["limits.queue"] = "many"
        self.d.write_config()
        with self.assertRefused("bad_config") as caught:
            self.d.call("reload")
        self.assertIn("queue", str(caught.exception))
        self.assertEqual(self.d.call("hello")["limits"]["queue"], 7)
        self.d.settings.update({"limits.queue": 8, "daemon.workers": 1})
        self.d.write_config()
        self.assertEqual(self.d.call("reload")["restart"], ["daemon.workers"])

    def test_sighup(self):
        self.d.settings["limits.queue"] = 9
        self.d.write_config()
        self.d.signal(signal.SIGHUP)
        until(lambda: self.d.call("hello")["limits"]["queue"] == 9, "the new limit is in force")
        self.d.settings["limits.queue"] = -1
        self.d.write_config()
        self.d.signal(signal.SIGHUP)
        until(lambda: "not reloaded" in self.d.log_text(), "the log says that it was refused")
        self.assertEqual(self.d.call("hello")["limits"]["queue"], 9)

    def test_queue_full(self):
        self.d.settings.update({"limits.queue": 2, "daemon.max_active_jobs": 1})
        self.d.write_config()
        self.d.call("reload")
        slow = self.held()
        second = self.d.submit(self.data("a.fits"))["id"]
        with self.assertRefused("queue_full"):
            self.d.submit(self.data("b.fits", seed=2))
        self.d.drop(self.data("c.fits", seed=3), "c.fits")
        self.d.call("cancel", id=slow)
        self.d.go_on()
        self.d.wait_idle()
        self.assertEqual(self.d.job(second)["state"], "done")
        self.assertEqual(self.d.dropped("done"), ["c.fits", "c.fits.json"])

    def test_status_and_metrics(self):
        self.d.submit(self.data("a.fits"), wait=True)
        status = self.d.call("status")
        self.assertEqual((status["pid"], status["state"]), (self.d.process.pid, "running"))
        self.assertEqual((status["states"]["done"], status["totals"]["stamps"]), (1, 12))
        self.assertEqual(status["problems"], [])
        metrics = self.d.call("metrics")
        lines = metrics["text"].splitlines()
        self.assertIn('sheard_jobs{state="done"} 1', lines)
        self.assertIn("sheard_stamps_total 12", lines)
        for line in lines:
            self.assertRegex(line, r"^(# (HELP|TYPE) \S+ .+|[a-z_]+(\{[^}]*\})? \S+)$")

    def test_plans_are_kept(self):
        """Jobs of one shape, settings and PSF share a plan; the numbers are those of a new one."""
        path = self.data("a.fits")
        for field in ("one", "two", "three"):
            self.d.submit(path, field=field, wait=True)
        self.d.submit(path, field="other", settings={"beta": 3.0}, wait=True)
        plans = self.d.call("status")["plans"]
        self.assertEqual((plans["kept"], plans["hits"], plans["misses"]), (2, 2, 2))
        self.assertGreater(plans["bytes"], 0)
        self.assertIn("sheard_plan_hits_total 2", self.d.call("metrics")["text"].splitlines())
        for field in ("one", "two", "three"):
            self.assertRow(self.d, field, measured([path]), 1)
        self.assertRow(self.d, "other", measured([path], "--beta", "3"), 1)
        self.d.settings["plans.max_count"] = "none"
        self.d.write_config()
        self.d.call("reload")
        self.assertEqual(self.d.call("status")["plans"]["kept"], 0)
        self.assertEqual(self.d.submit(path, field="four", wait=True)["state"], "done")
        until(lambda: self.d.call("status")["plans"]["kept"] == 0, "its plan is given up")
        self.assertRow(self.d, "four", measured([path]), 1)

    def test_blocks_left(self):
        """What is left of the running jobs, in blocks of 16 stamps."""
        slow = self.held()
        total = -(-self.d.job(slow)["progress"]["total"] // 16)
        left = self.d.call("status")["queue"]["blocks"]
        self.assertTrue(0 < left < total, (left, total))
        self.d.go_on()
        self.d.wait_idle()
        self.assertEqual(self.d.call("status")["queue"]["blocks"], 0)

    def test_one_daemon_only(self):
        other = self.daemon(name="other", start=False, state=self.d.state, spool=self.d.spool)
        other.spawn()
        self.assertEqual(other.ended(), 1)
        self.assertIn("another", other.log_text())
        self.d.call("status")


if __name__ == "__main__":
    unittest.main()
