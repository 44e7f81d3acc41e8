# SPDX-License-Identifier: Apache-2.0
"""Updates from a stick on the Debug image: a good one is tried and stays, a bad one goes back by itself, and power that is cut
at any moment of an update leaves a computer that starts. Needs two versions: the second one under OUT/next (image/build --out)."""
import random
import re
import shutil
import subprocess
import time

from appliance import Appliance, Disk
from appliance_boot import image_of
from appliance_tamper import flip_bit
from disk_image import stick

STICK_MB = 700
START_S = 900
LONGEST_PAUSE_S = 6


def signed(folder, keys):
    """Its manifest, as image/build makes it."""
    names = sorted(path.name for path in folder.iterdir() if not path.name.startswith("SHA256SUMS"))
    sums = subprocess.run(["sha256sum", *names], cwd=folder, check=True, capture_output=True).stdout
    (folder / "SHA256SUMS").write_bytes(sums)
    subprocess.run(["openssl", "dgst", "-sha256", "-sign", str(keys / "update.key"), "-out", "SHA256SUMS.sig", "SHA256SUMS"], cwd=folder, check=True)


def stick_of(update, file):
    stick(file, STICK_MB, {f"update/{path.name}": path for path in update.iterdir()})
    return ["-drive", f"if=none,id=stick,format=raw,readonly=on,file={file}", "-device", "usb-storage,bus=usb.0,drive=stick,removable=on"]


def version(machine):
    return machine.run(". /etc/os-release; echo $IMAGE_VERSION")[1]


def started(disk, extra=()):
    machine = Appliance(disk, extra=extra)
    try:
        machine.wait_for_shell(START_S)
    except Exception:
        machine.power_off()
        raise
    return machine


def said_by_update(machine):
    return machine.run("cat /var/lib/cyclorama/update.json 2>/dev/null")[1]


def wait_for_update(machine, seconds=900):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if said := said_by_update(machine):
            return said
        time.sleep(2)
    return "nothing"


def cut_while_updating(machine, folder, cuts, chance):
    """[(seconds since the update began, the disk as a power cut then leaves it)], at random moments of one update. The machine
    stands still while its disk is copied: what the copy holds is what a killed QEMU leaves."""
    machine.run("until systemctl is-active -q 'cyclorama-update@*' || systemctl list-units --no-legend 'cyclorama-update@*' | grep -q activating; do sleep 0.2; done", 300)
    began, states, number = time.monotonic(), [], 0
    paused_s = 0.0
    while not said_by_update(machine):
        time.sleep(chance.uniform(0, LONGEST_PAUSE_S))
        stopped = time.monotonic()
        machine.ask("stop")
        states.append((round(stopped - began - paused_s, 1), machine.disk.copy(folder / f"cut-{number}")))
        machine.ask("cont")
        paused_s += time.monotonic() - stopped
        number += 1
        if len(states) > 2 * cuts:  # Disks are large.
            _, dropped = states.pop(chance.randrange(len(states)))
            shutil.rmtree(dropped.folder)
    while len(states) > cuts:
        _, dropped = states.pop(chance.randrange(len(states)))
        shutil.rmtree(dropped.folder)
    return states


def version_after(disk):
    machine = started(disk)
    try:
        return version(machine)
    finally:
        machine.power_off()


def run(options, folder):
    chance = random.Random(8)
    figures = {"updates": 0, "power_cuts": 0, "boots": 0, "rollbacks": 0, "cuts": [], "failed": []}
    next_update = options.out / "next/cyclorama-museum-debug/update"
    good = stick_of(next_update, folder / "good.img")
    bad_update = folder / "bad"
    shutil.copytree(next_update, bad_update)
    (root,) = bad_update.glob("*.root.raw")
    flip_bit(root, 1024 + 5)
    signed(bad_update, options.keys)
    bad = stick_of(bad_update, folder / "bad.img")
    shutil.rmtree(bad_update)

    disk = Disk(folder / "computer", image_of(options, True))
    machine = started(disk)
    old = version(machine)
    machine.run("systemctl is-system-running --wait", START_S)
    machine.run("sync")
    machine.power_off()
    figures["boots"] += 1
    other = disk.copy(folder / "bad-computer")

    machine = started(disk, good)
    states = cut_while_updating(machine, folder, options.cuts, chance)
    print(said_by_update(machine), flush=True)
    machine.run("sync")
    machine.power_off()
    figures["boots"] += 1
    new = version_after(disk)
    figures["boots"] += 1
    figures["updates"] += new != old
    if new == old:
        figures["failed"].append("the good update did not start")
    for after_s, cut in states:
        now = version_after(cut)
        figures["power_cuts"] += 1
        figures["boots"] += 1
        figures["cuts"].append({"after_s": after_s, "then": now})
        print(figures["cuts"][-1], flush=True)
        shutil.rmtree(cut.folder)
        if now not in (old, new):
            figures["failed"].append(f"power cut after {after_s} s of an update: {now} runs")

    machine = started(other, bad)
    print(wait_for_update(machine), flush=True)
    machine.run("sync")
    machine.power_off()
    machine = started(other)
    figures["boots"] += 2
    back = version(machine)
    panics = len(re.findall("Kernel panic", machine.console()))
    if back == old and panics:
        figures["rollbacks"] += 1
    else:
        figures["failed"].append(f"the bad update: {back} runs after {panics} panics")
    figures["tries_of_the_bad_one"] = panics
    machine.power_off()
    return figures
