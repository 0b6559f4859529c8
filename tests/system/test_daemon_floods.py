# SPDX-License-Identifier: GPL-3.0-or-later
"""Clients that ask for more than a service can answer: others are served, memory stays bounded, and the watchdog is notified
in time. How long others wait is limited in processor time of the service's own turns, which other work of the machine does
not change; bench/floods shows it by the clock."""
import contextlib
import os
import resource
import unittest

import flood
from daemon import Client, DaemonTest, mock, turns, until
from tool import SANITIZED

SECONDS = 1.5
TURN_MS = 200 if SANITIZED else 30  # a turn is 3 ms and the last thing begun in it; there are such of 10 ms
MEMORY_MB = 150
HUNG_S = 20
MANY = 40 if SANITIZED else 300
JOBS = 40 if SANITIZED else 100
OTHER = 65501 if os.getuid() == 0 else None


class Floods(DaemonTest):
    def setUp(self):
        super().setUp()
        flood.room_for_descriptors()
        notify = os.path.join(self.directory, "notify")
        self.watchdog = flood.Watchdog(notify)
        self.addCleanup(self.watchdog.close)
        self.d = self.daemon({"daemon.socket_mode": "0666", "limits.connections": 900, "limits.user_connections": 400,
                              "daemon.max_active_jobs": 1 if "waiting" in self.id() else 4},
                             env={"NOTIFY_SOCKET": notify, "WATCHDOG_USEC": "30000000"})
        self.path = mock(self.d.data + "/a.fits", 8)
        os.chmod(self.d.data, 0o755)

    def submitted(self, n, **params):
        with self.d.client() as client:
            numbers = [client.ask("submit", {"path": self.path, "force": True, "field": f"f{i % 50:03}", **params})
                       for i in range(n)]
            return [client.answer(number)["job"]["id"] for number in numbers]

    def withstood(self, *floods):
        """Each flood is (function, arguments, ...)."""
        with contextlib.ExitStack() as stack, self.d.client() as client:
            for function, *given in floods:
                stack.enter_context(flood.flooding(function, self.d.socket, *given, uid=OTHER))
            before = self.d.call("status")["pid"]
            begin = flood.time.monotonic()
            times, memory = flood.watch(client, before, SECONDS)
            gap = self.watchdog.longest(begin, flood.time.monotonic())
            status = client.call("status")
        self.assertLess(times[-1], HUNG_S)
        self.assertLess(gap, HUNG_S)
        self.assertTurns(self.d, TURN_MS)
        if not SANITIZED:
            self.assertLess(memory, MEMORY_MB)
        return status

    @turns
    def test_looking(self):
        """Long lists, requested endlessly by many clients that read and as many that never do."""
        ids = self.submitted(JOBS)
        self.d.wait_idle()
        wait = flood.line("wait", ids=ids, timeout_s=0) * 16
        fields = flood.line("fields", limit=1000) * 16
        self.withstood((flood.pump, MANY, wait))
        self.withstood((flood.pump, MANY, fields + flood.line("jobs", limit=200) + flood.line("status")))
        self.withstood((flood.pump, MANY, wait + fields, False))
        self.withstood((flood.pump, MANY, flood.line("hello") * 64))
        until(lambda: self.d.call("status")["connections"] < 3, "the floods are gone")
        self.assertEqual(self.d.call("status")["loop"]["unsent_bytes"], 0)

    @turns
    def test_waiting_and_watching(self):
        """Many clients wait for jobs that do not end, many subscribe to all jobs and do not read, while jobs come and
        go."""
        self.d.held(self.d.submit(mock(self.d.data + "/long.fits", 20000, 64))["id"])
        ids = self.submitted(JOBS)
        sleep = flood.line("wait", ids=ids, timeout_s=3600) * 60
        submit = flood.line("submit", path=self.path, force=True) * 16
        self.withstood((flood.pump, MANY, sleep, True, False))
        with self.d.client() as client:
            for number in ids[:20]:
                client.call("cancel", id=number)
        self.withstood((flood.pump, MANY, flood.line("subscribe", all=True, progress=True), False, False),
                       (flood.pump, 5, submit))
        self.d.go_on()

    @turns
    def test_connections(self):
        """One user takes all connections of a user: other users and administrators still connect."""
        status = self.withstood((flood.knock,), (flood.knock,))
        if OTHER is not None:
            self.assertLess(status["connections"], 410)
        self.d.call("reload")


@unittest.skipUnless(os.getuid() == 0, "only root can become somebody else")
class Connections(DaemonTest):
    def test_a_users_share_and_the_administrators(self):
        d = self.daemon({"daemon.socket_mode": "0666", "limits.connections": 24, "limits.user_connections": 12,
                         "limits.admin_connections": 6})

        def knocks(setting):
            with d.client() as client:
                error = client.receive()["error"]
            self.assertEqual(error["data"]["code"], "too_many_connections")
            self.assertIn(setting, error["message"])

        with contextlib.ExitStack() as stack:
            stack.enter_context(flood.flooding(hold, d.socket, uid=65501))
            until(lambda: d.call("status")["connections"] == 13, "a user has its share")
            as_user(self, 65501, lambda: knocks("[limits] user_connections"))
            stack.enter_context(flood.flooding(hold, d.socket, uid=65502))
            until(lambda: d.call("status")["connections"] == 19, "the rest but what is reserved is taken")
            as_user(self, 65503, lambda: knocks("[limits] connections"))
            self.assertTrue(d.call("hello")["admin"])

    def test_descriptors_of_its_own(self):
        """Clients do not use up the descriptors that jobs need, whatever the limits are: the soft limit is raised, and if
        the hard one is too low for so many connections, the service keeps its share."""
        for limits, expected, connections in (("100:2300", 2000 + 64 + 6 * 4, 2000), ("100:240", 240, 240 - 64 - 6 * 4)):
            with self.subTest(limits), contextlib.ExitStack() as stack:
                d = self.daemon({"limits.connections": 2000, "limits.user_connections": 2000, "daemon.max_active_jobs": 4},
                                start=False, name=limits)
                d.prefix = ["prlimit", "--nofile=" + limits]
                client = stack.enter_context(d.start().client())
                soft = resource.prlimit(d.process.pid, resource.RLIMIT_NOFILE)[0]
                self.assertEqual((soft, client.call("status")["limits"]["connections"]), (expected, connections))
                if connections < 2000:
                    self.assertIn(f"file descriptors for {connections} only", d.log_text())
                    stack.enter_context(flood.flooding(hold, d.socket))
                    reserved = 0 if client.call("hello")["admin"] else 16
                    until(lambda: client.call("status")["connections"] == connections - reserved,
                          "all that are to be had are held")
                    path = mock(d.data + "/a.fits", 8)
                    self.assertEqual(client.call("submit", path=path, wait=True)["job"]["state"], "done")


def hold(path):
    held = []
    while True:
        client = Client(path)
        try:
            client.call("hello")
            held.append(client)
        except (OSError, EOFError):
            client.close()
            flood.time.sleep(0.05)


def as_user(test, uid, do):
    pid = os.fork()
    if pid == 0:
        try:
            os.setgroups([])
            os.setgid(uid)
            os.setuid(uid)
            do()
            os._exit(0)
        finally:
            os._exit(1)
    test.assertEqual(os.waitpid(pid, 0)[1], 0, "the child's assertion failed")


if __name__ == "__main__":
    unittest.main()
