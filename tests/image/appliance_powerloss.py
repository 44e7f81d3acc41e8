# SPDX-License-Identifier: Apache-2.0
"""Cuts the power during an update as disks know it: QEMU logs the disk's writes while the Debug image writes a newer
version beside itself and starts it. At every flush and at random moments the disk has what was flushed and some of the
other writes. What the boot loader would start must be whole there; some of the moments are started. It needs a newer
version under OUT/next (image/build --debug --version V --out OUT/next)."""
import hashlib
import random
import re
import shutil
import subprocess

from appliance import Appliance
from appliance_boot import computer
from appliance_cuts import is_same
from appliance_update import START_S, UPDATED_S, after_cut, stick_of, version, wait_for_report
from disk_image import BootPartition, partitions
from write_log import Replay, WriteLog, points_of

RANDOM_POINTS = 200
KERNEL = re.compile(r"_([\d.]+)(?:\+(\d+)(?:-\d+)?)?\.efi$")


def hash_of(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


class Versions:
    """The files of both versions, as image/build made them."""

    def __init__(self, updates):
        self.files = {number: {kind: next(folder.glob(f"*{kind}")) for kind in (".efi", ".verity.raw", ".root.raw")}
                      for number, folder in updates.items()}
        self.kernels = {number: hash_of(files[".efi"]) for number, files in self.files.items()}

    def whole(self, raw, folder):
        """Returns {version: whether it is intact} of those that the boot loader would start."""
        places = {label: first for _, label, first, _ in partitions(raw)}
        esp = BootPartition(raw)
        found = {}
        for name in esp.names("/EFI/Linux"):
            kernel = KERNEL.search(name)
            # A version without attempts left is started only if all others fail.
            if not kernel or kernel[2] == "0":
                continue
            esp.read(f"/EFI/Linux/{name}", folder / "cut.efi")
            number = kernel[1]
            is_whole = hash_of(folder / "cut.efi") == self.kernels[number] and all(
                is_same(raw, places.get(f"{kind}_{number}", 0), self.files[number][f".{kind}.raw"])
                for kind in ("verity", "root"))
            found[number] = found.get(number, True) and is_whole
        return found


def logged_update(disk, update, folder, figures):
    """Updates a computer and starts the new version. Returns (the log, the disk before, the running version)."""
    before = folder / "before.raw"
    subprocess.run(["qemu-img", "convert", "-O", "raw", str(disk.file), str(before)], check=True)
    log = folder / "log"
    machine = Appliance(disk, processors=1, log=log)
    try:
        machine.wait_for_shell(START_S)
        old = version(machine)
        machine.attach_stick(stick_of(update, folder / "good.img"), "good")
        report = wait_for_report(machine, "ready", UPDATED_S)
        if "no 'ready'" in report:
            raise RuntimeError(report)
        machine.ask("device_del", id="good")
        machine.restart(START_S)
        if version(machine) == old:
            figures["failed"].append(f"the update is not in use: {version(machine)}")
        # The health check renames the kernel image.
        machine.run("systemctl is-system-running --wait; sync", START_S)
    finally:
        machine.power_off()
    return WriteLog(log), before, old


def check_points(log, before, versions, old, folder, options, figures):
    """Returns the moments to be started: disks, spread over all moments."""
    chance = random.Random(25)
    points = points_of(log, options.points, chance)
    count = len(points) if options.starts is None else min(len(points), options.starts)
    chosen = {int((number + 0.5) * len(points) / count) for number in range(count)}
    replay, kept = Replay(log, before), []
    for number, point in enumerate(points):
        with replay.after(point, chance) as raw:
            try:
                whole = versions.whole(raw, folder)
            except (OSError, AssertionError, subprocess.CalledProcessError) as error:
                whole = {"": False}
                print(error, flush=True)
            figures["points"] += 1
            if not whole or not all(whole.values()):
                figures["half"] += 1
                figures["failed"].append(f"after {point} of {len(log.entries)} writes: {whole}")
            figures["whole"][" and ".join(sorted(whole))] = figures["whole"].get(" and ".join(sorted(whole)), 0) + 1
            if number in chosen:
                file = folder / f"point-{point}.qcow2"
                subprocess.run(["qemu-img", "convert", "-O", "qcow2", str(raw), str(file)], check=True)
                kept.append((point, file))
    figures["old"] = old
    return kept


def run(options, folder):
    figures = {"points": 0, "started": 0, "half": 0, "whole": {}, "starts": [], "failed": []}
    update = options.out / "next/cyclorama-museum-debug/update"
    new = re.search(r"_([\d.]+)\.efi", next(update.glob("*.efi")).name)[1]
    disk = computer(options, folder)
    if not options.computer:  # The first start divides the disk, which is not the update's business.
        machine = Appliance(disk, processors=1)
        try:
            machine.wait_for_shell(START_S)
            machine.run("systemctl is-system-running --wait; sync", START_S)
        finally:
            machine.power_off()
    state = disk.copy(folder / "state")
    log, before, old = logged_update(disk, update, folder, figures)
    figures["writes"], figures["flushes"] = len(log.entries), len(log.flushes())
    versions = Versions({old: options.out / "cyclorama-museum-debug/update", new: update})
    for point, file in check_points(log, before, versions, old, folder, options, figures):
        cut = state.copy(folder / f"computer-{point}")
        shutil.move(file, cut.file)
        account = {"point": point} | after_cut(cut, folder / f"start-{point}")
        shutil.rmtree(cut.folder)
        figures["starts"].append(account)
        figures["started"] += account.get("version") in (old, new) and account.get("var") == "encrypted"
    if figures["started"] != len(figures["starts"]):
        figures["failed"].append(f"{len(figures['starts']) - figures['started']} moments do not start")
    return figures
