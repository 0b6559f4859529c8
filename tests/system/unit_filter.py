# SPDX-License-Identifier: GPL-3.0-or-later
"""What a systemd unit does to the system calls of its service, without a systemd that runs.

`python3 unit_filter.py UNIT USER PROGRAM ARGUMENT...` runs a program as it would be under the unit: as that user (a number;
'-' for whoever asks), without new privileges, and behind the same filters, one for each directive, as systemd 252 builds
them (src/shared/seccomp-util.c). The sets of calls are asked of systemd-analyze. Directives that are not in the unit do
nothing, so that a unit with one line less shows what that line is for."""
import ctypes
import errno
import functools
import os
import re
import stat
import subprocess
import sys

ALLOW, ERRNO = 0x7fff0000, 0x00050000  # SCMP_ACT_
NE, LT, EQ, GT, MASKED = 1, 2, 4, 6, 7  # SCMP_CMP_
UNKNOWN = -1  # __NR_SCMP_ERROR
PROT_WRITE, PROT_EXEC, SHM_EXEC = 2, 4, 0o100000
AF_UNIX = 1
NAMESPACES = (0x80, 0x00020000, 0x02000000, 0x04000000, 0x08000000, 0x10000000, 0x20000000, 0x40000000)  # CLONE_NEW*


class Comparison(ctypes.Structure):
    _fields_ = [("argument", ctypes.c_uint), ("op", ctypes.c_int), ("a", ctypes.c_uint64), ("b", ctypes.c_uint64)]


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def entries(text):
    """{key: [values in order]} of a unit file; sections do not matter, no key of ours is in two."""
    found = {}
    for line in text.splitlines():
        match = re.fullmatch(r"(\w+)=(.*)", line)
        if match:
            found.setdefault(match[1], []).append(match[2])
    return found


@functools.lru_cache(maxsize=None)
def members(name):
    """The calls of a set such as "@system-service"; of a call's name, itself."""
    if not name.startswith("@"):
        return frozenset({name})
    text = subprocess.run(["systemd-analyze", "syscall-filter", "--no-pager", name], capture_output=True, text=True,
                          check=True).stdout
    calls = [line.strip() for line in text.splitlines()[1:] if line.strip() and "#" not in line]
    return frozenset().union(*(members(call) for call in calls))


def allowed(text):
    """As systemd reads it: the first line makes it a list of what is allowed, '~' takes away, @default is always in."""
    calls = set(members("@default"))
    for value in entries(text)["SystemCallFilter"]:
        named = frozenset().union(*(members(name) for name in value.lstrip("~").split()))
        calls = calls - named if value.startswith("~") else calls | named
    return calls


# A filter is (what happens to the rest, [(what happens, call, comparisons of its arguments)]).

def denied(rules, error=errno.EPERM):
    return ALLOW, [(ERRNO | error, call, comparisons) for call, comparisons in rules]


def system_calls(text):
    calls = allowed(text)
    error = getattr(errno, entries(text).get("SystemCallErrorNumber", ["EPERM"])[-1])
    return ERRNO | errno.ENOSYS, ([(ALLOW, call, ()) for call in calls] +
                                  [(ERRNO | error, call, ()) for call in members("@known") - calls])


def no_suid_sgid():
    rules = []
    for mode in (stat.S_ISUID, stat.S_ISGID):
        rules += [(call, [(at, MASKED, mode, mode)]) for call, at in
                  (("chmod", 1), ("fchmod", 1), ("fchmodat", 2), ("mkdir", 1), ("mkdirat", 2), ("mknod", 1), ("mknodat", 2),
                   ("creat", 1))]
        rules += [(call, [(at, MASKED, os.O_CREAT, os.O_CREAT), (at + 1, MASKED, mode, mode)])
                  for call, at in (("open", 1), ("openat", 2))]
    rest, filters = denied(rules)
    return rest, filters + denied([("openat2", ())], errno.ENOSYS)[1]


