# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory stays flat over SHEARD_JOBS jobs: good ones, copies, bad files, cancelled ones, dropped
ones, while a client listens to all. What is compared is the daemon's own memory after a tenth of
them and after all."""
import os
import unittest

from daemon import DaemonTest, content_of, mock, until
from tool import SANITIZED

JOBS = int(os.environ.get("SHEARD_JOBS", "500"))
BATCH = 50  # jobs that are unfinished at the same time
FIELDS = 20
# SQLite's cache grows with the database, to a bound; a KiB that is lost with each of 10,000 jobs
# would be more.
GROWTH_KIB = 6144


def memory_kib(pid):
    """Private memory of a process, and how many descriptors and threads it has."""
    with open(f"/proc/{pid}/status", encoding="ascii") as f:
        fields = dict(line.split(":", 1) for line in f)
    return (int(fields["RssAnon"].split()[0]), len(os.listdir(f"/proc/{pid}/fd")),
            int(fields["Threads"]))


class Memory(DaemonTest):
    def batch(self, daemon, client, first):
        """BATCH jobs, all ended when it returns; one in ten each is a bad file, cancelled, dropped."""
        ids = []
        for i in range(first, first + BATCH):
            field = f"field{i % FIELDS}"
            if i % 10 == 3:
                daemon.drop(None, f"drop{i}.fits", self.content)
                continue
            path = self.bad if i % 10 == 7 else self.good
            job = client.call("submit", path=path, field=field, force=i % 3 == 0, priority=-(i % 5))
            ids.append(job["job"]["id"])
            if i % 10 == 9:
                try:
                    client.call("cancel", id=ids[-1])
                except Exception as error:  # it was faster
                    self.assertIn("wrong_state", str(error))
        self.assertFalse(client.call("wait", ids=ids)["timed_out"])
        daemon.wait_idle()
        until(lambda: client.call("status")["connections"] == 1, "the other connections are gone")
        client.notices.clear()

    def test_flat(self):
        daemon = self.daemon({"retention.jobs_max_count": 200, "spool.done_max_count": 50,
                              "spool.scan_interval": "1h"})
        self.good = mock(os.path.join(daemon.data, "good.fits"), 4, 32)
        self.content = content_of(self.good)
        self.bad = os.path.join(daemon.data, "bad.fits")
        with open(self.bad, "wb") as f:
            f.write(self.content[:4000])
        early = None
        with daemon.client() as client:
            client.call("subscribe", all=True, progress=True)
            for first in range(0, JOBS, BATCH):
                self.batch(daemon, client, first)
                if early is None and first + BATCH >= JOBS // 10:
                    # The loop's pool of threads begins with the first look at the data roots.
                    until(lambda: client.call("status")["uptime_s"] > 7.0, "it has looked at the roots")
                    early = memory_kib(daemon.process.pid)
            # A connection or a reader may be on its way out still.
            until(lambda: all(b <= a for a, b in zip(early[1:], memory_kib(daemon.process.pid)[1:])),
                  f"descriptors and threads are as few as before: {early[1:]}")
            late = memory_kib(daemon.process.pid)
            totals = client.call("status")["totals"]
        print(f"\nmemory after {JOBS // 10} jobs {early[0]} KiB, after {JOBS} {late[0]} KiB; "
              f"descriptors {early[1]}, {late[1]}; threads {early[2]}, {late[2]}; {totals}", flush=True)
        self.assertEqual(totals["submitted"], JOBS)
        if not SANITIZED:  # which keeps what was freed
            self.assertLess(late[0] - early[0], GROWTH_KIB)


if __name__ == "__main__":
    unittest.main()
