# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl's subcommands that talk to the service, against a service that says what each test wants."""
import fcntl
import json
import os
import pty
import re
import select
import shutil
import signal
import socket
import subprocess
import threading
import time
import unittest

from fake_service import HANG_UP, WELCOME, FakeService, Refusal, failed, job, send, status, summary
from tool import DONE, INPUT, OTHER, PARTLY, SANITIZED, SANITIZERS, SHEARCTL, USAGE, ToolTest, shearctl

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


class Usage(ServiceTest):
    def test_errors(self):
        self.serve()
        cases = [
            (["submit"], "which files"), (["show"], "which job"), (["wait"], "which jobs"), (["cancel"], "which jobs"),
            (["field"], "which field"), (["field", "a", "b"], "unexpected"), (["jobs", "x"], "unexpected"),
            (["fields", "a", "b"], "unexpected"), (["status", "x"], "unexpected"),
            (["jobs", "--state", "sleeping"], "no state"), (["jobs", "--state", "done,x"], "no state"),
            (["jobs", "--user", "no such user"], "no such user"), (["jobs", "--limit", "0"], "--limit"),
            (["jobs", "--limits", "3"], "--limit"), (["wait", "x"], "not the number"), (["wait", "0"], "not the number"),
            (["wait", "-1"], "-1"), (["wait", "9" * 30], "not the number"), (["wait", "1", "--timeout", "soon"], "--timeout"),
            (["wait", "1", "--timeout", "-3"], "--timeout"), (["status", "--reply-timeout", "0"], "--reply-timeout"),
            (["status", "--reply-timeout", "1y"], "--reply-timeout"), (["watch", "--interval", "1ms"], "--interval"),
            (["watch", "--count", "0"], "--count"), (["watch", "--jobs", "1000"], "--jobs"),
            (["submit", "--priority", "101", "x"], "--priority"), (["submit", "--galaxy", "a", "b.fits"], "either"),
            (["submit", "--galaxy", "a", "--noise", "b"], "belong together"), (["submit", "--key", "k", "a", "b"], "--key"),
            (["submit", "--timeout", "3", "a"], "--wait"), (["submit", "--beta", "wide", "a"], "beta"),
            (["submit", "--galaxy", "a:99999", "--noise", "b", "--psf", "c"], "HDU"), (["submit", "--catalog", "t"], "belong"),
            (["shutdown", "--timeout", "x"], "--timeout"), (["shutdown", "--json=1"], "takes no value"),
        ]
        for args, word in cases:
            with self.subTest(args=args):
                answer = self.ctl(*args)
                self.assertFails(answer, USAGE, word)
                self.assertEqual(answer.out, "")

    def test_help_names_the_exit_codes(self):
        for name in ("submit", "wait"):
            text = shearctl("help", name).out
            for word in ("5 failed", "6 timed out", "7 the", "8 cancelled"):
                self.assertIn(word, " ".join(text.split()))


