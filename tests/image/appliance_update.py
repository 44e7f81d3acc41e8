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


def wait_for_update(machine, seconds=900):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        _, said = machine.run("cat /var/lib/cyclorama/update.json 2>/dev/null")
        if said:
            return said
        time.sleep(2)
    return "nothing"


def run(options, folder):
    keys = options.keys
    chance = random.Random(8)
    figures = {"updates": 0, "power_cuts": 0, "boots": 0, "rollbacks": 0, "cuts": [], "failed": []}
    next_update = options.out / "next/cyclorama-museum-debug/update"
    good = stick_of(next_update, folder / "good.img")
    bad_update = folder / "bad"
    shutil.copytree(next_update, bad_update)
    (root,) = bad_update.glob("*.root.raw")
    flip_bit(root, 1024 + 5)
    signed(bad_update, keys)
    bad = stick_of(bad_update, folder / "bad.img")

    disk = Disk(folder / "computer", image_of(options, True))
    machine = started(disk)
    old = version(machine)
    machine.run("systemctl is-system-running --wait", START_S)
    machine.run("sync")
    machine.power_off()
    figures["boots"] += 1

    # Cuts: the stick is in the computer at each start, so each start begins the update again, until one gets through.
    for cut in range(options.cuts):
        other = disk.copy(folder / "cut")
        machine = started(other, good)
        machine.run("until systemctl is-active -q 'cyclorama-update@*' || [ -e /var/lib/cyclorama/update.json ]; do sleep 0.2; done", 300)
        after = chance.uniform(0, options.longest_update_s)
        time.sleep(after)
        _, until = machine.run("cat /var/lib/cyclorama/update.json 2>/dev/null; bootctl --no-pager list 2>/dev/null | grep -c 'id:'", 60)
        machine.power_off()
        figures["power_cuts"] += 1
        machine = started(other)
        now = version(machine)
        figures["boots"] += 1
        figures["cuts"].append({"after_s": round(after, 1), "had_said": until.splitlines()[0] if until else "", "then": now})
        print(figures["cuts"][-1], flush=True)
        machine.power_off()
        shutil.rmtree(folder / "cut")

    machine = started(disk, good)
    print(wait_for_update(machine))
    machine.run("sync")
    machine.power_off()
    machine = started(disk)
    new = version(machine)
    figures["boots"] += 1
    figures["updates"] += new != old
    if new == old:
        figures["failed"].append("the good update did not start")
    machine.power_off()

    other = Disk(folder / "bad-computer", image_of(options, True))
    machine = started(other, bad)
    print(wait_for_update(machine))
    machine.run("sync")
    machine.power_off()
    machine = started(other)
    figures["boots"] += 1
    back = version(machine)
    panics = len(re.findall("Kernel panic", machine.console()))
    if back == old and panics:
        figures["rollbacks"] += 1
    else:
        figures["failed"].append(f"the bad update: {back} runs after {panics} panics")
    figures["tries_of_the_bad_one"] = panics
    machine.power_off()
    return figures
