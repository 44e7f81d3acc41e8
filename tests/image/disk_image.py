# SPDX-License-Identifier: Apache-2.0
"""Reads a raw disk image's partitions (GPT, UEFI specification 2.10, 5.3) and accesses its boot partition by mtools."""
import pathlib
import struct
import subprocess
import uuid

SECTOR = 512
ESP = uuid.UUID("c12a7328-f81f-11d2-ba4b-00a0c93ec93b")


def partitions(image):
    """Returns [(type, label, first byte, bytes)]."""
    found = []
    with open(image, "rb") as file:
        file.seek(SECTOR)
        header = file.read(92)
        assert header[:8] == b"EFI PART", image
        entries_at, count, size = struct.unpack_from("<QII", header, 72)
        file.seek(entries_at * SECTOR)
        for _ in range(count):
            entry = file.read(size)
            if entry[:16] == bytes(16):
                continue
            first, last = struct.unpack_from("<QQ", entry, 32)
            found.append((uuid.UUID(bytes_le=entry[:16]), entry[56:128].decode("utf-16-le").rstrip("\0"),
                          first * SECTOR, (last - first + 1) * SECTOR))
    return found


def place_of(image, label):
    return next((first, length) for _, name, first, length in partitions(image) if name == label)


class BootPartition:
    """The files of the ESP inside a raw image."""

    def __init__(self, image):
        first = next(first for kind, _, first, _ in partitions(image) if kind == ESP)
        self.drive = f"{image}@@{first}"

    def _run(self, program, *arguments):
        return subprocess.run([program, "-i", self.drive, *map(str, arguments)], check=True, capture_output=True,
                              text=True).stdout

    def names(self, folder):
        return [line.rsplit("/", 1)[-1] for line in self._run("mdir", "-b", f"::{folder}").splitlines() if line]

    def read(self, name, to):
        self._run("mcopy", "-o", "-n", f"::{name}", to)

    def write(self, file, name):
        self._run("mcopy", "-o", file, f"::{name}")

    def rename(self, name, to):
        self._run("mren", f"::{name}", f"::{to}")

    def make_folder(self, name):
        self._run("mmd", f"::{name}")


def stick(file, megabytes, contents):
    """Makes a FAT disk named CYCLORAMA with {path on it: file}."""
    with open(file, "wb") as image:
        image.truncate(megabytes * 1_000_000 // SECTOR * SECTOR)
    subprocess.run(["mformat", "-i", str(file), "-v", "CYCLORAMA", "-F", "::"], check=True)
    with open(file, "r+b") as image:
        # mformat writes a partition entry too, with which the stick would appear twice.
        image.seek(446)
        image.write(bytes(64))
    folders = sorted({parent for path in contents for parent in pathlib.PurePosixPath(path).parents
                      if str(parent) != "."}, key=str)
    for folder in folders:
        subprocess.run(["mmd", "-i", str(file), f"::{folder}"], check=True)
    for path, source in contents.items():
        subprocess.run(["mcopy", "-i", str(file), str(source), f"::{path}"], check=True)