class Submit(ServiceTest):
    def accept(self, **other):
        numbers = iter(range(1, 1000))
        return self.serve(submit=lambda p, c: {"job": job(next(numbers), "queued", source={
            "path": p.get("path"), "galaxy": p.get("galaxy"), "noise": p.get("noise"), "psf": p.get("psf"),
            "catalog": p.get("catalog")}),
            "known": False}, **other)

    def test_paths_become_absolute_and_links_stay(self):
        service = self.accept()
        os.mkdir(self.path("real"))
        os.symlink("real", self.path("link"))
        os.symlink("/somewhere/else.fits", self.path("real/l.fits"))
        real = os.path.realpath(self.directory)
        answer = self.ctl("submit", "a.fits", "link/../b.fits", "link/l.fits", "/x/../y.fits", cwd=self.directory)
        self.assertCode(answer, DONE)
        self.assertEqual([p["path"] for p in service.named("submit")],
                         [f"{real}/a.fits", f"{real}/b.fits", f"{real}/real/l.fits", "/x/../y.fits"])
        self.assertEqual(answer.out.splitlines()[0], f"job 1 queued: {real}/a.fits")

    def test_a_directory_that_is_not_there(self):
        service = self.accept()
        self.assertFails(self.ctl("submit", "no/such/a.fits"), INPUT, "no/such/a.fits", "directory")
        self.assertFails(self.ctl("submit", "x/"), INPUT, "not the name of a file")
        self.assertEqual(service.named("submit"), [])

    def test_options(self):
        service = self.accept()
        answer = self.ctl("submit", "/a.fits", "--field", "deep", "--priority", "-5", "--force", "--key", "k1", "--beta",
                          "2.5", "--no-noise-correction", "--filter=edge")
        self.assertCode(answer, DONE)
        self.assertEqual(service.named("submit"), [{
            "path": "/a.fits", "field": "deep", "priority": -5, "force": True, "key": "k1",
            "settings": {"beta": 2.5, "noise-correction": False, "filter": "edge"}}])

    def test_separate_images(self):
        service = self.accept()
        self.touch("odd:1")
        parts = ("--galaxy", "/g.fits:2", "--noise", "/n.fits:SKY", "--psf", self.path("odd:1"))
        answer = self.ctl("submit", *parts)
        self.assertCode(answer, DONE)
        self.assertCode(self.ctl("submit", *parts, "--catalog", "/t.fits:STARS"), DONE)
        images = {"galaxy": {"path": "/g.fits", "hdu": 2}, "noise": {"path": "/n.fits", "extname": "SKY"},
                  "psf": {"path": self.path("odd:1")}}
        self.assertEqual(service.named("submit"),
                         [images, {**images, "catalog": {"path": "/t.fits", "extname": "STARS"}}])
        self.assertIn("/g.fits:2 + noise, psf", answer.out)

    def test_job_files(self):
        service = self.accept()
        with open(self.path("j.json"), "w", encoding="utf-8") as file:
            json.dump({"path": "/a.fits", "field": "f", "priority": 3, "wait": True,
                       "settings": {"beta": 2.5, "filter": "edge"}}, file, indent=2)
        self.assertCode(self.ctl("submit", self.path("j.json"), "--priority", "0", "--filter", "none"), DONE)
        process = subprocess.run([SHEARCTL, "submit", "-", "--field", "g"], input=b'{"path": "/b.fits", "force": true}',
                                 capture_output=True, check=False,
                                 env={**os.environ, **SANITIZERS, "SHEARD_SOCKET": self.socket})
        self.assertEqual(process.returncode, DONE, process.stderr)
        self.assertEqual(service.named("submit"), [
            {"path": "/a.fits", "field": "f", "settings": {"beta": 2.5, "filter": "none"}},
            {"path": "/b.fits", "field": "g", "force": True}])

    def test_bad_job_files(self):
        service = self.accept()
        for text, word in (("{", "j.json"), ("[]", "object"), ('{"path": "/a", "colour": 1}', "colour"),
                           ('{"path": "a.fits"}', "path"), ("{}", "path"), ('{"path": "/a", "priority": 1000}', "priority"),
                           (" " * 70000 + "{}", "65536")):
            with open(self.path("j.json"), "w", encoding="utf-8") as file:
                file.write(text)
            with self.subTest(text=text[:40]):
                self.assertFails(self.ctl("submit", self.path("j.json")), INPUT, word)
        self.assertFails(self.ctl("submit", self.path("none.json")), INPUT, "none.json")
        self.assertEqual(service.named("submit"), [])

    def test_json(self):
        self.accept()
        answer = self.ctl("submit", "--json", "/a.fits", "/b.fits")
        self.assertCode(answer, DONE)
        self.assertEqual([r["job"]["id"] for r in answer.json()], [1, 2])

    def test_known_by_its_key(self):
        self.serve(submit={"job": job(7), "known": True})
        self.assertIn("job 7 done (known by its key)", self.ctl("submit", "--key", "k", "/a.fits").out)

    def test_refused(self):
        for code, retry, exit_code in (("queue_full", True, OTHER), ("outside_roots", False, INPUT),
                                       ("not_readable", False, INPUT), ("no_such_file", False, INPUT),
                                       ("bad_setting", False, USAGE), ("draining", True, OTHER),
                                       ("stopping", True, UNREACHABLE), ("of_a_later_version", False, OTHER)):
            def refuse(_params, _connection, code=code, retry=retry):
                raise Refusal(code, "because", "so do this", retry=retry)
            with self.subTest(code=code):
                service = FakeService(self.socket, submit=refuse)
                answer = self.ctl("submit", "/a.fits")
                service.close()
                self.assertFails(answer, exit_code, "/a.fits: because", f"[{code}]", "so do this")

    def test_some_refused(self):
        def some(params, _connection):
            if params["path"] == "/b.fits":
                raise Refusal("no_such_file", "not there")
            return {"job": job(1, "queued"), "known": False}
        service = self.serve(submit=some)
        answer = self.ctl("submit", "/a.fits", "/b.fits", "/c.fits")
        self.assertFails(answer, PARTLY, "/b.fits")
        self.assertEqual(len(service.named("submit")), 3)

    def test_a_full_queue_stops_the_rest(self):
        def full(_params, _connection):
            raise Refusal("queue_full", "full", retry=True)
        service = self.serve(submit=full)
        self.assertFails(self.ctl("submit", "/a.fits", "/b.fits", "/c.fits"), OTHER, "2 more files were not submitted")
        self.assertEqual(len(service.named("submit")), 1)

    def test_wait(self):
        service = self.accept(wait=lambda p, c: {"jobs": [job(i) for i in p["ids"]], "timed_out": False})
        answer = self.ctl("submit", "--wait", "/a.fits", "/b.fits")
        self.assertCode(answer, DONE)
        self.assertEqual([p["ids"] for p in service.named("wait")], [[1, 2]])
        self.assertNotIn("wait", service.named("submit")[0])
        self.assertRegex(answer.out, r"(?m)^ *2 +done +deep +\+0\.02850 \+- 0\.00080 +-0\.03010 \+- 0\.00090 +990 +1000 ")

    def test_wait_json(self):
        self.accept(wait=lambda p, c: {"jobs": [failed(1)], "timed_out": False},
                    job=lambda p, c: {"job": failed(p["id"]), "history": []})
        answer = self.ctl("submit", "--wait", "--json", "/a.fits")
        self.assertCode(answer, JOB_FAILED)
        self.assertEqual([(r["job"]["id"], r["history"]) for r in answer.json()], [(1, [])])

    def test_wait_and_some_refused(self):
        def some(params, _connection):
            if params["path"] == "/b.fits":
                raise Refusal("no_such_file", "not there")
            return {"job": job(1, "queued"), "known": False}
        self.serve(submit=some, wait={"jobs": [job(1)], "timed_out": False})
        self.assertFails(self.ctl("submit", "--wait", "/a.fits", "/b.fits"), PARTLY, "/b.fits")


