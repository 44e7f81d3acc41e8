# SPDX-License-Identifier: Apache-2.0
"""Settings on a stick: good ones are taken, wrong ones are refused with a reason and change nothing."""
import pathlib

from appliance import Appliance, Disk
from appliance_boot import image_of
from disk_image import stick

ROOT = pathlib.Path(__file__).resolve().parents[2]
GOOD = '[farm]\nheads = ["[2001:db8::1]:7401"]\nmuseum = "Hall 3"\n'
BAD = '[farm]\nheds = ["[2001:db8::1]:7401"]\n'


def run(options, folder):
    disk = Disk(folder / "computer", image_of(options, True))
    figures = {"taken": 0, "refused": 0, "failed": []}
    machine = Appliance(disk)
    try:
        machine.wait_for_shell(900)
        machine.run("systemctl is-system-running --wait", 900)

        def plug(name, site):
            file = folder / f"{name}.toml"
            file.write_text(site)
            image = folder / f"{name}.img"
            stick(image, 40, {"cyclorama/site.toml": file, "cyclorama/installation.toml": ROOT / "demo/installation.toml"})
            machine.ask("blockdev-add", driver="raw", **{"node-name": name}, **{"read-only": True}, file={"driver": "file", "filename": str(image)})
            machine.ask("device_add", driver="usb-storage", id=name, bus="usb.0", drive=name, removable=True)
            machine.run(f"for i in $(seq 60); do journalctl -b -o cat -u 'cyclorama-provision@*' | grep -c 'Finished\\|Failed' | grep -qx {plug.number} && break; sleep 2; done", 300)
            plug.number += 1
            machine.ask("device_del", id=name)
        plug.number = 1

        def expect(what, command, wanted):
            _, found = machine.run(command)
            if wanted not in found:
                figures["failed"].append(f"{what}: {found!r} does not say {wanted!r}")
            print(f"{what}: {found}")

        expect("without a stick", "cat /etc/cyclorama/site.toml", "[::1]:7401")
        plug("good", GOOD)
        expect("a good stick", "cat /etc/cyclorama/site.toml", "Hall 3")
        expect("a good stick, report", "cat /var/lib/cyclorama/provisioning.json", "installed")
        plug("bad", BAD)
        expect("a bad stick", "cat /etc/cyclorama/site.toml", "Hall 3")
        expect("a bad stick, report", "cat /var/lib/cyclorama/provisioning.json", "heds")
        machine.run("touch /var/lib/cyclorama/factory-reset; sync; sleep 1")
    finally:
        machine.power_off()
    machine = Appliance(disk)
    try:
        machine.wait_for_shell(900)
        machine.run("systemctl is-system-running --wait", 900)
        expect("after a factory reset", "cat /etc/cyclorama/site.toml; cat /run/cyclorama/var", "[::1]:7401")
    finally:
        machine.power_off()
    figures["taken"] = int(not any("good stick" in bad for bad in figures["failed"]))
    figures["refused"] = int(not any("bad stick" in bad for bad in figures["failed"]))
    return figures
