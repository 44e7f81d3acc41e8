# SPDX-License-Identifier: Apache-2.0
"""Tests settings on a stick: good ones are taken into use, wrong ones are refused with a reason and change nothing."""
import pathlib
import sys

from appliance import Appliance
from appliance_boot import computer
from disk_image import stick

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/tools"))
from museum_room import room_on  # noqa: E402
GOOD = '[farm]\ncoordinators = ["[2001:db8::1]:7401"]\nmuseum = "Hall 3"\n'
BAD = '[farm]\nheds = ["[2001:db8::1]:7401"]\n'

def plug(machine, folder, name, site):
    """Plugs in a stick with these settings until they were checked."""
    file = folder / f"{name}.toml"
    file.write_text(site)
    image = folder / f"{name}.img"
    room = folder / "installation.toml"
    room.write_text(room_on(ROOT, "Virtual"))
    stick(image, 40, {"cyclorama/site.toml": file, "cyclorama/installation.toml": room})
    if not machine.plug_stick(image, name):
        print(machine.run("journalctl -b -o cat --no-pager -u 'cyclorama-provision@*' | tail -n 20")[1], flush=True)


def expect(machine, figures, what, command, wanted):
    _, found = machine.run(command)
    if wanted not in found:
        figures["failed"].append(f"{what}: {found!r} does not contain {wanted!r}")
    print(f"{what}: {found}", flush=True)


def check_sticks(machine, folder, figures):
    """Tests a running computer that has the image's own settings; afterwards the good stick's are in use."""
    expect(machine, figures, "without a stick", "cat /etc/cyclorama/site.toml", "[::1]:7401")
    plug(machine, folder, "good", GOOD)
    expect(machine, figures, "a good stick", "cat /etc/cyclorama/site.toml", "Hall 3")
    expect(machine, figures, "a good stick, report", "cat /var/lib/cyclorama/provisioning.json", "installed")
    plug(machine, folder, "bad", BAD)
    expect(machine, figures, "a bad stick", "cat /etc/cyclorama/site.toml", "Hall 3")
    expect(machine, figures, "a bad stick, report", "cat /var/lib/cyclorama/provisioning.json", "heds")
    figures["taken"] = int(not any("good stick" in bad for bad in figures["failed"]))
    figures["refused"] = int(not any("bad stick" in bad for bad in figures["failed"]))


def check_reset(machine, figures):
    """Tests the start after /var/lib/cyclorama/factory-reset was made."""
    expect(machine, figures, "after a factory reset, /var", "cat /run/cyclorama/var", "encrypted")
    machine.run("for i in $(seq 90); do [ -e /etc/cyclorama/site.toml ] && break; sleep 1; done", 300)
    expect(machine, figures, "after a factory reset, settings", "cat /etc/cyclorama/site.toml", "[::1]:7401")


def run(options, folder):
    disk = computer(options, folder)
    figures = {"failed": []}
    machine = Appliance(disk)
    try:
        machine.wait_for_shell(900)
        machine.run("systemctl is-system-running --wait", 900)
        check_sticks(machine, folder, figures)
        machine.run("touch /var/lib/cyclorama/factory-reset; sync; sleep 1")
    finally:
        machine.power_off()
    machine = Appliance(disk)
    try:
        machine.wait_for_shell(900)
        check_reset(machine, figures)
    finally:
        machine.power_off()
    return figures
