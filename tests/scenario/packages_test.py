#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the .deb files, unpacked into a bare root: they are complete and consistent; the services report in one
sentence what the operator must fill in; with it they start, notify systemd, and end on request.

Run: packages_test.py SOURCE_ROOT BUILD_FOLDER [COMPONENT ...]
"""
import configparser
import gzip
import os
import pathlib
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

SERVICES = {"farm": ["farm"], "node": ["node"], "museum": ["tour", "tracker", "display", "operator", "projectors", "hand", "calibrator"], "provision": [], "command": [], "tools": []}
# Services that do one thing on demand and end.
HELPERS = {"museum": ["network", "network-try@"], "provision": ["check-settings", "offer", "provision-esp", "provision@", "settings"]}
PROGRAMS = {"farm": ["cyclorama-authority", "cyclorama-farm"], "node": ["cyclorama-node"],
            "command": ["cyclorama"],
            "museum": ["cyclorama-calibrate-camera", "cyclorama-calibrator", "cyclorama-display", "cyclorama-fetch-update", "cyclorama-hand", "cyclorama-health", "cyclorama-network", "cyclorama-operator", "cyclorama-projectors", "cyclorama-renew-certificate", "cyclorama-tour", "cyclorama-tracker"],
            "provision": ["cyclorama-provision"],
            "tools": ["cyclorama-grotto", "cyclorama-render", "cyclorama-simulated-room", "cyclorama-visit", "cyclorama-walkable", "cyclorama-warp"]}
problems = []


def expect(so, what):
    if not so:
        problems.append(what)


def run(*command, **options):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)


class Unit:
    def __init__(self, path):
        parser = configparser.ConfigParser(strict=False, interpolation=None)
        parser.optionxform = str
        parser.read(path)
        self.name, self.service = path.name, parser["Service"]


def unpack(build, component, folder):
    """Makes the package and returns its root; its control files are in DEBIAN."""
    made = run("cpack", "--config", pathlib.Path(build) / "CPackConfig.cmake", "-G", "DEB", "-B", folder, "-D",
               f"CPACK_COMPONENTS_ALL={component}", "-D", "CPACK_DEBIAN_DEBUGINFO_PACKAGE=OFF", cwd=folder)
    debs = list(pathlib.Path(folder).glob(f"cyclorama-{component}_*.deb"))
    assert made.returncode == 0 and len(debs) == 1, f"cpack {component}: {made.stdout}\n{made.stderr}"
    root = pathlib.Path(folder) / f"root-{component}"
    assert run("dpkg-deb", "--raw-extract", debs[0], root).returncode == 0
    return root


def name_line(page):
    """Returns the line of a man page that `man -k` and `whatis` show."""
    lines = gzip.decompress(page.read_bytes()).decode().splitlines()
    return lines[lines.index(".SH NAME") + 1]


def check_files(component, root):
    for program in PROGRAMS[component]:
        file = root / "usr/bin" / program
        expect(os.access(file, os.X_OK), f"{component}: no program {program}")
        page = root / f"usr/share/man/man1/{program}.1.gz"
        about = name_line(page) if page.exists() else ""
        expect(about.startswith(f"{program} ") and len(about) > 30 and "manual page" not in about,
               f"{component}: the man page of {program} calls itself '{about}'")
    names = {path.name for path in (root / "usr/bin").iterdir()}
    expect(names == set(PROGRAMS[component]), f"{component}: usr/bin has {sorted(names)}")
    for file in ("copyright", "changelog.gz"):
        expect((root / f"usr/share/doc/cyclorama-{component}" / file).exists(), f"{component}: no {file}")
    foreign = [str(p.relative_to(root)) for p in root.rglob("*") if p.is_file() and
               not re.match(r"(DEBIAN|usr/bin|usr/lib/(systemd|sysusers\.d|udev/rules\.d)|usr/share/(man|doc)|etc/(cyclorama|logrotate\.d))/", str(p.relative_to(root)))]
    expect(not foreign, f"{component}: unexpected files {foreign}")
    control = (root / "DEBIAN/control").read_text()
    described = re.search(r"^Description: (\S.*(?:\n .*)+)", control, re.M)
    expect(described and not re.search(r"\n  ", described[1]), f"{component}: its description is not plain text:\n{control}")
    expect(re.search(r"^Depends: .*libc6", control, re.M), f"{component}: it does not depend on its libraries:\n{control}")
    settings = sorted("/" + str(p.relative_to(root)) for p in root.glob("etc/*/*"))
    conffiles = root / "DEBIAN/conffiles"
    listed = conffiles.read_text().split() if conffiles.exists() else []
    expect(listed == settings, f"{component}: conffiles {listed}, but etc has {settings}")
    for script in ("postinst", "prerm", "postrm"):
        file = root / "DEBIAN" / script
        expect(file.exists() == bool(SERVICES[component] or HELPERS.get(component)), f"{component}: {script}")
        if file.exists():
            expect(os.access(file, os.X_OK) and run("sh", "-n", file).returncode == 0, f"{component}: {script} does not run")
            expect("@" not in file.read_text(), f"{component}: {script} is not filled in")


def check_units(component, root):
    units = [Unit(path) for path in sorted(root.glob("usr/lib/systemd/system/*.service"))]
    for unit in units:
        sandbox = root / f"usr/lib/systemd/system/{unit.name}.d/10-hardening.conf"
        expect(sandbox.exists() and "NoNewPrivileges=yes" in sandbox.read_text(), f"{unit.name}: has no sandbox")
    helpers = {f"cyclorama-{h}.service" for h in HELPERS.get(component, [])}
    expect({u.name for u in units} == {f"cyclorama-{s}.service" for s in SERVICES[component]} | helpers, f"{component}: units")
    for unit in (u for u in units if u.name in helpers):
        program = unit.service["ExecStart"].split()[0]
        expect(unit.service["Type"] == "oneshot", f"{unit.name}: is not of Type=oneshot")
        expect("cyclorama" not in program or (root / program.lstrip("/")).exists(), f"{unit.name}: {program} is not in the package")
    units = [unit for unit in units if unit.name not in helpers]
    presets = "".join(p.read_text() for p in root.glob("usr/lib/systemd/system-preset/*"))
    (root / "etc").mkdir(exist_ok=True)
    made = run("systemd-sysusers", f"--root={root}")
    passwd = root / "etc/passwd"
    users = {line.split(":")[0] for line in passwd.read_text().splitlines()} if passwd.exists() else set()
    expect(made.returncode == 0, f"{component}: {made.stderr}")
    for unit in units:
        command = unit.service["ExecStart"].split()
        expect((root / command[0].lstrip("/")).exists(), f"{unit.name}: {command[0]} is not in the package")
        expect(unit.service["User"] in users, f"{unit.name}: nothing makes the user {unit.service['User']}")
        expect(f"disable {unit.name}" in presets, f"{unit.name}: starts before it is set up")
        if unit.name == "cyclorama-display.service":
            shown = " ".join(command)
            expect("--output drm" in shown and "char-drm" in unit.service["DeviceAllow"], f"{unit.name}: lights no projector: {shown}")
        expect(unit.service["Type"] == "notify" and "WatchdogSec" in unit.service, f"{unit.name}: no watchdog")


def fill_in(file, changes):
    """Fills in settings as an operator would: uncomments the lines that begin so and writes other values."""
    text = file.read_text()
    for wanted, value in changes.items():
        text, count = re.subn(rf"^#?{re.escape(wanted)}.*$", value, text, flags=re.M)
        expect(count == 1, f"{file.name}: {count} lines begin with {wanted}")
    filled = file.with_name("filled.toml")
    filled.write_text(text)
    return filled


def check_service(component, root, missing, changes):
    program, settings = root / f"usr/bin/cyclorama-{component}", root / f"etc/cyclorama/{component}.toml"
    bare = run(program, "--config", settings, timeout=20)
    expect(bare.returncode == 1 and missing in bare.stderr and bare.stderr.count("\n") == 1,
           f"{component}: without settings it ends with {bare.returncode}: {bare.stderr}")
    with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as notified:
        notified.bind(f"{folder}/notify")
        notified.settimeout(20)
        process = subprocess.Popen([program, "--config", fill_in(settings, changes)], stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "NOTIFY_SOCKET": f"{folder}/notify", "WATCHDOG_USEC": "2000000"})
        seen = ""
        try:
            until = time.monotonic() + 20
            while not all(word in seen for word in ("READY=1", "WATCHDOG=1")) and time.monotonic() < until:
                seen += notified.recv(4096).decode() + "\n"
            process.send_signal(signal.SIGTERM)
            process.wait(20)
            notified.setblocking(False)
            while "STOPPING=1" not in seen:
                seen += notified.recv(4096).decode() + "\n"
        except (OSError, subprocess.TimeoutExpired) as error:
            problems.append(f"{component}: {error!r}; it notified systemd of:\n{seen}")
        finally:
            process.kill()
            errors = process.communicate()[1]
        expect(process.returncode == 0, f"{component}: ends with {process.returncode}: {errors}")


def main(root, build, *components):
    port = random.randrange(10000, 19000)
    with tempfile.TemporaryDirectory() as folder:
        for component in components or SERVICES:
            try:
                unpacked = unpack(build, component, folder)
                check_files(component, unpacked)
                check_units(component, unpacked)
                if component == "farm":
                    check_service("farm", unpacked, "[[scene]]", {
                        'museums = "': f'museums = "[::1]:{port}"', 'nodes = "': f'nodes = "[::1]:{port + 1}"',
                        'inspect = "': f'inspect = "unix:{folder}/inspect.sock"',  # systemd makes /run/cyclorama-farm.
                        "[[scene]]": "[[scene]]", "name = ": 'name = "a"', "path = ": 'path = "/srv/a"'})
                if component == "node":
                    check_service("node", unpacked, "no coordinator is given", {"coordinators = ": f'coordinators = ["[::1]:{port + 1}"]'})
            except AssertionError as error:
                problems.append(str(error))
    print("\n".join(problems) or "packages: ok")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
