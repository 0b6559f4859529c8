# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of the service's subcommands share: a service with replies chosen by each test, and shearctl connected to
it."""
from fake_service import FakeService
from tool import SANITIZED, ToolTest, shearctl

JOB_FAILED, TIMED_OUT, UNREACHABLE, CANCELLED = 5, 6, 7, 8
SLOW = 10 if SANITIZED else 3  # seconds that an answer may take


class ServiceTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.socket = self.path("s.sock")

    def serve(self, **methods):
        service = FakeService(self.socket, **methods)
        self.addCleanup(service.close)
        return service

    def ctl(self, *args, **how):
        env = {"SHEARD_SOCKET": self.socket, "TZ": "UTC-2", **how.pop("env", {})}
        return shearctl(*args, env=env, **how)

    def assertUnreachable(self, answer, *words):
        self.assertFails(answer, UNREACHABLE, *words)
        self.assertEqual(answer.out, "")

    def touch(self, name):
        with open(self.path(name), "w", encoding="ascii"):
            return self.path(name)
