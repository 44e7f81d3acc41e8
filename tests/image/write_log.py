# SPDX-License-Identifier: Apache-2.0
"""A disk whose writes are logged by QEMU (blklogwrites, in the format of dm-log-writes), and what is on it after the
power failed at any moment.

A disk guarantees what was flushed, and nothing else: of the writes since the last flush it may have any, also later
ones without earlier ones.
"""
import contextlib
import pathlib
import shutil
import struct
import subprocess
import time

SECTOR = 512
MAGIC = 0x6A736677736872
FLUSH, FUA, DISCARD = 1, 2, 4


class WriteLog:
    """The writes in a log, in the disk's order."""

    def __init__(self, file):
        self.file = pathlib.Path(file)
        self.entries = []  # (first byte, bytes, flags, place of the data in the log)
        with open(file, "rb") as log:
            magic, version, self.count, sector = struct.unpack("<QQQI", log.read(28))
            assert (magic, version, sector) == (MAGIC, 1, SECTOR), file
            place = SECTOR
            for _ in range(self.count):
                log.seek(place)
                first, sectors, flags, _ = struct.unpack("<QQQQ", log.read(32))
                self.entries.append((first * SECTOR, sectors * SECTOR, flags, place + SECTOR))
                place += SECTOR + (0 if flags & DISCARD else sectors * SECTOR)

    def flushes(self):
        """Returns the numbers of writes after which all of them were on the disk."""
        return [number + 1 for number, (_, _, flags, _) in enumerate(self.entries) if flags & FLUSH]

    def data(self, number):
        _, length, flags, place = self.entries[number]
        if flags & DISCARD:
            return bytes(length)
        with open(self.file, "rb") as log:
            log.seek(place)
            return log.read(length)

    def surviving(self, point, chance):
        """Returns (the number of writes that are certainly on the disk, the numbers of later ones that happen to be)
        if the power fails after `point` writes."""
        certain = max((flush for flush in self.flushes() if flush <= point), default=0)
        return certain, [number for number in range(certain, point)
                         if self.entries[number][2] & FUA or chance.random() < 0.5]


class Replay:
    """A disk's content after power cuts at ascending moments, in a file that begins as the disk did."""

    def __init__(self, log, disk):
        self.log, self.disk, self.done = log, pathlib.Path(disk), 0

    def _write(self, disk, number):
        first, length, _, _ = self.log.entries[number]
        if length:
            disk.seek(first)
            disk.write(self.log.data(number))

    @contextlib.contextmanager
    def after(self, point, chance):
        """The file is the disk after a power cut behind `point` writes, for the time of the block; reading only."""
        certain, lucky = self.log.surviving(point, chance)
        undo = []
        with open(self.disk, "r+b") as disk:
            for number in range(self.done, certain):
                self._write(disk, number)
            self.done = certain
            for number in lucky:
                first, length, _, _ = self.log.entries[number]
                disk.seek(first)
                undo.append((first, disk.read(length)))
                self._write(disk, number)
        try:
            yield self.disk
        finally:
            with open(self.disk, "r+b") as disk:
                for first, before in reversed(undo):
                    disk.seek(first)
                    disk.write(before)


def points_of(log, count, chance):
    """Returns all flushes and `count` random moments, in order."""
    return sorted([*log.flushes(), *(chance.randrange(len(log.entries) + 1) for _ in range(count))])


class LoggedFolder:
    """A file system of ext4, as /var has it, on a disk whose writes are logged: a loop device over a file that QEMU
    serves."""

    def __init__(self, folder, megabytes):
        self.folder = pathlib.Path(folder)
        self.base, self.at = self.folder / "base.raw", self.folder / "at"
        self.at.mkdir(parents=True)
        with open(self.base, "wb") as base:
            base.truncate(megabytes << 20)
        subprocess.run(["mkfs.ext4", "-q", "-F", str(self.base)], check=True)

    @contextlib.contextmanager
    def mounted(self, disk=None):
        """Mounts the disk, or another one in its place, as the appliance does."""
        disk = disk or self.base
        subprocess.run(["fsck.ext4", "-p", str(disk)], stdout=subprocess.DEVNULL, check=False)
        subprocess.run(["mount", "-t", "ext4", "-o", "loop,nosuid,nodev,noatime,errors=remount-ro", str(disk),
                        str(self.at)], check=True)
        try:
            yield self.at
        finally:
            subprocess.run(["umount", str(self.at)], check=True)

    def logged(self, work):
        """Runs `work` on the mounted disk. Returns (the log, the disk before, the number of writes when `work` ended)."""
        before, file, served = self.folder / "before.raw", self.folder / "log", self.folder / "served"
        shutil.copy(self.base, before)
        file.write_bytes(b"")
        served.write_bytes(b"")
        server = subprocess.Popen(
            ["qemu-storage-daemon", "--blockdev", f"driver=file,filename={self.base},node-name=disk", "--blockdev",
             f"driver=file,filename={file},node-name=log", "--blockdev",
             "driver=blklogwrites,node-name=logged,file=disk,log=log,log-super-update-interval=1", "--export",
             f"type=fuse,id=served,node-name=logged,mountpoint={served},writable=on"])
        try:
            while served.stat().st_size == 0:
                time.sleep(0.05)
            # Without direct I/O there is one request at a time: QEMU 7.2 mixes up the data of several.
            loop = subprocess.run(["losetup", "--find", "--show", "--direct-io=off", str(served)], check=True,
                                  capture_output=True, text=True).stdout.strip()
            try:
                subprocess.run(["mount", "-t", "ext4", "-o", "nosuid,nodev,noatime,errors=remount-ro", loop,
                                str(self.at)], check=True)
                try:
                    work()
                    ended = WriteLog(file).count
                finally:
                    subprocess.run(["umount", str(self.at)], check=True)
            finally:
                subprocess.run(["losetup", "--detach", loop], check=True)
        finally:
            server.terminate()
            server.wait(30)
        return WriteLog(file), before, ended
