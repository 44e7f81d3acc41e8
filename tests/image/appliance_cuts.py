# SPDX-License-Identifier: Apache-2.0
"""Power that is cut in the middle of an update: what the disk then holds."""
import hashlib
import re
import shutil
import subprocess
import time

from disk_image import BootPartition, partitions

LONGEST_PAUSE_S = 15
LONGEST_UPDATE_S = 900
BLOCK = 1 << 20


def cut_while(is_going_on, machine, folder, cuts, chance):
    """[(seconds since it began, the computer as a power cut then leaves it)], at random moments. The computer stands still while its
    files are copied, its clock, too: a process that is stopped from outside lets the guest doubt its clock, and count by a slower one."""
    began, states, number, held_s = time.monotonic(), [], 0, 0.0
    while is_going_on() and time.monotonic() - began < LONGEST_UPDATE_S:
        time.sleep(chance.uniform(0, LONGEST_PAUSE_S))
        stopped = time.monotonic()
        machine.ask("stop")
        try:
            states.append((round(stopped - began - held_s, 1), machine.disk.copy(folder / f"cut-{number}")))
        finally:
            machine.ask("cont")
        held_s += time.monotonic() - stopped
        number += 1
        if len(states) > 2 * cuts:  # Disks are large.
            shutil.rmtree(states.pop(chance.randrange(len(states)))[1].folder)
    while len(states) > cuts:
        shutil.rmtree(states.pop(chance.randrange(len(states)))[1].folder)
    return states


def is_same(file, first, wanted):
    """Whether the bytes of `file` from `first` on are those of the file `wanted`."""
    with open(file, "rb") as there, open(wanted, "rb") as here:
        there.seek(first)
        while block := here.read(BLOCK):
            if there.read(len(block)) != block:
                return False
    return True


def what_is_whole(disk, updates, folder):
    """{version: whether all of it is as it was signed} of the versions that the loader would start; `updates` has each version's
    folder of image/build."""
    raw, kernel = folder / "cut.raw", folder / "cut.efi"
    subprocess.run(["qemu-img", "convert", "-O", "raw", str(disk.file), str(raw)], check=True)
    places = {label: first for _, label, first, _ in partitions(raw)}
    esp = BootPartition(raw)
    found = {}
    for name in esp.names("/EFI/Linux"):
        is_kernel = re.search(r"_([\d.]+)(?:\+(\d+)(?:-\d+)?)?\.efi$", name)
        # What has no tries left is started only when all else fails.
        if not is_kernel or is_kernel[2] == "0":
            continue
        version = is_kernel[1]
        signed = {kind: next(updates[version].glob(f"*{kind}")) for kind in (".efi", ".verity.raw", ".root.raw")}
        esp.read(f"/EFI/Linux/{name}", kernel)
        found[version] = hashlib.sha256(kernel.read_bytes()).digest() == hashlib.sha256(signed[".efi"].read_bytes()).digest() and all(
            is_same(raw, places.get(f"{kind}_{version}", 0), signed[f".{kind}.raw"]) for kind in ("verity", "root"))
    raw.unlink()
    return found
