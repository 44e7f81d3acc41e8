# SPDX-License-Identifier: Apache-2.0
"""What the image offers to an attacker: each service's exposure by systemd's own measure, set-user-id files and users against
the checked lists beside this file, and on a running Debug image what listens and how much memory is taken."""
import pathlib
import re
import subprocess

from appliance import Appliance, Disk
from appliance_boot import image_of, wait_for_pictures

HERE = pathlib.Path(__file__).resolve().parent
MOST_EXPOSED = 2.0


def exposure(unit):
    report = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--no-pager", str(unit)], capture_output=True, text=True)
    (line,) = [line for line in report.stdout.splitlines() if "Overall exposure level" in line]
    return float(line.split(":")[1].split()[0])


def compare(name, found, failed):
    wanted = [line for line in (HERE / "expected" / name).read_text().splitlines() if line and not line.startswith("#")]
    for line in sorted(set(found) - set(wanted)):
        failed.append(f"{name}: '{line}' is in the image and not in the checked list")
    for line in sorted(set(wanted) - set(found)):
        failed.append(f"{name}: '{line}' is in the checked list and not in the image")


def run(options, folder):
    figures = {"failed": []}
    for unit in sorted((HERE.parent.parent / "systemd/units").glob("*.service")):
        figures[unit.stem] = exposure(unit)
        if figures[unit.stem] > MOST_EXPOSED:
            figures["failed"].append(f"{unit.stem}: exposed {figures[unit.stem]}, at most {MOST_EXPOSED}")
    shipped = options.out / "cyclorama-museum"
    for name in ("setuid", "users"):
        compare(name, (shipped / name).read_text().splitlines(), figures["failed"])
    if not options.quick and (options.out / "cyclorama-museum-debug").exists():
        machine = Appliance(Disk(folder / "computer", image_of(options, True)))
        try:
            machine.wait_for_shell(900)
            wait_for_pictures(machine)
            _, sockets = machine.run("ss -Htulnp | sed -E 's/users:..\"([^\"]*)\".*/\\1/' | awk '{print $1, $5, $NF}' | sort -u", 60)
            compare("listening", [re.sub(r"%\w+", "", line) for line in sockets.splitlines()], figures["failed"])
            _, used = machine.run("free -m | awk '/^Mem/ {print $3}'")
            figures["memory_used_mb"] = int(used)
            _, noted = machine.run("journalctl -b -p warning -o short-monotonic --no-hostname --no-pager | tail -n 60", 60)
            figures["journal_above_notice"] = len(noted.splitlines())
            print(noted)
        finally:
            machine.power_off()
    return figures
