# SPDX-License-Identifier: GPL-3.0-or-later
"""The units: what systemd says of them, and that they agree with the daemon's defaults.

SHEARD_SERVICE is the service as built, SHEARD_SYSTEMD the folder with the other files, SHEARD_SAMPLE the sample of
sheard.conf. What systemd itself must answer is skipped, and says so, where its programs are missing."""
import os
import re
import shutil
import stat
import subprocess
import tempfile
import unittest

from unit_filter import allowed, entries, text_of

SERVICE = os.environ["SHEARD_SERVICE"]
SYSTEMD = os.environ["SHEARD_SYSTEMD"]
SAMPLE = os.environ["SHEARD_SAMPLE"]
EXPOSURE = 1.0  # at most, on systemd's scale from 0 to 10


def needs(program):
    return unittest.skipUnless(shutil.which(program), f"{program} is not installed (Debian package systemd)")


def companion(name):
    return os.path.join(SYSTEMD, name)


def seconds(text):
    number, unit = re.fullmatch(r"(\d+)(ms|s|min|h|d)", text).groups()
    return int(number) * {"ms": 1e-3, "s": 1, "min": 60, "h": 3600, "d": 86400}[unit]


def defaults():
    """{"section.key": "value"} of the sample's settings, which are behind a '#'."""
    found, section = {}, None
    for line in text_of(SAMPLE).splitlines():
        head = re.fullmatch(r"\[(\w+)\]", line)
        setting = re.fullmatch(r"#([\w-]+) =(?: (.*))?", line)
        if head:
            section = head[1]
        elif setting:
            found[f"{section}.{setting[1]}"] = setting[2] or ""
    return found


def runnable(text):
    """The service with programs that exist, so that systemd does not miss ours, which is not installed here."""
    true, kill = shutil.which("true"), shutil.which("kill") or shutil.which("true")
    return re.sub(r"(?m)^(Exec\w+)=sheard ", rf"\1={true} ", text).replace("=kill ", f"={kill} ")