class Wait(ServiceTest):
    def ended(self, *jobs):
        return self.serve(wait={"jobs": jobs, "timed_out": False})

    def test_exit_codes(self):
        cancelled = job(3, "cancelled")
        for jobs, code in (([job(1)], DONE), ([failed(1)], JOB_FAILED), ([failed(1), failed(2)], JOB_FAILED),
                           ([job(1), failed(2)], PARTLY), ([cancelled], CANCELLED), ([job(1), cancelled], PARTLY),
                           ([failed(1), cancelled], JOB_FAILED)):
            service = self.ended(*jobs)
            answer = self.ctl("wait", *(str(j["id"]) for j in jobs))
            service.close()
            with self.subTest(states=[j["state"] for j in jobs]):
                self.assertCode(answer, code)
                self.assertEqual(len(answer.out.splitlines()), 1 + len(jobs))

    def test_a_failure_is_explained(self):
        self.ended(failed(4))
        self.assertFails(self.ctl("wait", "4"), JOB_FAILED, "job 4 failed: GALAXY: no such HDU [bad_file]",
                         "look into the file")

    def test_timeout(self):
        self.serve(wait=lambda p, c: time.sleep(p["timeout_s"]) or {"jobs": [job(1, "running")], "timed_out": True})
        answer = self.ctl("wait", "1", "--timeout", "200ms")
        self.assertFails(answer, TIMED_OUT, "job 1 is not finished: running")
        self.assertGreaterEqual(answer.seconds, 0.2)
        self.assertLess(answer.seconds, SLOW)

    def test_the_services_own_timeout_is_not_ours(self):
        left = [3]

        def wait(_params, _connection):
            left[0] -= 1
            return {"jobs": [job(1, "running" if left[0] else "done")], "timed_out": left[0] > 0}
        service = self.serve(wait=wait)
        self.assertCode(self.ctl("wait", "1"), DONE)
        self.assertEqual(len(service.named("wait")), 3)

    def test_hundreds_of_jobs(self):
        service = self.serve(wait=lambda p, c: {"jobs": [job(i) for i in p["ids"]], "timed_out": False})
        answer = self.ctl("wait", "--json", *map(str, range(1, 601)))
        self.assertCode(answer, DONE)
        self.assertEqual([len(p["ids"]) for p in service.named("wait")], [256, 256, 88])
        self.assertEqual([j["id"] for line in answer.json() for j in line["jobs"]], list(range(1, 601)))

    def test_no_such_job(self):
        def wait(_params, _connection):
            raise Refusal("no_such_job", "there is no job 9")
        self.serve(wait=wait)
        self.assertFails(self.ctl("wait", "9"), INPUT, "no job 9")

    def test_the_service_dies(self):
        self.serve(wait=lambda p, c: HANG_UP)
        self.assertFails(self.ctl("wait", "1"), UNREACHABLE, "closed the connection", "go on")

    def test_interrupt(self):
        asked, stop = threading.Event(), threading.Event()
        self.addCleanup(stop.set)
        self.serve(wait=lambda p, c: asked.set() or stop.wait(60))
        process = subprocess.Popen([SHEARCTL, "wait", "1"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, **SANITIZERS, "SHEARD_SOCKET": self.socket})
        self.assertTrue(asked.wait(120))
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, OTHER)
        self.assertIn("the jobs go on", err)


