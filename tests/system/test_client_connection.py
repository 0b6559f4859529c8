# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl and a service that is not there, silent, strange or another release."""
import json
import os
import socket
import subprocess
import threading
import unittest

from fake_service import HANG_UP, WELCOME, FakeService, Refusal, job, send, status
from service_test import SLOW, UNREACHABLE, ServiceTest
from tool import DONE, SANITIZERS, SHEARCTL, shearctl


class Reaching(ServiceTest):
    def test_no_socket(self):
        for args in (["status"], ["jobs"], ["wait", "1"], ["submit", "a.fits"], ["watch"], ["field", "x"], ["metrics"],
                     ["fields"], ["show", "1"], ["cancel", "1"], ["retry", "1"], ["drain"], ["reload"], ["shutdown"]):
            with self.subTest(args=args):
                self.assertUnreachable(self.ctl(*args), "no socket", self.socket, "systemctl start", "--socket")

    def test_nobody_listens(self):
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(self.socket)
        listener.close()
        self.assertUnreachable(self.ctl("status"), "nobody listens", self.socket)

    @unittest.skipUnless(os.geteuid() == 0, "needs root: becomes another user")
    def test_permission_denied(self):
        self.serve(status=status())
        os.chmod(self.socket, 0o600)
        os.chmod(self.directory, 0o755)
        code = f"import os; os.setgid(65534); os.setuid(65534); os.execv({SHEARCTL!r}, ['shearctl', 'status'])"
        if not os.access(SHEARCTL, os.X_OK) or "/root" in SHEARCTL:
            self.skipTest("the tool is where another user may not run it")
        process = subprocess.run(["python3", "-c", code], capture_output=True, text=True, check=False,
                                 env={**os.environ, **SANITIZERS, "SHEARD_SOCKET": self.socket})
        self.assertEqual(process.returncode, UNREACHABLE, process.stderr)
        self.assertIn("may not connect", process.stderr)
        self.assertIn("group", process.stderr)

    def test_a_path_that_is_too_long(self):
        self.assertUnreachable(self.ctl("status", "--socket", "/" + "x" * 200), "shorter")

    def test_the_option_beats_the_environment(self):
        self.serve(status=status())
        answer = self.ctl("status", "--socket", self.socket, env={"SHEARD_SOCKET": "/nowhere"})
        self.assertCode(answer, DONE)

    def test_another_protocol(self):
        self.serve(hello={**WELCOME, "protocol": 7})
        self.assertUnreachable(self.ctl("status"), "version 7", "release")

    def test_version_refused(self):
        def hello(_params, _connection):
            raise Refusal("unsupported_version", "speaks 2 to 3", "use one release")
        self.serve(hello=hello)
        self.assertUnreachable(self.ctl("status"), "speaks 2 to 3", "use one release")

    def test_what_the_client_says_of_itself(self):
        service = self.serve(status=status())
        self.ctl("status")
        hello = service.named("hello")[0]
        self.assertRegex(hello["client"], r"^shearctl \d")
        self.assertEqual([name for name, _ in service.calls], ["hello", "status"])

    def test_something_else_listens(self):
        for raw in (b"SSH-2.0-OpenSSH_9\r\n", b"{}\n", b"[]\n", b"\0\0\0\n", b"null\n", b"\xff\xfe\n",
                    b'{"jsonrpc":"2.0","id":99,"result":{}}\n', b'{"jsonrpc":"2.0","id":1,"result":7}\n',
                    b'{"jsonrpc":"2.0","id":1,"result":{"protocol":"x"}}\n', b"[" * 100000 + b"\n",
                    b'{"jsonrpc":"2.0","id":1,"error":{}}\n', b'{"jsonrpc":"2.0","id":1}\n'):
            with self.subTest(raw=raw[:60]):
                service = FakeService(self.socket, raw=raw)
                answer = self.ctl("status")
                service.close()
                self.assertUnreachable(answer, "not a service that this client knows")

    def test_it_hangs_up(self):
        for raw in (b"", b'{"jsonrpc":"2.0"'):
            service = FakeService(self.socket, raw=raw)
            answer = self.ctl("status")
            service.close()
            self.assertUnreachable(answer, "closed the connection")

    def test_it_hangs_up_later(self):
        self.serve(status=lambda p, c: HANG_UP)
        self.assertUnreachable(self.ctl("status"), "closed the connection")

    def test_too_many_connections(self):
        raw = {"jsonrpc": "2.0", "id": None, "error": {"code": -32013, "message": "100 are connected",
               "data": {"code": "too_many_connections", "advice": "later", "retry": True}}}
        service = FakeService(self.socket, raw=json.dumps(raw).encode() + b"\n")
        self.addCleanup(service.close)
        self.assertUnreachable(self.ctl("status"), "100 are connected", "too_many_connections", "later")

    def test_silence(self):
        stop = threading.Event()
        self.addCleanup(stop.set)
        for method in ("hello", "status"):
            with self.subTest(method=method):
                service = FakeService(self.socket, **{"status": status(), method: lambda p, c: stop.wait(60)})
                answer = self.ctl("status", "--reply-timeout", "300ms")
                service.close()
                self.assertUnreachable(answer, "does not answer", "--reply-timeout")
                self.assertLess(answer.seconds, SLOW)

    def test_a_slow_trickle_ends_at_the_timeout(self):
        stop = threading.Event()
        self.addCleanup(stop.set)

        def trickle(_params, connection):
            while not stop.wait(0.05):
                connection.sendall(b" ")
        self.serve(status=trickle)
        answer = self.ctl("status", "--reply-timeout", "500ms")
        self.assertUnreachable(answer, "does not answer")
        self.assertLess(answer.seconds, SLOW)

    def test_a_full_backlog_ends_at_the_timeout(self):
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(self.socket)
        listener.listen(0)
        waiting = [socket.socket(socket.AF_UNIX) for _ in range(3)]
        for s in waiting:
            s.setblocking(False)
            try:
                s.connect(self.socket)
            except BlockingIOError:
                pass
        answer = self.ctl("status", "--reply-timeout", "300ms")
        for s in (*waiting, listener):
            s.close()
        self.assertUnreachable(answer)
        self.assertLess(answer.seconds, SLOW)

    def test_an_answer_in_pieces_and_notices_between(self):
        def slow(_params, connection):
            line = json.dumps({"jsonrpc": "2.0", "method": "job_progress", "params": {"id": 1, "progress": {}}}) + "\n"
            for i in range(0, len(line), 7):
                connection.sendall(line[i:i + 7].encode())
            send(connection, {"jsonrpc": "2.0", "method": "new_kind_of_news", "params": {"x": 1}})
            return status()
        self.serve(status=slow)
        self.assertCode(self.ctl("status"), DONE)

    def test_a_huge_answer(self):
        page = [job(i) for i in range(5000)]
        self.serve(jobs={"jobs": page, "cursor": None})
        answer = self.ctl("jobs", "--brief")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out.split(), [str(i) for i in range(5000)])

    def test_an_answer_beyond_all_limits(self):
        def huge(_params, connection):
            piece = b"x" * (1 << 20)
            for _ in range(40):
                connection.sendall(piece)
            return {}
        self.serve(status=huge)
        self.assertUnreachable(self.ctl("status"), "longer than")


if __name__ == "__main__":
    unittest.main()
