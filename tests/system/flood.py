# SPDX-License-Identifier: GPL-3.0-or-later
"""Clients that ask for more than anybody can answer, in processes of their own, and what another
client notices of it. For the test of floods, and for bench/floods, which prints the figures."""
import contextlib
import json
import os
import resource
import select
import signal
import socket
import threading
import time


def line(method, **params):
    return (json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": params}) + "\n").encode()


def room_for_descriptors():
    """As many as the system allows."""
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    return most


def connect(path):
    client = socket.socket(socket.AF_UNIX)
    try:
        client.connect(path)
    except OSError:
        client.close()
        raise
    client.setblocking(False)
    return client


class Pump:
    """Connections that send as much as is accepted, and read all replies, or none."""

    def __init__(self, path, data, reads=True, repeat=True):
        self.path, self.data, self.reads, self.repeat = path, data, reads, repeat
        self.poll, self.clients = select.epoll(), {}

    def add(self):
        client = connect(self.path)
        self.clients[client.fileno()] = [client, self.data]
        self.poll.register(client, select.EPOLLOUT | (select.EPOLLIN if self.reads else 0))

    def drop(self, fd):
        self.poll.unregister(fd)
        self.clients.pop(fd)[0].close()

    def send(self, fd):
        client, rest = self.clients[fd]
        rest = rest[client.send(rest):]
        if not rest and not self.repeat:
            self.poll.modify(fd, select.EPOLLIN if self.reads else select.EPOLLHUP)
        self.clients[fd][1] = rest or self.data

    def turn(self):
        for fd, event in self.poll.poll(0.1):
            try:
                if event & select.EPOLLIN and not self.clients[fd][0].recv(1 << 18):
                    self.drop(fd)
                elif event & (select.EPOLLHUP | select.EPOLLERR):
                    self.drop(fd)
                elif event & select.EPOLLOUT:
                    self.send(fd)
            except BlockingIOError:
                pass
            except OSError:
                self.drop(fd)


def pump(path, n, data, reads=True, repeat=True):
    """n connections; lost ones are opened again."""
    many = Pump(path, data, reads, repeat)
    while True:
        with contextlib.suppress(OSError):
            for _ in range(min(50, n - len(many.clients))):
                many.add()
        many.turn()


def knock(path):
    """Hold all the connections that are accepted, and try to get more."""
    held = []
    while True:
        try:
            held.append(connect(path))
        except OSError:
            time.sleep(0.001)
        if len(held) > 2000:
            held.pop(0).close()


@contextlib.contextmanager
def flooding(function, *arguments, uid=None, processes=1):
    """Run the function in other processes (as another user) meanwhile."""
    pids = []
    for _ in range(processes):
        pid = os.fork()
        if pid == 0:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            with contextlib.suppress(BaseException):
                if uid is not None:
                    os.setgroups([])
                    os.setgid(uid)
                    os.setuid(uid)
                function(*arguments)
            os._exit(0)
        pids.append(pid)
    try:
        yield
    finally:
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)


def memory_of(pid):
    """VmRSS in MB."""
    with open(f"/proc/{pid}/status", encoding="ascii") as f:
        return next(int(text.split()[1]) for text in f if text.startswith("VmRSS")) / 1024


class Watchdog:
    """Receive the notifications to systemd; return the longest time between two signs of life."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(path)
        self.socket.settimeout(0.2)
        self.times, self.going = [], True
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        while self.going:
            with contextlib.suppress(TimeoutError):
                if b"WATCHDOG=1" in self.socket.recv(4096):
                    self.times.append(time.monotonic())

    def longest(self, begin, end):
        times = [begin, *(t for t in self.times if begin <= t <= end), end]
        return max(b - a for a, b in zip(times, times[1:]))

    def close(self):
        self.going = False
        self.thread.join()
        self.socket.close()


def watch(client, pid, seconds, pause=0.02):
    """What a client that says hello now and then sees: seconds of each answer, and the most memory."""
    times, most, end = [], 0, time.monotonic() + seconds
    while time.monotonic() < end:
        begin = time.monotonic()
        client.call("hello")
        times.append(time.monotonic() - begin)
        most = max(most, memory_of(pid))
        time.sleep(pause)
    return sorted(times), most


def quantile(times, part):
    return times[min(len(times) - 1, int(part * len(times)))]