class Lists(ServiceTest):
    def test_jobs(self):
        self.serve(jobs={"jobs": [job(3, "running"), failed(2), job(1, outcome="duplicate", duplicate_of=9)],
                         "cursor": None})
        answer = self.ctl("jobs")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.err, "")
        lines = answer.out.splitlines()
        self.assertRegex(lines[0], r"^ID +STATE +FIELD +DONE +PRIO +USER +AGE +TOOK +SOURCE$")
        self.assertRegex(lines[1], r"^ *3 +running +deep +25% +0 +ann .* /data/3\.fits$")
        self.assertRegex(lines[2], r"^ *2 +failed +deep +bad_file .* 3 min 05 s +/data/2\.fits$")
        self.assertRegex(lines[3], r"^ *1 +done +deep +duplicate ")
        self.assertNotIn("\x1b", answer.out)

    def test_job_filters(self):
        service = self.serve(jobs={"jobs": [], "cursor": None})
        self.assertCode(self.ctl("jobs", "--state", "failed,cancelled", "--field", "deep", "--user", "12345", "--limit",
                                 "7", "--cursor", "c1"), DONE)
        self.assertCode(self.ctl("jobs", "--user", "me"), DONE)
        first, second = service.named("jobs")
        self.assertEqual(sorted(first.pop("states")), ["cancelled", "failed"])
        self.assertEqual(first, {"field": "deep", "owner": 12345, "limit": 7, "cursor": "c1"})
        self.assertEqual(second["owner"], os.getuid())

    def test_job_pages(self):
        def pages(params, _connection):
            first = int(params.get("cursor") or 1000)
            return {"jobs": [job(first - i) for i in range(params.get("limit", 50))],
                    "cursor": str(first - params.get("limit", 50))}
        service = self.serve(jobs=pages)
        answer = self.ctl("jobs", "--limit", "450", "--brief")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out.split(), [str(i) for i in range(1000, 550, -1)])
        self.assertEqual([p.get("limit", 50) for p in service.named("jobs")], [200, 200, 50])
        self.assertIn("--cursor 550", answer.err)

    def test_empty_pages_end(self):
        self.serve(jobs={"jobs": [], "cursor": "again"}, fields={"fields": [], "cursor": "again"})
        self.assertCode(self.ctl("jobs"), DONE)
        self.assertCode(self.ctl("fields"), DONE)

    def test_fields(self):
        service = self.serve(fields={"fields": [summary("a"), summary("b", partial=True, unfinished=2, mixed=True),
                                                summary("c", g1=None, g1_err=None)], "cursor": None})
        answer = self.ctl("fields", "pre")
        self.assertCode(answer, DONE)
        self.assertEqual(service.named("fields")[0]["prefix"], "pre")
        lines = answer.out.splitlines()
        self.assertRegex(lines[1], r"^a +\+0\.02850 \+- 0\.00080 +-0\.03010 \+- 0\.00090 +990 +1000 +3 +0 ")
        self.assertRegex(lines[2], r"^b .* 2 .* partial settings d1$")
        self.assertRegex(lines[3], r"^c +- ")
        self.assertEqual(self.ctl("fields", "--brief").out, "a\nb\nc\n")

    def test_json_is_what_the_service_said(self):
        page = {"jobs": [job(1)], "cursor": None}
        fields = {"fields": [summary()], "cursor": None}
        self.serve(jobs=page, fields=fields, status=status(), metrics={"content_type": "text/plain", "text": "a 1\n"},
                   job={"job": job(1), "history": []}, cancel=job(1, "cancelled"), retry=job(1, "queued"),
                   drain={"state": "draining", "running": 1, "queued": 2}, reload={"changed": ["a.b"], "restart": []},
                   shutdown={"state": "stopping", "running": 0, "queued": 0},
                   field={"field": "deep", "mixed": False, "rows": []}, new_member={})
        for args, expected in ((["jobs"], page), (["fields"], fields), (["show", "1"], {"job": job(1), "history": []}),
                               (["cancel", "1"], job(1, "cancelled")), (["retry", "1"], job(1, "queued")),
                               (["status"], status()), (["metrics"], {"content_type": "text/plain", "text": "a 1\n"}),
                               (["drain"], {"state": "draining", "running": 1, "queued": 2}),
                               (["reload"], {"changed": ["a.b"], "restart": []}),
                               (["shutdown"], {"state": "stopping", "running": 0, "queued": 0}),
                               (["field", "deep"], {"field": "deep", "mixed": False, "rows": []})):
            with self.subTest(args=args):
                answer = self.ctl(*args, "--json")
                self.assertCode(answer, DONE)
                self.assertEqual(answer.json(), [expected])
                self.assertEqual(answer.err, "")

    def test_hostile_names_do_not_steer_the_terminal(self):
        evil = "a\x1b[2J\x9b31m\n\r\x07b"
        self.serve(jobs={"jobs": [job(1, field=evil, user=evil)], "cursor": None},
                   fields={"fields": [summary(evil)], "cursor": None}, job={"job": job(1, field=evil), "history": []},
                   status=status(version=evil, problems=[evil]))
        for args in (["jobs"], ["fields"], ["show", "1"], ["status"]):
            with self.subTest(args=args):
                answer = self.ctl(*args, env={"LC_ALL": "C.UTF-8"})
                self.assertCode(answer, DONE)
                self.assertEqual(re.findall(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", answer.out), [])


class One(ServiceTest):
    def test_show(self):
        history = [{"number": 1, "started": "2026-01-31T12:00:01.000Z", "ended": "2026-01-31T12:00:02.500Z",
                    "ending": "failed", "class": "transient", "code": "disk_full", "message": "full"}]
        self.serve(job={"job": job(1, settings={"beta": 2.5, "filter": "edge"}, key="k1"), "history": history})
        answer = self.ctl("show", "1")
        self.assertCode(answer, DONE)
        for line in (r"job 1  done", r"  field      deep", r"  file       /data/1\.fits",
                     r"  stamps     990 of 1000 used \(10 galaxy_not_finite\)", r"  g1         \+0\.02850 \+- 0\.00080",
                     r"  submitted  2026-01-31 14:00:00 by ann \(socket\)", r"  key        k1",
                     r"  finished   2026-01-31 14:03:06 \(took 3 min 05 s\)", r"  warning    the borders are bright",
                     r"  settings   beta=2\.5 filter=edge",
                     r"  attempt    1: 2026-01-31 14:00:01, failed after 1\.5 s, disk_full"):
            self.assertRegex(answer.out, rf"(?m)^{line}$")
        self.assertIn("2026-01-31 12:00:00Z", self.ctl("show", "--utc", "1").out)

    def test_show_failed_and_waiting_and_running(self):
        jobs = {1: failed(1), 2: job(2, "waiting", code="disk_full", message="full", not_before="2026-01-31T13:00:00.000Z",
                                     **{"class": "transient"}), 3: job(3, "running", cancel_asked=True),
                4: job(4, outcome="duplicate", duplicate_of=2)}
        self.serve(job=lambda p, c: {"job": jobs[p["id"]], "history": []})
        text = self.ctl("show", "1", "2", "3", "4").out
        for words in ("bad_file (data): GALAXY: no such HDU", "advice     look into the file", "not before 2026-01-31 15:00",
                      "running (being cancelled)", " 25% 500 stamps/s 0:01 left", "duplicate of job 2"):
            self.assertIn(words, text)

    def test_several_and_some_missing(self):
        def find(params, _connection):
            if params["id"] == 2:
                raise Refusal("no_such_job", "there is no job 2")
            return {"job": job(params["id"]), "history": []}
        service = self.serve(job=find)
        self.assertFails(self.ctl("show", "1", "2", "3"), PARTLY, "no job 2")
        self.assertEqual(len(service.named("job")), 3)
        self.assertFails(self.ctl("show", "2"), INPUT, "no job 2")

    def test_cancel_and_retry(self):
        def refuse(_params, _connection):
            raise Refusal("not_owner", "job 1 is ann's", "ask ann")
        service = self.serve(cancel=lambda p, c: job(p["id"], "running", cancel_asked=True), retry=refuse)
        answer = self.ctl("cancel", "4", "5")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out, "job 4 running, being cancelled\njob 5 running, being cancelled\n")
        self.assertFails(self.ctl("retry", "1"), OTHER, "job 1 is ann's", "ask ann", "not_owner")
        self.assertEqual(service.named("cancel"), [{"id": 4}, {"id": 5}])

    def test_field(self):
        from fake_service import REPORT
        row = {**REPORT, "digest": "d1", "jobs": 3, "unfinished": 2, "partial": True, "running": [31, 32],
               "updated": "2026-01-31T12:03:06.000Z", "more": True,
               "contributions": [{"id": 5, "job": 4, "checksum": "c4", "n_stamps": 100, "n_used": 99,
                                  "counted": "2026-01-31T12:03:06.000Z"}]}
        service = self.serve(field={"field": "deep", "mixed": True, "rows": [row, {**row, "digest": "d2"}]})
        answer = self.ctl("field", "deep")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out.count("field deep  (partial: more is to come)\n"), 2)
        self.assertIn("3 counted, 2 to come (running: 31, 32)", answer.out)
        self.assertIn("kept apart", answer.err)
        self.assertRegex(self.ctl("field", "deep", "--jobs").out, r"(?m)^ +5 +4 +99 +100 +2026-01-31 14:03:06 +c4$")
        self.ctl("field", "deep", "--digest", "d2", "--after", "5", "--limit", "3")
        self.assertEqual(service.named("field"), [{"field": "deep"}, {"field": "deep"},
                                                  {"field": "deep", "digest": "d2", "after": 5, "limit": 3}])

    def test_no_such_field(self):
        def refuse(_params, _connection):
            raise Refusal("no_such_field", "there is no field x")
        self.serve(field=refuse)
        self.assertFails(self.ctl("field", "x"), INPUT, "no field x")


