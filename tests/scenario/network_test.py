#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests a museum's network settings with the real systemd-networkd, wpa_supplicant and hostapd in network namespaces:
addresses by DHCP and SLAAC, fixed ones, IPv6 alone; settings that cut the page off are taken back, also after a crash and
a restart; a login at the switch.

Run: network_test.py SOURCE_ROOT BUILD_FOLDER. It is skipped (77) where network namespaces or systemd-networkd are
impossible.
"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from farm.hosts import Hosts, ip, why_not
from farm.processes import wait_until

NETWORKD = pathlib.Path("/lib/systemd/systemd-networkd")
PORT = 8443
TRIAL_S = 8
ROUTER = """[Match]
Name=eth0
[Network]
Address=10.77.0.1/24
Address=fd77::1/64
DHCPServer=yes
IPv6SendRA=yes
IPv6AcceptRA=no
[DHCPServer]
PoolOffset=100
PoolSize=50
EmitDNS=no
[IPv6Prefix]
Prefix=fd77::/64
"""
# networkd sees neither this machine's /run nor its udev: with /sys read-only it does not wait for the latter.
START = """mount -o remount,ro /sys
mount -t tmpfs tmpfs /run/systemd
mkdir -p /run/systemd/network
mount --bind "$1" /run/systemd/network
exec /lib/systemd/systemd-networkd"""


class Networkd:
    """One host's systemd-networkd, whose files lie in RUN/systemd/network."""

    def __init__(self, host, run):
        self.host, self.files = host, run / "systemd/network"
        self.files.mkdir(parents=True, exist_ok=True)
        self.log = open(run.parent / f"{run.name}.networkd.log", "a", encoding="utf-8")
        self.process = None
        self.start()

    def start(self):
        self.process = subprocess.Popen([*self.host, "unshare", "-m", "bash", "-c", START, "bash", self.files],
                                        stdout=self.log, stderr=self.log)

    def stop(self):
        self.process.terminate()
        self.process.wait(30)

    def restart(self):
        """Stands for `networkctl reload`, which needs a bus: the addresses that it made go, and others come."""
        self.stop()
        subprocess.run([*self.host, "ip", "addr", "flush", "dev", "eth0", "scope", "global"], check=True)
        self.start()


class Museum:
    """The museum's computer: settings in use, an offer, a page, and what systemd would do for cyclorama-network."""

    def __init__(self, source, build, folder, hosts):
        self.host, self.router = hosts.on("museum"), hosts.on("router")
        self.folder, self.run = folder, folder / "run"
        self.settings, self.offer, self.keep = folder / "settings", folder / "offer", folder / "keep"
        for path in (self.settings, self.offer, self.run / "systemd/network"):
            path.mkdir(parents=True)
        self.usual = source / "image/mkosi.extra/usr/lib/systemd/network/80-cable.network"
        (self.settings / "site.toml").write_text('[farm]\nmuseum = "Hall 3"\n')
        shutil.copy(self.usual, self.run / "systemd/network")
        tools = folder / "tools"
        tools.mkdir()
        self.reload = tools / "reload"
        self.asked = folder / "asked"
        # The test restarts networkd when it is asked to, and answers.
        self.reload.write_text(f'#!/bin/sh\necho "$@" >{self.asked}\nwhile [ -e {self.asked} ]; do sleep .05; done\n')
        # Stands for the unit that checks the offer as a whole.
        (tools / "systemctl").write_text(f"#!/bin/sh\ncp {self.offer}/site.toml {self.settings}/site.toml\n")
        for tool in tools.iterdir():
            tool.chmod(0o755)
        self.environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"}
        self.command = [build / "bin/cyclorama-network", "--run", self.run, "--settings", self.settings, "--reload",
                        self.reload]
        self.networkd = Networkd(self.host, self.run)
        self.page = subprocess.Popen([*self.host, sys.executable, "-m", "http.server", "--bind", "::", str(PORT)],
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder)

    def serve_reload(self):
        if self.asked.exists():
            self.networkd.restart()
            self.asked.unlink()

    def finish(self, process):
        """Waits for a command, and restarts networkd as it asks."""
        while process.poll() is None:
            self.serve_reload()
            time.sleep(0.05)
        return process.returncode

    def apply(self):
        assert self.finish(subprocess.Popen([*self.command, "apply"], env=self.environment)) == 0

    def begin_trial(self, network):
        (self.offer / "site.toml").write_text('[farm]\nmuseum = "Hall 3"\n' + network)
        (self.run / "cyclorama-network/trial.json").unlink(missing_ok=True)
        self.keep.unlink(missing_ok=True)
        trial = subprocess.Popen([*self.command, "try", "c0de", "--offer", self.offer, "--keep", self.keep, "--seconds",
                                  str(TRIAL_S)], env=self.environment, stderr=subprocess.PIPE, text=True)
        while self.report()["state"] != "trying":
            assert trial.poll() is None, trial.stderr.read()
            self.serve_reload()
            time.sleep(0.05)
        return trial

    def report(self):
        file = self.run / "cyclorama-network/trial.json"
        return json.loads(file.read_text()) if file.exists() else {"state": "none"}

    def addresses(self):
        out = subprocess.run([*self.host, "ip", "-json", "addr", "show", "dev", "eth0", "scope", "global"], check=True,
                             capture_output=True, text=True).stdout
        return [a["local"] for link in json.loads(out) for a in link.get("addr_info", [])
                if "local" in a and not a.get("tentative")]

    def is_reached(self, address):
        """Whether somebody on the museum's network reaches the page there."""
        return subprocess.run([*self.router, "timeout", "2", "bash", "-c", f"</dev/tcp/{address}/{PORT}"],
                              capture_output=True).returncode == 0

    def wait_for(self, start, what):
        """Waits for an address that begins so, at which the page is reached; returns it."""
        found = []

        def is_there():
            found[:] = [a for a in self.addresses() if a.startswith(start)]
            return found and self.is_reached(found[0])
        wait_until(is_there, 40, what)
        return found[0]

    def end(self):
        self.page.terminate()
        self.networkd.stop()


