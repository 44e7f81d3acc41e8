# SPDX-License-Identifier: Apache-2.0
"""Separate hosts on this machine: network namespaces on one switch, over IPv6. They need root and `ip`."""
import os
import random
import shutil
import subprocess


def why_not():
    """Returns why hosts are impossible here, or an empty text."""
    if os.geteuid() != 0:
        return "network namespaces need root"
    if shutil.which("ip") is None or shutil.which("ss") is None:
        return "the commands ip and ss (package iproute2) are not installed"
    probe = f"cyc-probe-{os.getpid()}"
    made = subprocess.run(["ip", "netns", "add", probe], capture_output=True, text=True)
    if made.returncode != 0:
        return "this machine allows no network namespaces: " + made.stderr.strip()
    subprocess.run(["ip", "netns", "del", probe], check=True)
    return ""


def ip(*words):
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


class Hosts:
    """A context manager. The switch is a bridge in a namespace of its own, so this machine's network does not
    change."""

    def __init__(self, names):
        self.mark = f"cyc{os.getpid()}-{random.randrange(1000)}"
        self.names = {name: number for number, name in enumerate(names, 1)}

    def __enter__(self):
        switch = self.space("switch")
        ip("netns", "add", switch)
        ip("-n", switch, "link", "add", "bridge", "type", "bridge")
        ip("-n", switch, "link", "set", "bridge", "up")
        for name, number in self.names.items():
            space, port = self.space(name), f"port{number}"
            ip("netns", "add", space)
            ip("link", "add", "eth0", "netns", space, "type", "veth", "peer", "name", port, "netns", switch)
            ip("-n", switch, "link", "set", port, "master", "bridge", "up")
            ip("-n", space, "link", "set", "lo", "up")
            ip("-n", space, "addr", "add", f"{self.address(name)}/64", "dev", "eth0", "nodad")
            ip("-n", space, "link", "set", "eth0", "up")
        return self

    def __exit__(self, *_):
        for name in [*self.names, "switch"]:
            subprocess.run(["ip", "netns", "del", self.space(name)], capture_output=True)

    def space(self, name):
        return f"{self.mark}-{name}"

    def address(self, name):
        return f"fd00:c7c::{self.names[name]:x}"

    def on(self, name):
        """Returns the prefix of a command that runs on that host."""
        return ["ip", "netns", "exec", self.space(name)]

    def unplug(self, name):
        """Pulls the cable at the switch: the host sees a link that is up, without traffic."""
        ip("-n", self.space("switch"), "link", "set", f"port{self.names[name]}", "nomaster")

    def plug_in(self, name):
        ip("-n", self.space("switch"), "link", "set", f"port{self.names[name]}", "master", "bridge")

    def listeners(self, name):
        """Returns the TCP and UDP ports that are open on that host."""
        out = subprocess.run([*self.on(name), "ss", "-Hlntu"], check=True, capture_output=True, text=True).stdout
        return sorted({int(line.split()[4].rsplit(":", 1)[1]) for line in out.splitlines()})