class State(ServiceTest):
    def test_status(self):
        self.serve(status=status(state="draining", problems=["the disk is nearly full"]))
        answer = self.ctl("status")
        self.assertCode(answer, DONE)
        for words in ("sheard 0.1.0  draining  pid 4711  up 2 h 03 min", "queued 9  running 2  waiting 1  done 40  failed 3",
                      "12 of 1000 unfinished", "3 of 4 busy", "12345/s stamps, 0.25/s jobs", "5.0 GiB free", "2.0 MiB",
                      "problem    the disk is nearly full", "started    2026-01-31 14:00:00"):
            self.assertIn(words, answer.out)

    def test_status_without_a_spool(self):
        self.serve(status=status(spool=None))
        self.assertRegex(self.ctl("status").out, r"(?m)^  spool      none$")

    def test_metrics(self):
        self.serve(metrics={"content_type": "text/plain", "text": "# HELP a b\na 1\n"})
        self.assertEqual(self.ctl("metrics").out, "# HELP a b\na 1\n")

    def test_drain_reload_shutdown(self):
        service = self.serve(drain={"state": "draining", "running": 2, "queued": 5},
                             reload={"changed": ["limits.queue"], "restart": ["daemon.workers"],
                                     "warnings": ["data root /d is missing"]},
                             shutdown={"state": "stopping", "running": 1, "queued": 0})
        self.assertEqual(self.ctl("drain").out, "draining: 2 jobs running, 5 wait for the next start\n")
        self.assertEqual(self.ctl("reload").out, "changed: limits.queue\nneeds a restart: daemon.workers\n"
                         "warning: data root /d is missing\n")
        self.assertIn("stopping", self.ctl("shutdown", "--now", "--timeout", "2min").out)
        self.assertEqual(service.named("shutdown"), [{"mode": "now", "timeout_s": 120}])

    def test_shutdown_tells_who_starts_it_again(self):
        stopping = {"state": "stopping", "running": 0, "queued": 0}
        self.serve(status=status(activated=True), shutdown=stopping)
        self.assertIn("systemctl stop sheard.service", self.ctl("shutdown").out)
        self.assertEqual(self.ctl("shutdown", "--json").json(), [stopping])

    def test_shutdown_of_a_service_of_its_own_socket(self):
        self.serve(status=status(), shutdown={"state": "stopping", "running": 0, "queued": 0})
        self.assertNotIn("systemctl", self.ctl("shutdown").out)

    def test_not_admin(self):
        def refuse(_params, _connection):
            raise Refusal("not_admin", "you are no administrator")
        self.serve(drain=refuse, reload=refuse, shutdown=refuse)
        for name in ("drain", "reload", "shutdown"):
            self.assertFails(self.ctl(name), OTHER, "you are no administrator", "not_admin")

    def test_watch_lines(self):
        service = self.serve(status=status(), jobs=lambda p, c: {"jobs": [job(1, "running")] if p["states"] == ["running"]
                             else [job(2), failed(3)], "cursor": None},
                             fields={"fields": [summary("deep"), summary("deeper")], "cursor": None})
        answer = self.ctl("watch", "--count", "2", "--interval", "50ms")
        self.assertCode(answer, DONE)
        self.assertNotIn("\x1b", answer.out)
        self.assertEqual(answer.out.count("3 of 4 busy"), 2)
        self.assertRegex(answer.out, r"\[#####\.+\] +25% 500 stamps/s 0:01 left")
        self.assertNotIn("deeper", answer.out)  # begins alike, but no job's field
        self.assertEqual(len(service.named("hello")), 1)
        lines = self.ctl("watch", "--json", "--count", "3", "--interval", "50ms").json()
        self.assertEqual(len(lines), 3)
        self.assertEqual(lines[0]["status"], status())
        self.assertEqual([sorted(line) for line in lines], [["active", "fields", "finished", "status"]] * 3)

    def test_watch_lines_end_when_the_service_goes(self):
        left = [2]

        def answer(_params, _connection):
            left[0] -= 1
            return status() if left[0] >= 0 else HANG_UP
        self.serve(status=answer, jobs={"jobs": [], "cursor": None})
        self.assertFails(self.ctl("watch", "--json", "--interval", "50ms"), UNREACHABLE, "closed the connection")