def check_automatic(museum):
    museum.apply()
    four = museum.wait_for("10.77.0.1", "an address by DHCP")
    six = museum.wait_for("fd77:", "an address by SLAAC")
    print(f"from the network: {four} and {six}")
    return four


def check_taken_back(museum, before):
    """Settings that cut off the page: nobody can confirm them, so they go by themselves."""
    trial = museum.begin_trial('[network]\ninterface = "eth0"\nipv4 = "static"\nipv4_address = "192.0.2.7/24"\n'
                               'ipv6 = "off"\ndns = ["192.0.2.1"]\n')
    wait_until(lambda: "192.0.2.7" in museum.addresses(), 20, "the offered address")
    assert not museum.is_reached(before), "the page is still reached, so nothing was cut off"
    assert museum.finish(trial) == 0
    assert museum.report()["state"] == "taken-back" and "nobody confirmed" in museum.report()["sentence"], museum.report()
    museum.wait_for("10.77.0.1", "the address of before")
    assert "network" not in (museum.settings / "site.toml").read_text(), "refused settings are in use"
    print(f"taken back after {TRIAL_S} s: the page is reached as before")


def check_kept(museum):
    trial = museum.begin_trial('[network]\ninterface = "eth0"\nipv4 = "static"\nipv4_address = "10.77.0.200/24"\n'
                               'ipv4_gateway = "10.77.0.1"\ndns = ["10.77.0.1"]\ntime_servers = ["10.77.0.1"]\n')
    museum.wait_for("10.77.0.200", "the fixed address")
    museum.keep.write_text("c0de\n")
    assert museum.finish(trial) == 0
    assert museum.report()["state"] == "kept", museum.report()
    museum.wait_for("10.77.0.200", "the fixed address, kept")
    routes = subprocess.run([*museum.host, "ip", "route"], capture_output=True, text=True).stdout
    assert "default via 10.77.0.1" in routes, routes
    print("kept: 10.77.0.200, with its router")


def check_crash(museum):
    """A trial that is killed leaves its files in /run; a restart begins with an empty /run and the settings in use."""
    trial = museum.begin_trial('[network]\ninterface = "eth0"\nipv4 = "off"\nipv6 = "static"\n'
                               'ipv6_address = "2001:db8::7/64"\ndns = ["2001:db8::1"]\n')
    wait_until(lambda: "2001:db8::7" in museum.addresses(), 20, "the offered address")
    trial.send_signal(signal.SIGKILL)
    trial.wait(10)
    museum.networkd.stop()
    for name in ("cyclorama-network", "systemd/network"):
        for file in (museum.run / name).iterdir():
            file.unlink()
    shutil.copy(museum.usual, museum.run / "systemd/network")
    restart = subprocess.Popen([*museum.command[:-1], "true", "apply"], env=museum.environment)
    assert restart.wait(30) == 0
    museum.networkd.start()
    museum.wait_for("10.77.0.200", "the kept address after a crash and a restart")
    print("after a crash and a restart: 10.77.0.200 as kept before")


