# SPDX-License-Identifier: Apache-2.0
"""Tests versions that were good and whose files have rotted: with two on the disk, the whole one starts after three
attempts of the other; when both are broken, the screen tells people. It needs a newer version under OUT/next
(image/build --debug --version V --out OUT/next)."""
import re
import subprocess
import time

from appliance import Appliance, save_png
from appliance_boot import computer
from appliance_tamper import flip_bit
from appliance_update import BACK_S, START_S, started, version
from disk_image import BootPartition, partitions, place_of

SLOT = "_empty"
LIT = 180  # Code value; the screen's letters have 220.
MIN_LIT_PIXELS = 2000
SHOWN_WITHIN_S = 600


class OpenDisk:
    """A computer's disk while it is switched off."""

    def __init__(self, disk):
        self.disk, self.raw = disk, disk.folder / "open.raw"
        subprocess.run(["qemu-img", "convert", "-O", "raw", str(disk.file), str(self.raw)], check=True)

    def close(self):
        subprocess.run(["qemu-img", "convert", "-O", "qcow2", str(self.raw), str(self.disk.file)], check=True)
        self.raw.unlink()

    def install(self, update, number):
        """Writes a version into the free slot, as systemd-sysupdate does."""
        free = [(index, first) for index, (_, label, first, _) in enumerate(partitions(self.raw), 1) if label == SLOT]
        for (index, first), kind in zip(free, ("verity", "root")):
            (file,) = update.glob(f"*.{kind}.raw")
            uuid = re.search(r"_([0-9a-f-]{36})\.", file.name)[1]
            with open(self.raw, "r+b") as disk:
                disk.seek(first)
                disk.write(file.read_bytes())
            for words in (["--part-label", f"{kind}_{number}"], ["--part-uuid", uuid]):
                subprocess.run(["sfdisk", "--quiet", words[0], str(self.raw), str(index), words[1]], check=True)
        (kernel,) = update.glob("*.efi")
        BootPartition(self.raw).write(kernel, f"/EFI/Linux/{kernel.stem}+3.efi")

    def rot(self, number):
        """Changes a bit of the version's root, where its file system begins."""
        flip_bit(self.raw, place_of(self.raw, f"root_{number}")[0] + 1024 + 5)

    def spend(self):
        """Takes all attempts of all versions."""
        esp = BootPartition(self.raw)
        for name in esp.names("/EFI/Linux"):
            esp.rename(f"/EFI/Linux/{name}", f"/EFI/Linux/{name.partition('+')[0].removesuffix('.efi')}+0-3.efi")


def changed(disk, change):
    opened = OpenDisk(disk)
    change(opened)
    opened.close()


def check_other(disk, old, figures):
    """Starts a computer whose newest version has rotted."""
    machine = Appliance(disk, processors=1)
    try:
        machine.wait_for_shell(BACK_S)
        figures["panics"] = machine.console().count("Kernel panic")
        if version(machine) == old and figures["panics"] == 3:
            figures["pictures"] += 1
        else:
            figures["failed"].append(f"the newer version has rotted: {version(machine)} after {figures['panics']} panics")
    finally:
        machine.power_off()


def check_screen(disk, options, figures):
    """Starts a computer of which both versions have rotted."""
    machine = Appliance(disk, processors=1, heads=1)
    try:
        deadline = time.monotonic() + SHOWN_WITHIN_S
        lit = 0
        while lit < MIN_LIT_PIXELS and time.monotonic() < deadline:
            time.sleep(2)
            picture = machine.picture(0)
            # The firmware has text, too.
            is_ours = "cyclorama: no version starts" in machine.console()
            lit = sum(value > LIT for value in picture[2][::3]) if picture and is_ours else 0
        if options.pictures and picture:
            options.pictures.mkdir(parents=True, exist_ok=True)
            save_png(picture, options.pictures / "broken.png")
        figures["screens"] += lit >= MIN_LIT_PIXELS
        if lit < MIN_LIT_PIXELS:
            figures["failed"].append(f"no screen when both versions are broken; {lit} pixels are lit")
    finally:
        machine.power_off()


def run(options, folder):
    figures = {"failed": [], "cases": 2, "pictures": 0, "screens": 0}
    disk = computer(options, folder)
    machine = started(disk)
    try:
        old = version(machine)
        # The health check comes last.
        machine.run("systemctl is-system-running --wait; sync", START_S)
    finally:
        machine.power_off()
    update = options.out / "next" / "cyclorama-museum-debug/update"
    new = re.search(r"_([\d.]+)\.efi", next(update.glob("*.efi")).name)[1]
    changed(disk, lambda opened: (opened.install(update, new), opened.rot(new)))
    check_other(disk, old, figures)
    changed(disk, lambda opened: (opened.rot(old), opened.spend()))
    check_screen(disk, options, figures)
    return figures