PROBED = {"ok": True, "code": None, "message": None, "advice": None, "g1": 0.0199, "g1_err": 5e-5, "g2": -0.01, "g2_err": 5e-5,
          "true_g1": 0.02, "true_g2": -0.01, "stamps": 16, "seconds": 0.04, "landlock": True}


class Doctor(ServiceTest):
    def findings(self, *args, **how):
        answer = self.ctl("doctor", "--json", *args, **how)
        return answer, {f["subject"]: f for f in answer.json()}

    def test_a_sound_service(self):
        self.serve(status=status(roots=[{"path": self.path(""), "missing": False, "reason": None}]), probe=PROBED)
        os.chmod(self.socket, 0o660)
        answer, found = self.findings()
        for name in ("socket", "permissions", "release", "service", "probe", "sandbox", "data root"):
            self.assertEqual(found[name]["level"], "ok", found[name])
            self.assertEqual(found[name]["remedy"], "")
        self.assertIn(answer.code, (DONE, OTHER))
        self.assertEqual(answer.code == OTHER, "fail" in {json.loads(line)["level"] for line in answer.out.splitlines()})

    def test_warnings(self):
        self.serve(status=status(state="draining", problems=["slow disk"], queue={"length": 5, "capacity": 5, "blocks": 0}),
                   hello={**WELCOME, "server": "sheard 9.9"})
        os.chmod(self.socket, 0o666)
        _, found = self.findings()
        for name in ("permissions", "release", "service", "queue"):
            self.assertEqual(found[name]["level"], "warn", found[name])
            self.assertTrue(found[name]["remedy"])

    def test_no_service(self):
        answer, found = self.findings()
        self.assertCode(answer, OTHER)
        for name in ("socket", "service"):
            self.assertEqual(found[name]["level"], "fail")
            self.assertIn("systemctl start", found[name]["remedy"])
        self.touch("s.sock")
        answer, found = self.findings()
        self.assertIn("not a socket", found["socket"]["message"])

    def program(self, check=0, text="the configuration is good", roots=""):
        """A sheard of our own, that says this of its configuration; the PATH to find it on."""
        os.makedirs(self.path("bin"), exist_ok=True)
        path = self.path("bin/sheard")
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"""#!/bin/sh
case "$1" in
--version) echo "sheard 0.1.0" ;;
--check-config) echo "{text}"; exit {check} ;;
--print-config) cat <<END
[daemon]
# default
state_dir = {self.path("state")}
socket = {self.socket}
[spool]
enabled = true
directory = {self.path("spool")}
[access]
data_roots ={roots}
END
;;
esac
""")
        os.chmod(path, 0o755)
        return {"PATH": self.path("bin") + ":" + os.environ["PATH"]}

    def alone(self, env, **me):
        """Findings of a copy of the tool that has no sheard beside it: the one of PATH is found."""
        os.makedirs(self.path("alone"), exist_ok=True)
        tool = shutil.copy(SHEARCTL, self.path("alone/shearctl"))
        process = subprocess.run([tool, "doctor", "--json"], capture_output=True, text=True, check=False, timeout=120,
                                 env={**os.environ, **SANITIZERS, "SHEARD_SOCKET": self.socket, **env}, **me)
        found = [json.loads(line) for line in process.stdout.splitlines()]
        return process.returncode, found, {f["subject"]: f for f in found}

    def test_the_service_is_asked(self):
        """For what it sees, of its own configuration: nothing of that is here."""
        reason = "data root /mnt/away is missing: No such file or directory"
        gone = {"path": "/mnt/away", "missing": True, "reason": reason}
        disks = [{"use": use, "path": f"/nonexistent/{use}", "free_bytes": n << 30, "bytes": 9 << 30,
                  "same_as": None, "problem": None} for use, n in (("state", 6), ("spool", 5), ("catalogues", 4))]
        self.serve(status=status(config="/nonexistent/other.conf", state_dir="/nonexistent/state",
                                 spool={**status()["spool"], "path": "/nonexistent/spool"}, disks=disks,
                                 roots=[{"path": "/nonexistent/data", "missing": False, "reason": None}, gone]),
                   probe=PROBED)
        _, all_found, found = self.alone(self.program())
        self.assertEqual(found["state"]["level"], "ok")
        for use, n in (("state", 6), ("spool", 5), ("catalogues", 4)):
            self.assertIn(f"/nonexistent/{use}: {n}", found[use]["message"])
        roots = [(f["level"], f["message"]) for f in all_found if f["subject"] == "data root"]
        self.assertEqual(roots[0][0], "warn")
        self.assertIn("/nonexistent/data is there for the service, but you may not", roots[0][1])
        self.assertEqual(roots[1], ("warn", reason))
        self.assertEqual(found["config"]["level"], "warn")
        self.assertIn("/nonexistent/other.conf", found["config"]["message"])
        self.assertEqual([f for f in all_found if f["level"] == "fail"], [])
        for name in ("view", "lock", "seccomp"):
            self.assertNotIn(name, found)

    def test_a_disk_of_the_service(self):
        """Every one that it writes to: gone, or full."""
        disk = {"use": "state", "path": "/s", "free_bytes": 6 << 30, "bytes": 9 << 30, "same_as": None, "problem": None}
        gone = {**disk, "use": "catalogues", "path": "/c", "free_bytes": 0, "problem": "No such file or directory"}
        full = {**disk, "use": "scratch", "path": "/t", "free_bytes": 0}
        self.serve(status=status(config=self.touch("sheard.conf"), disks=[disk, gone, full]), probe=PROBED)
        answer, found = self.findings()
        self.assertCode(answer, OTHER)
        self.assertEqual({use: (found[use]["level"], found[use]["message"]) for use in ("state", "catalogues", "scratch")},
                         {"state": ("ok", "/s: 6.0 GiB free"), "catalogues": ("fail", "/c: No such file or directory"),
                          "scratch": ("fail", "/t: only 0 B free")})

    def test_data_roots_are_the_services_word(self):
        """What --check-config makes of them here counts only where nobody answers."""
        self.serve(status=status(config=self.touch("sheard.conf")), probe=PROBED)
        env = self.program(text="sheard.conf:3: warning: [access] data_roots: '/x': Permission denied")
        self.assertEqual(self.alone(env)[2]["config"]["level"], "ok")
        env = self.program(text="sheard.conf:3: warning: [limits] connections: needs more")
        self.assertEqual(self.alone(env)[2]["config"]["level"], "warn")

    def test_what_the_service_cannot_measure(self):
        self.serve(status=status(), probe={**PROBED, "ok": False, "code": "io", "message": "no library", "advice": "install it",
                                           "g1": None})
        answer, found = self.findings()
        self.assertCode(answer, OTHER)
        self.assertEqual(found["probe"]["level"], "fail")
        self.assertIn("no library [io]", found["probe"]["message"])
        self.assertEqual(found["probe"]["remedy"], "install it")

    def test_without_landlock(self):
        self.serve(status=status(), probe={**PROBED, "landlock": False})
        self.assertEqual(self.findings()[1]["sandbox"]["level"], "warn")

    def test_an_older_service(self):
        """It tells neither paths nor whether it measures: the rest is looked at as without it."""
        old = {k: v for k, v in status().items() if k not in ("config", "state_dir", "catalogues", "user", "roots")}
        self.serve(status=old)
        _, found = self.findings()
        for name in ("probe", "view"):
            self.assertEqual(found[name]["level"], "warn")
        self.assertIn("seccomp", found)

    def test_it_tries_to_write(self):
        """That the directory is there is not enough."""
        for name in ("state", "data", "spool/incoming", "spool/active", "spool/done", "spool/failed"):
            os.makedirs(self.path(name))
        for top, _, _ in os.walk(self.path("")):
            os.chmod(top, 0o777)
        env = self.program(roots=f" {self.path('data')}")
        _, _, found = self.alone(env)
        for name in ("state", "spool"):
            self.assertEqual(found[name]["level"], "ok", found[name])
        self.assertEqual(found["view"]["level"], "warn")
        self.assertIn("with the eyes of", found["view"]["message"])
        for name in ("state", "spool/done"):
            os.chmod(self.path(name), 0o555)
        me = {}
        if os.geteuid() == 0:  # root may write everywhere
            me = {"user": 65534, "group": 65534, "extra_groups": []}
            for name in ("state", "spool/done"):
                os.chown(self.path(name), 65534, 65534)
        code, all_found, _ = self.alone(env, **me)
        self.assertEqual(code, OTHER)
        for name in ("state", "spool"):
            bad = [f for f in all_found if f["subject"] == name and f["level"] == "fail"]
            self.assertEqual(len(bad), 1, all_found)
            self.assertIn("may not write there", bad[0]["message"])

    def test_configuration_and_disks(self):
        os.mkdir(self.path("state"))
        for name in ("incoming", "active", "done", "failed"):
            os.makedirs(self.path(f"spool/{name}"))
        os.mkdir(self.path("data"))
        env = self.program(roots=f" {self.path('data')},\n    {self.path('gone')}")
        for top, _, _ in os.walk(self.path("")):
            os.chmod(top, 0o777)
        code, _, found = self.alone(env)
        for name in ("program", "config", "clock", "state", "lock"):
            self.assertEqual(found[name]["level"], "ok", found[name])
        self.assertIn("not locked", found["lock"]["message"])
        self.assertIn("gone", found["data root"]["message"])
        self.assertEqual(code, OTHER)
        with open(self.path("spool/.lock"), "w", encoding="ascii") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertIn("no service answers", self.alone(env)[2]["lock"]["message"])
        os.rmdir(self.path("spool/done"))
        _, found, _ = self.alone(env)
        self.assertIn(("fail", "spool"), [(f["level"], f["subject"]) for f in found if "spool/done" in f["message"]])

    def test_a_bad_configuration(self):
        self.serve(status=status(config=self.touch("sheard.conf")))
        code, _, found = self.alone(self.program(3, "sheard.conf:7: error: unknown key"))
        self.assertEqual(code, OTHER)
        self.assertIn("sheard.conf:7: error: unknown key", found["config"]["message"])

    def test_no_program(self):
        self.serve(status=status())
        os.makedirs(self.path("empty"))
        _, _, found = self.alone({"PATH": self.path("empty")})
        if not any(os.path.exists(f"{d}/sheard") for d in ("/usr/local/sbin", "/usr/sbin", "/usr/bin")):
            self.assertEqual(found["program"]["level"], "warn")
            self.assertEqual(found["state"]["level"], "ok", "the service tells")
            self.assertNotIn("config", found)

    def test_lines(self):
        self.serve(status=status())
        answer = self.ctl("doctor")
        self.assertRegex(answer.out, r"(?m)^OK    socket       \S+ is there$")
        self.assertNotIn("\x1b", answer.out)