def no_namespaces():
    rules = [("setns", [(1, EQ, 0, 0)])]
    for flag in NAMESPACES:
        rules += [(call, [(at, MASKED, flag, flag)]) for call, at in (("unshare", 0), ("clone", 0), ("setns", 1))]
    rest, filters = denied(rules)
    return rest, filters + denied([("clone3", ())], errno.ENOSYS)[1]


def no_writable_code():
    both = PROT_WRITE | PROT_EXEC
    return denied([("mmap", [(2, MASKED, both, both)]), ("mprotect", [(2, MASKED, PROT_EXEC, PROT_EXEC)]),
                   ("pkey_mprotect", [(2, MASKED, PROT_EXEC, PROT_EXEC)]), ("shmat", [(2, MASKED, SHM_EXEC, SHM_EXEC)])])


def no_realtime():
    usual = (0, 3, 5)  # SCHED_OTHER, BATCH, IDLE
    return denied([("sched_setscheduler", [(1, EQ, policy, 0)]) for policy in range(5) if policy not in usual] +
                  [("sched_setscheduler", [(1, GT, max(usual), 0)])])


def only_unix_sockets():
    return denied([("socket", [(0, LT, AF_UNIX, 0)]), ("socket", [(0, GT, AF_UNIX, 0)])], errno.EAFNOSUPPORT)


DIRECTIVES = {("RestrictSUIDSGID", "yes"): no_suid_sgid, ("RestrictNamespaces", "yes"): no_namespaces,
              ("MemoryDenyWriteExecute", "yes"): no_writable_code, ("RestrictRealtime", "yes"): no_realtime,
              ("RestrictAddressFamilies", "AF_UNIX"): only_unix_sockets,
              ("LockPersonality", "yes"): lambda: denied([("personality", [(0, NE, 0, 0)])]),
              ("ProtectClock", "yes"): lambda: denied([(call, ()) for call in members("@clock")]),
              ("ProtectKernelModules", "yes"): lambda: denied([(call, ()) for call in members("@module")]),
              ("ProtectKernelLogs", "yes"): lambda: denied([("syslog", ())]),
              ("ProtectHostname", "yes"): lambda: denied([("sethostname", ()), ("setdomainname", ())]),
              ("PrivateDevices", "yes"): lambda: denied([(call, ()) for call in members("@raw-io")])}


def filters(text):
    """All filters of the unit, the widest last: those before it must still be loaded through it."""
    values = entries(text)
    chosen = [make() for (key, value), make in DIRECTIVES.items() if values.get(key, [""])[-1] == value]
    return chosen + ([system_calls(text)] if "SystemCallFilter" in values else [])


def load(library, rest, rules):
    context = library.seccomp_init(ctypes.c_uint32(rest))
    for action, call, comparisons in rules:
        number = library.seccomp_syscall_resolve_name(call.encode())
        if number == UNKNOWN or action == rest:
            continue
        array = (Comparison * len(comparisons))(*(Comparison(*c) for c in comparisons))
        code = library.seccomp_rule_add_array(ctypes.c_void_p(context), ctypes.c_uint32(action), number, len(array), array)
        if code != 0:
            raise OSError(-code, f"no rule for {call}")
    code = library.seccomp_load(ctypes.c_void_p(context))
    if code != 0:
        raise OSError(-code, "the filter cannot be loaded")


def main(unit, user, program, *arguments):
    library = ctypes.CDLL("libseccomp.so.2")
    library.seccomp_init.restype = ctypes.c_void_p
    made = filters(text_of(unit))
    if user != "-":
        os.setgroups([])
        os.setgid(int(user))
        os.setuid(int(user))
    os.umask(int(entries(text_of(unit)).get("UMask", ["0022"])[-1], 8))
    for rest, rules in made:
        load(library, rest, rules)
    os.execv(program, [program, *arguments])


if __name__ == "__main__":
    main(*sys.argv[1:])
