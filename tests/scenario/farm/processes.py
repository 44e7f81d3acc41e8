# SPDX-License-Identifier: Apache-2.0
"""Processes that a test starts, observes and ends."""
import os
import pathlib
import random
import signal
import socket
import subprocess
import time


def free_port():
    """Returns a port that is free and that the system does not assign by itself."""
    while True:
        port = random.SystemRandom().randrange(20000, 32000)
        with socket.socket(socket.AF_INET6) as probe:
            try:
                probe.bind(("::1", port))
                return port
            except OSError:
                pass


def wait_until(is_so, seconds, what, period=0.02):
    until = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > until:
            raise AssertionError(f"{what}: not within {seconds} s")
        time.sleep(period)


class Process:
    """A program. Its output goes to FOLDER/NAME.log, or to a pipe if the caller reads it."""

    def __init__(self, name, command, folder, piped=False):
        self.name, self.log = name, pathlib.Path(folder) / f"{name}.log"
        with open(self.log, "ab") as log:
            self.popen = subprocess.Popen([str(c) for c in command], stdin=subprocess.DEVNULL, stderr=log,
                                          stdout=subprocess.PIPE if piped else log)

    @property
    def pid(self):
        return self.popen.pid

    def alive(self):
        return self.popen.poll() is None

    def send(self, number):
        if self.alive():
            self.popen.send_signal(number)

    def kill(self):
        self.send(signal.SIGKILL)
        self.popen.wait(20)

    def end(self, seconds=20):
        """Requests that it stops. Returns False if it did not and was killed."""
        self.send(signal.SIGCONT)
        self.send(signal.SIGTERM)
        try:
            self.popen.wait(seconds)
            return True
        except subprocess.TimeoutExpired:
            self.kill()
            return False

    def output(self):
        return self.log.read_text(errors="replace")

    def cpu_seconds(self):
        fields = pathlib.Path(f"/proc/{self.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def usage(self):
        """Returns the quantities that must not grow."""
        status = dict(line.split(":", 1) for line in pathlib.Path(f"/proc/{self.pid}/status").read_text().splitlines())
        return {"rss_kib": int(status["VmRSS"].split()[0]), "threads": int(status["Threads"]),
                "fds": len(os.listdir(f"/proc/{self.pid}/fd"))}