class OnATerminal(ServiceTest):
    def start(self, *args, columns=100, term="xterm"):
        """shearctl with all three streams on a terminal of so many columns."""
        main, other = pty.openpty()
        self.addCleanup(os.close, main)
        subprocess.run(["stty", "cols", str(columns), "rows", "30"], stdin=other, check=True)
        process = subprocess.Popen([SHEARCTL, *args], stdin=other, stdout=other, stderr=other, start_new_session=True,
                                   env={**os.environ, **SANITIZERS, "TERM": term, "LC_ALL": "C.UTF-8",
                                        "SHEARD_SOCKET": self.socket, "NO_COLOR": ""})
        os.close(other)
        return process, main

    def read(self, main, until=None):
        text, end = "", time.monotonic() + 120
        while time.monotonic() < end and (until is None or until not in text):
            if not select.select([main], [], [], 0.1)[0]:
                continue
            try:
                piece = os.read(main, 65536)
            except OSError:  # Linux's end of a pseudo terminal
                break
            if not piece:
                break
            text += piece.decode("utf-8", "replace")
        if until is not None:
            self.assertIn(until, text)
        return text

    def test_tables_have_colours_and_fit(self):
        self.serve(jobs={"jobs": [job(1), failed(2, source={"path": "/" + "long/" * 40})], "cursor": None})
        process, main = self.start("jobs", columns=60)
        text = self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertIn("\x1b[32mdone\x1b[0m", text)
        plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text)
        self.assertLessEqual(max(map(len, plain.splitlines())), 60)

    def test_wait_shows_a_bar_from_notifications(self):
        go = threading.Event()

        def wait(_params, connection):
            for done in (100, 500, 900):
                send(connection, {"jsonrpc": "2.0", "method": "job_progress", "params": {
                    "id": 1, "progress": {"done": done, "total": 1000, "rate": 100.0, "eta_s": 1.0}}})
                time.sleep(0.15)
            go.wait(120)
            return {"jobs": [job(1)], "timed_out": False}
        service = self.serve(subscribe={"jobs": 1, "fields": 0, "all": False}, wait=wait)
        process, main = self.start("wait", "1")
        text = self.read(main, until=" 90% 100 stamps/s 0:01 left")
        go.set()
        text += self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertRegex(text, r"job 1 \[#+\.+\]")
        self.assertEqual(service.named("subscribe"), [{"jobs": [1], "progress": True}])

    def test_wait_polls_where_it_may_not_subscribe(self):
        left = [3]

        def wait(_params, _connection):
            left[0] -= 1
            time.sleep(0.15)
            return {"jobs": [job(1, "running" if left[0] else "done")], "timed_out": left[0] > 0}

        def refuse(_params, _connection):
            raise Refusal("too_many_subscriptions")
        service = self.serve(subscribe=refuse, wait=wait)
        process, main = self.start("wait", "1")
        text = self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertIn(" 25% 500 stamps/s 0:01 left", text)
        self.assertEqual([p["timeout_s"] for p in service.named("wait")], [1, 1, 1])

    def watched(self, **other):
        return self.serve(**{"status": status(), "jobs": lambda p, c: {"jobs": [job(1, "running")], "cursor": None},
                             "fields": {"fields": [summary()], "cursor": None}, **other})

    def test_watch_and_q(self):
        self.watched()
        process, main = self.start("watch", "--interval", "100ms")
        text = self.read(main, until="q ends")
        self.assertIn("\x1b[?1049h", text)
        os.write(main, b"q")
        text = self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertTrue(text.rstrip().endswith("\x1b[?1049l"), text[-40:])

    def test_watch_and_signals(self):
        self.watched()
        for number in (signal.SIGINT, signal.SIGTERM):
            process, main = self.start("watch", "--interval", "1h")
            self.read(main, until="q ends")
            process.send_signal(number)
            self.assertIn("\x1b[?1049l", self.read(main))
            self.assertEqual(process.wait(120), DONE)

    def test_watch_resizes(self):
        self.watched()
        process, main = self.start("watch", "--interval", "1h", columns=200)
        wide = self.read(main, until="\x1b[J")  # the end of a picture
        subprocess.run(["stty", "cols", "40", "rows", "10"], stdin=main, check=True)
        process.send_signal(signal.SIGWINCH)
        text = self.read(main, until="\x1b[J")
        os.write(main, b"q")
        process.wait(120)
        plain = [re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", line) for line in text.split("\r\n")]
        self.assertLessEqual(max(map(len, plain)), 40)
        self.assertLessEqual(len(plain), 10)
        self.assertGreater(len(wide), len(text))

    def test_watch_waits_for_a_service_that_went_away(self):
        service = self.watched()
        process, main = self.start("watch", "--interval", "100ms")
        self.read(main, until="q ends")
        service.close()
        self.read(main, until="no socket")
        self.watched()
        self.read(main, until="3 of 4 busy")
        os.write(main, b"q")
        self.assertEqual(process.wait(120), DONE)

    def test_watch_ends_while_the_service_is_silent(self):
        stop = threading.Event()
        self.addCleanup(stop.set)
        asked = threading.Event()
        self.watched(status=lambda p, c: asked.set() or stop.wait(60))
        process, _ = self.start("watch")
        self.assertTrue(asked.wait(120))
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(120), DONE)


class Completions(ServiceTest):
    def test_data_names_every_option_of_the_help(self):
        lines = shearctl("help", "--completion-data").out.splitlines()
        commands = [line.split("|") for line in lines if line.startswith("command|")]
        options = [line.split("|") for line in lines if line.startswith("option|")]
        self.assertEqual({len(c) for c in commands}, {4})
        self.assertEqual({len(o) for o in options}, {6})
        self.assertEqual(len(commands) + len(options), len(lines))
        for name in (c[1] for c in commands):
            text = shearctl("help", name).out
            said = set(re.findall(r"(?m)^  (?:-\w, )?(--[a-z-]+)", text)) | {"--help"}
            self.assertEqual(said - {o[2] for o in options if o[1] == name}, set(), name)
        self.assertIn(["option", "submit", "--zeros", "POLICY", "skip floor"], [o[:5] for o in options])
        self.assertIn(["option", "submit", "--no-noise-correction"], [o[:3] for o in options])


if __name__ == "__main__":
    unittest.main()
