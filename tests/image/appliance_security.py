# SPDX-License-Identifier: Apache-2.0
"""Checks the image's attack surface: systemd's rating of each service; set-user-id files, users, running programs with
their capabilities and open ports against the checked lists in expected/; a scan of the computer's ports from the
network."""
import pathlib
import re
import socket
import sys
import time

from appliance import Appliance
from appliance_boot import attract_pictures, computer, wait_for_pictures

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE.parent / "tools"))
from installed_units import exposure, install_units  # noqa: E402

MAX_EXPOSURE = 2.0
# Services that divide disks, mount for others, or write partitions; they end as soon as they have done so.
ROOTS = {"cyclorama-var": 4.6, "cyclorama-update@": 2.9, "cyclorama-update-from-farm@": 3.1}
PROFILES = ("museum", "farm-host")
TABLE = ROOT / "docs/design/image.md"
OPERATOR_PORT = 8443
SCANNED = [*range(1, 1025), 2049, 3306, 3389, 4352, 5355, 5432, 5900, 6000, *range(7380, 7430), 8000, 8080,
           OPERATOR_PORT, 9090, 19531, 50051]
FIRST_SCAN_PORT = 20000
ANSWERS_WITHIN_S = 6
# Connection states of ports that answered, within seconds.
ANSWERED = {f"TCP[{state}]" for state in ("ESTABLISHED", "CLOSE_WAIT", "FIN_WAIT_1", "FIN_WAIT_2", "CLOSING",
                                          "LAST_ACK", "TIME_WAIT")}
# Lists user, program and capabilities of all processes but the debug shell's and the kernel's threads.
PROCESSES = """for p in /proc/[0-9]*; do
  if grep -q cyclorama-debug-shell $p/cgroup || ! readlink -e $p/exe >/dev/null; then continue; fi
  caps=$(capsh --decode=$(sed -n 's/^CapEff:.//p' $p/status))
  echo "$(stat -c %U $p) $(cat $p/comm) ${caps#*=}"
done 2>/dev/null | sort -u"""


def compare(name, found, failed):
    """Compares with a checked list; a render host has its own ones, such as 'farm-host/users'."""
    wanted = [line for line in (HERE / "expected" / name).read_text().splitlines() if line and not line.startswith("#")]
    for line in sorted(set(found) - set(wanted)):
        failed.append(f"{name}: '{line}' is in the image and not in the checked list")
    for line in sorted(set(wanted) - set(found)):
        failed.append(f"{name}: '{line}' is in the checked list and not in the image")


def compare_journal(lines, failed):
    """Returns the number of lines that no pattern in expected/journal allows."""
    known = [re.compile(line) for line in (HERE / "expected/journal").read_text().splitlines() if line
             and not line.startswith("#")]
    strange = [line for line in lines if not any(pattern.fullmatch(re.sub(r"^\[ *[\d.]+\] ", "", line))
                                                 for pattern in known)]
    failed.extend(f"journal above notice: {line}" for line in strange)
    return len(strange)


def scan(machine):
    """Returns the ports of SCANNED that answer. QEMU's network stands for a neighbour's computer; it knows each
    connection's state."""
    calls, answering = [], set()
    # A loopback address of the tests' machine that differs for each scanned computer.
    here = f"127.{machine.process.pid // 250 % 250 + 1}.{machine.process.pid % 250}.77"
    for number, port in enumerate(SCANNED):
        if trouble := machine.hmp(f"hostfwd_add net tcp:{here}:{FIRST_SCAN_PORT + number}-:{port}"):
            raise RuntimeError(trouble)
    for start in range(0, len(SCANNED), 100):
        for number in range(start, min(start + 100, len(SCANNED))):
            call = socket.socket()
            call.settimeout(5)
            call.connect((here, FIRST_SCAN_PORT + number))
            calls.append(call)
        end = time.monotonic() + ANSWERS_WITHIN_S
        while time.monotonic() < end:
            for line in machine.hmp("info usernet").splitlines():
                # Protocol[state]  descriptor  source address and port  destination address and port  ...
                words = line.split()
                if words and words[0] in ANSWERED:
                    answering.add(int(words[5]))
            time.sleep(0.5)
        for call in calls:
            call.close()
        calls.clear()
    return sorted(answering & set(SCANNED))


def expected_firmware():
    return [line for line in (HERE / "expected/firmware").read_text().split("\n") if line and not line.startswith("#")]


def look_at_running(machine, figures, lists="", ports=(OPERATOR_PORT,)):
    failed = figures["failed"]
    _, sockets = machine.run("ss -Htulnp | sed -E 's/users:..\"([^\"]*)\".*/\\1/' | awk '{print $1, $5, $NF}' | sort -u", 60)
    compare(lists + "listening", [re.sub(r"%\w+", "", line) for line in sockets.splitlines()], failed)
    _, running = machine.run(PROCESSES, 300)
    compare(lists + "processes", [line.rstrip() for line in running.splitlines()], failed)
    _, used = machine.run("free -m | awk '/^Mem/ {print $3}'")
    figures["memory_used_mb"] = int(used)
    _, noted = machine.run("journalctl -b -p warning -o short-monotonic --no-hostname --no-pager | tail -n 80", 120)
    noted = [line.rstrip() for line in noted.splitlines() if not line.startswith("-- ")]
    figures["journal_of_the_board"] = len(noted)
    figures["journal_above_notice"] = compare_journal(noted, failed)
    figures["journal_of_the_board"] -= figures["journal_above_notice"]
    print("\n".join(noted))
    wanted = [] if lists else expected_firmware()  # A render host needs none.
    _, missing = machine.run("cd /usr/lib/firmware; for f in " + " ".join(wanted) + '; do [ -e "$f" ] || echo "$f"; done')
    failed.extend(f"firmware: '{name}' is not in the image" for name in missing.split())
    figures["ports_open"] = scan(machine)
    if figures["ports_open"] != list(ports):
        failed.append(f"open ports: {figures['ports_open']}")


def exposures(folder):
    """Returns {unit: rating} of all our services, those of root included, in every image."""
    found = {}
    for profile in PROFILES:
        root = folder / f"units-{profile}"
        for service in install_units(root, ("mkosi.extra", f"mkosi.profiles/{profile}/mkosi.extra")):
            found[service.removesuffix(".service")] = exposure(root, service)
    return dict(sorted(found.items(), key=lambda item: (item[1], item[0])))


def run(options, folder):
    figures = {"failed": []}
    figures |= exposures(folder)
    for name, value in figures.items():
        if name.startswith("cyclorama-") and value > ROOTS.get(name, MAX_EXPOSURE):
            figures["failed"].append(f"{name}: exposed {value}, at most {ROOTS.get(name, MAX_EXPOSURE)}")
        if name.startswith("cyclorama-") and f"| `{name}` |" not in TABLE.read_text():
            figures["failed"].append(f"{name}: is not in the table of {TABLE.relative_to(ROOT)}")
    shipped = options.out / "cyclorama-museum"
    for name in ("setuid", "users") if shipped.exists() else ():
        compare(name, (shipped / name).read_text().splitlines(), figures["failed"])
    if not options.quick and (options.out / "cyclorama-museum-debug").exists():
        reference = attract_pictures(options, folder)
        machine = Appliance(computer(options, folder))
        try:
            machine.wait_for_shell(900)
            wait_for_pictures(machine, reference)
            machine.run("systemctl is-system-running --wait", 600)
            look_at_running(machine, figures)
        finally:
            machine.power_off()
    return figures
