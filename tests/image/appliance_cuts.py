# SPDX-License-Identifier: Apache-2.0
"""Cuts the power during an update and inspects the disk."""
import hashlib
import re
import shutil
import subprocess
import time

from disk_image import BootPartition, partitions

MAX_PAUSE_S = 15
MAX_UPDATE_S = 900
BLOCK = 1 << 20


def cut_while(is_going_on, machine, folder, cuts, chance):
    """Returns [(seconds since the start of the update, the computer's state after a power cut)] at random times.

    QEMU pauses the computer and its clock while the files are copied. Stopping the process instead would make the guest
    distrust its clock and switch to a slower one.
    """
    began, states, number, held_s = time.monotonic(), [], 0, 0.0
    while is_going_on() and time.monotonic() - began < MAX_UPDATE_S:
        time.sleep(chance.uniform(0, MAX_PAUSE_S))
        stopped = time.monotonic()
        machine.ask("stop")
        try:
            states.append((round(stopped - began - held_s, 1), machine.disk.copy(folder / f"cut-{number}")))
        finally:
            machine.ask("cont")
        held_s += time.monotonic() - stopped
        number += 1
        if len(states) > 2 * cuts:  # Disks are large, so a copy that is not needed is deleted.
            shutil.rmtree(states.pop(chance.randrange(len(states)))[1].folder)
    while len(states) > cuts:
        shutil.rmtree(states.pop(chance.randrange(len(states)))[1].folder)
    return states


def is_same(file, first, wanted):
    """Returns whether the bytes of `file` from `first` on equal the file `wanted`."""
    with open(file, "rb") as there, open(wanted, "rb") as here:
        there.seek(first)
        while block := here.read(BLOCK):
            if there.read(len(block)) != block:
                return False
    return True


def what_is_whole(disk, updates, folder):
    """Returns {version: whether it is intact} for the versions that the loader would start. `updates` maps versions to
    their folders of image/build."""
    raw, kernel = folder / "cut.raw", folder / "cut.efi"
    subprocess.run(["qemu-img", "convert", "-O", "raw", str(disk.file), str(raw)], check=True)
    places = {label: first for _, label, first, _ in partitions(raw)}
    esp = BootPartition(raw)
    found = {}
    for name in esp.names("/EFI/Linux"):
        is_kernel = re.search(r"_([\d.]+)(?:\+(\d+)(?:-\d+)?)?\.efi$", name)
        # A version without attempts left is started only if all others fail.
        if not is_kernel or is_kernel[2] == "0":
            continue
        version = is_kernel[1]
        signed = {kind: next(updates[version].glob(f"*{kind}")) for kind in (".efi", ".verity.raw", ".root.raw")}
        esp.read(f"/EFI/Linux/{name}", kernel)
        found[version] = hashlib.sha256(kernel.read_bytes()).digest() == hashlib.sha256(signed[".efi"].read_bytes()).digest() and all(
            is_same(raw, places.get(f"{kind}_{version}", 0), signed[f".{kind}.raw"]) for kind in ("verity", "root"))
    raw.unlink()
    return found