class Analyzed(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name

    def put(self, name, text):
        path = os.path.join(self.directory, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def complaints(self, service):
        """What systemd-analyze says about our own files; its exit code is 0 for unknown keys."""
        paths = [self.put("sheard.service", runnable(service)),
                 *(self.put(name, text_of(companion(name))) for name in ("sheard.socket", "sheard.path"))]
        process = subprocess.run(["systemd-analyze", "verify", "--man=no", *paths], capture_output=True, text=True,
                                 check=False)
        lines = [line for line in process.stderr.splitlines() if "sheard" in line]
        return lines or ([process.stderr] if process.returncode else [])

    def exposure(self, service):
        path = self.put("sheard.service", runnable(service))
        process = subprocess.run(["systemd-analyze", "security", "--offline=true", "--no-pager", path],
                                 capture_output=True, text=True, check=False)
        match = re.search(r"Overall exposure level for \S+: ([\d.]+)", process.stdout)
        self.assertTrue(match, process.stdout + process.stderr)
        return float(match[1]), process.stdout


@needs("systemd-analyze")
class Verified(Analyzed):
    def test_no_complaints(self):
        self.assertEqual(self.complaints(text_of(SERVICE)), [])

    def test_a_misspelt_key_would_be_seen(self):
        self.assertTrue(self.complaints(text_of(SERVICE).replace("Restart=", "Restat=")))

    def test_a_missing_program_would_be_seen(self):
        self.assertTrue(self.complaints(text_of(SERVICE).replace("ExecStart=sheard", "ExecStart=/nonexistent/sheard")))


@needs("systemd-analyze")
class Hardened(Analyzed):
    def test_exposure(self):
        number, report = self.exposure(text_of(SERVICE))
        self.assertLessEqual(number, EXPOSURE, report)

    def test_exposure_with_home_data(self):
        number, report = self.exposure(text_of(SERVICE) + text_of(companion("home-data.conf")))
        self.assertLessEqual(number, EXPOSURE, report)

    def test_an_open_service_would_be_seen(self):
        number, _ = self.exposure("[Service]\nExecStart=sheard \n")
        self.assertGreater(number, 5)


@needs("systemd-analyze")
class SystemCalls(unittest.TestCase):
    NEEDED = """seccomp prctl memfd_create prlimit64 inotify_init1 inotify_add_watch epoll_wait clone3 wait4
                pidfd_open fsync fdatasync renameat2 linkat ftruncate accept4 sendmsg recvmsg socketpair fcntl flock
                signalfd4 timerfd_create eventfd2 fallocate statfs getdents64 setpriority lchown mmap mprotect
                kill""".split()
    FORBIDDEN = """ptrace process_vm_readv mount umount2 bpf perf_event_open kexec_load init_module reboot swapon
                   setuid chroot pivot_root keyctl add_key mlockall userfaultfd clock_settime chown""".split()

    def test_what_the_daemon_and_its_readers_need(self):
        self.assertEqual(set(self.NEEDED) - allowed(text_of(SERVICE)), set())

    def test_what_nobody_needs(self):
        self.assertEqual(set(self.FORBIDDEN) & allowed(text_of(SERVICE)), set())


class Agreement(unittest.TestCase):
    """The unit files agree with the daemon's defaults."""

    def setUp(self):
        self.service = {key: values[-1] for key, values in entries(text_of(SERVICE)).items()}
        self.socket = {key: values[-1] for key, values in entries(text_of(companion("sheard.socket"))).items()}
        self.defaults = defaults()

    def test_life(self):
        self.assertEqual(self.service["Type"], "notify")
        self.assertGreater(seconds(self.service["WatchdogSec"]), 0)
        self.assertEqual(self.service["Restart"], "on-failure")
        self.assertRegex(self.service["ExecStart"], r"^sheard --config /\S+/sheard\.conf$")

    def test_reload_checks_first(self):
        check, signal = entries(text_of(SERVICE))["ExecReload"]
        self.assertEqual(check, self.service["ExecStart"].replace("sheard ", "sheard --check-config ", 1))
        self.assertEqual(signal, "kill -HUP $MAINPID")

    def test_stop_is_graceful(self):
        self.assertEqual(self.service["KillMode"], "mixed")  # readers must not get SIGTERM while jobs drain
        self.assertGreater(seconds(self.service["TimeoutStopSec"]), seconds(self.defaults["daemon.drain_timeout"]))

    def test_a_reader_killed_for_memory_does_not_stop_the_service(self):
        self.assertEqual(self.service["OOMPolicy"], "continue")

    def test_clients_are_told_apart(self):
        self.assertNotIn("PrivateUsers", self.service)  # SO_PEERCRED would say "nobody" of all of them

    def test_sandbox(self):
        for key, value in (("User", "sheard"), ("NoNewPrivileges", "yes"), ("RestrictAddressFamilies", "AF_UNIX"),
                           ("CapabilityBoundingSet", ""), ("ProtectSystem", "strict"), ("ProtectHome", "yes")):
            self.assertEqual(self.service[key], value)

    def test_directories(self):
        state = ["/var/lib/" + name for name in self.service["StateDirectory"].split()]
        self.assertIn(self.defaults["daemon.state_dir"], state)
        self.assertIn(self.defaults["catalogues.directory"], state)
        self.assertEqual(self.service["ReadWritePaths"], "-" + self.defaults["spool.directory"])
        self.assertEqual(os.path.dirname(self.defaults["daemon.socket"]), "/run/" + self.service["RuntimeDirectory"])
        self.assertEqual(self.service["RuntimeDirectoryPreserve"], "yes")

    def test_descriptors(self):
        needed = int(self.defaults["limits.connections"]) + 64 + 6 * int(self.defaults["daemon.max_active_jobs"])
        self.assertGreaterEqual(int(self.service["LimitNOFILE"]), needed)

    def test_dropped_files_start_it(self):
        watched = entries(text_of(companion("sheard.path")))["DirectoryNotEmpty"]
        self.assertEqual(watched, [self.defaults["spool.directory"] + "/incoming"])

    def test_all_three_are_started_and_stopped_together(self):
        self.assertEqual(self.service["Wants"], "sheard.socket sheard.path")
        self.assertEqual(self.service["Also"], "sheard.socket sheard.path")
        self.assertEqual(self.socket["Wants"], "sheard.path")
        for name in ("sheard.socket", "sheard.path"):
            self.assertEqual(entries(text_of(companion(name)))["PartOf"], ["sheard.service"])

    def test_what_does_not_pass_is_not_tried_again(self):
        self.assertEqual(self.service["RestartPreventExitStatus"], "2 3")  # usage, configuration: sheard(8)

    def test_socket(self):
        self.assertEqual(self.socket["ListenStream"], self.defaults["daemon.socket"])
        self.assertEqual(self.socket["SocketMode"], self.defaults["daemon.socket_mode"])
        self.assertEqual((self.socket["SocketUser"], self.socket["SocketGroup"]), ("sheard", "sheard"))


class UserAndFolders(unittest.TestCase):
    """sysusers.d and tmpfiles.d, carried out beneath an empty root."""

    MODES = {"var/spool/sheard": 0o755, "var/spool/sheard/incoming": 0o3770, "var/spool/sheard/active": 0o2750,
             "var/spool/sheard/done": 0o2750, "var/spool/sheard/failed": 0o2750, "run/sheard": 0o755}

    @needs("systemd-sysusers")
    @needs("systemd-tmpfiles")
    @unittest.skipUnless(os.geteuid() == 0, "needs root: files are given to another user")
    def test_they_are_made(self):
        with tempfile.TemporaryDirectory() as root:
            os.mkdir(os.path.join(root, "etc"))
            for program, name in (("systemd-sysusers", "sheard.sysusers"), ("systemd-tmpfiles", "sheard.tmpfiles")):
                create = ["--create"] if program == "systemd-tmpfiles" else []
                subprocess.run([program, f"--root={root}", *create, companion(name)], check=True, capture_output=True)
            user = re.search(r"(?m)^sheard:x:(\d+):(\d+):.*:/usr/sbin/nologin$", text_of(os.path.join(root, "etc/passwd")))
            self.assertTrue(user)
            for path, mode in self.MODES.items():
                status = os.stat(os.path.join(root, path))
                self.assertEqual(stat.S_IMODE(status.st_mode), mode, path)
                self.assertEqual((status.st_uid, status.st_gid), (int(user[1]), int(user[2])), path)

    def test_the_spool_is_the_default_one(self):
        self.assertIn(f"d {defaults()['spool.directory']}/incoming ", text_of(companion("sheard.tmpfiles")))


class PackageScripts(unittest.TestCase):
    def test_they_are_shell(self):
        for name in ("preinst", "postinst", "prerm", "postrm"):
            path = companion(os.path.join("deb", name))
            self.assertTrue(os.access(path, os.X_OK), name)
            subprocess.run(["sh", "-n", path], check=True)

    def test_conffiles(self):
        path = re.search(r"--config (\S+)", text_of(SERVICE))[1]
        if path.startswith("/etc/"):  # as packages are built
            self.assertEqual(text_of(companion("deb/conffiles")), path + "\n")


if __name__ == "__main__":
    unittest.main()
