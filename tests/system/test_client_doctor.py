# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl doctor."""
import fcntl
import json
import os
import shutil
import subprocess
import unittest

from fake_service import WELCOME, failed, status
from service_test import ServiceTest
from tool import DONE, OTHER, SANITIZERS, SHEARCTL, shearctl


PROBED = {"ok": True, "code": None, "message": None, "advice": None, "g1": 0.0199, "g1_err": 5e-5, "g2": -0.01,
          "g2_err": 5e-5,
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
        """A sheard that reports this about its configuration; returns the PATH that finds it."""
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
        """Findings of a copy of the tool without a sheard beside it, so that the one of PATH is found."""
        os.makedirs(self.path("alone"), exist_ok=True)
        tool = shutil.copy(SHEARCTL, self.path("alone/shearctl"))
        process = subprocess.run([tool, "doctor", "--json"], capture_output=True, text=True, check=False, timeout=120,
                                 env={**os.environ, **SANITIZERS, "SHEARD_SOCKET": self.socket, **env}, **me)
        found = [json.loads(line) for line in process.stdout.splitlines()]
        return process.returncode, found, {f["subject"]: f for f in found}

    def test_the_service_is_asked(self):
        """The running service is asked about its own configuration, of which nothing is here."""
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
        """Every directory that the service writes to: missing, or full."""
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
        """The result of --check-config here counts only if no service answers."""
        self.serve(status=status(config=self.touch("sheard.conf")), probe=PROBED)
        env = self.program(text="sheard.conf:3: warning: [access] data_roots: '/x': Permission denied")
        self.assertEqual(self.alone(env)[2]["config"]["level"], "ok")
        env = self.program(text="sheard.conf:3: warning: [limits] connections: needs more")
        self.assertEqual(self.alone(env)[2]["config"]["level"], "warn")

    def test_what_the_service_cannot_measure(self):
        self.serve(status=status(),
                   probe={**PROBED, "ok": False, "code": "io", "message": "no library", "advice": "install it",
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
        """An old service reports neither paths nor whether it measures: the rest is checked as without a service."""
        old = {k: v for k, v in status().items() if k not in ("config", "state_dir", "catalogues", "user", "roots")}
        self.serve(status=old)
        _, found = self.findings()
        for name in ("probe", "view"):
            self.assertEqual(found[name]["level"], "warn")
        self.assertIn("seccomp", found)

    def test_it_tries_to_write(self):
        """It is not enough that the directory exists."""
        for name in ("state", "data", "spool/incoming", "spool/active", "spool/done", "spool/failed"):
            os.makedirs(self.path(name))
        for top, _, _ in os.walk(self.path("")):
            os.chmod(top, 0o777)
        env = self.program(roots=f" {self.path('data')}")
        _, _, found = self.alone(env)
        for name in ("state", "spool"):
            self.assertEqual(found[name]["level"], "ok", found[name])
        self.assertEqual(found["view"]["level"], "warn")
        self.assertIn("what is visible to", found["view"]["message"])
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


if __name__ == "__main__":
    unittest.main()