def check_only_six(museum):
    (museum.settings / "site.toml").write_text('[network]\ninterface = "eth0"\nipv4 = "off"\n')
    museum.apply()
    six = museum.wait_for("fd77:", "IPv6 alone")
    wait_until(lambda: all(":" in a for a in museum.addresses()), 20, "no IPv4 address")
    print(f"IPv6 alone: {six}")


def check_login(museum, hosts):
    """802.1X with a password: the switch, played by hostapd, lets in who knows it, and nobody else."""
    if not shutil.which("hostapd") or not shutil.which("wpa_supplicant"):
        print("login at the switch: not tested, hostapd or wpasupplicant is not installed")
        return
    folder, space = museum.folder, hosts.space
    ip("link", "add", "eth1", "netns", space("museum"), "type", "veth", "peer", "name", "eth1", "netns", space("router"))
    for name in ("museum", "router"):
        ip("-n", space(name), "link", "set", "eth1", "up")
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days",
                    "30", "-subj", "/CN=radius.museum.example", "-addext", "subjectAltName=DNS:radius.museum.example",
                    "-keyout", folder / "radius.key", "-out", folder / "radius.pem"], check=True, capture_output=True)
    (folder / "users").write_text('"kiosk" PEAP\n"kiosk" MSCHAPV2 "cave 158" [2]\n')
    (folder / "hostapd.conf").write_text(
        f"interface=eth1\ndriver=wired\nieee8021x=1\neap_server=1\neap_user_file={folder}/users\n"
        f"ca_cert={folder}/radius.pem\nserver_cert={folder}/radius.pem\nprivate_key={folder}/radius.key\n")
    log = open(folder / "hostapd.log", "w", encoding="utf-8")
    switch = subprocess.Popen([*museum.router, "hostapd", folder / "hostapd.conf"], stdout=log, stderr=log)
    try:
        for password, word in (("cave 158", "CTRL-EVENT-EAP-SUCCESS"), ("cave 159", "CTRL-EVENT-EAP-FAILURE")):
            shutil.copy(folder / "radius.pem", museum.settings / "8021x-authority.crt")
            (museum.settings / "8021x-password").write_text(password + "\n")
            (museum.settings / "site.toml").write_text(
                '[network]\ninterface = "eth1"\n[network.login]\nmethod = "peap"\nidentity = "kiosk"\npassword_file = '
                '"8021x-password"\nauthority = "8021x-authority.crt"\nserver_name = "radius.museum.example"\n')
            museum.apply()
            told = folder / "supplicant.log"
            with open(told, "w", encoding="utf-8") as out:
                supplicant = subprocess.Popen([*museum.host, "wpa_supplicant", "-D", "wired", "-i", "eth1", "-c",
                                               museum.run / "cyclorama-8021x/login.conf"], stdout=out, stderr=out)
                try:
                    wait_until(lambda: word in told.read_text(), 40, f"{word} with the password {password!r}")
                finally:
                    supplicant.terminate()
                    supplicant.wait(30)
        print("login at the switch: in with the password, refused with another")
    finally:
        switch.terminate()
        switch.wait(30)


def main(source, build):
    reason = why_not() or ("" if NETWORKD.exists() else "systemd-networkd is not installed")
    if reason:
        print(f"network: skipped: {reason}")
        return 1 if os.environ.get("CYCLORAMA_REQUIRE_NETNS") == "1" else 77
    with tempfile.TemporaryDirectory() as name, Hosts(["museum", "router"]) as hosts:
        folder = pathlib.Path(name)
        files = folder / "router-run/systemd/network"
        files.mkdir(parents=True)
        (files / "10-router.network").write_text(ROUTER)
        router = Networkd(hosts.on("router"), folder / "router-run")
        (folder / "museum").mkdir()
        museum = Museum(pathlib.Path(source), pathlib.Path(build), folder / "museum", hosts)
        try:
            before = check_automatic(museum)
            check_taken_back(museum, before)
            check_kept(museum)
            check_crash(museum)
            check_only_six(museum)
            check_login(museum, hosts)
        except AssertionError:
            for log in sorted(folder.glob("**/*.log")):
                print(f"{log.name}:\n{log.read_text(errors='replace')[-1500:]}")
            raise
        finally:
            museum.end()
            router.stop()
    print("network: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
