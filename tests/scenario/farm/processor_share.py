# SPDX-License-Identifier: Apache-2.0
"""A fixed share of one processor for a process, so that many nodes on few processors run like as many slow machines.

It needs root and the kernel's cpu controller (version 2 or 1).
"""
import os
import pathlib

PERIOD_US = 5000  # Shorter periods are more even; the kernel allows no quota below 1000 us.
V2, V1 = pathlib.Path("/sys/fs/cgroup"), pathlib.Path("/sys/fs/cgroup/cpu")


class ProcessorShare:
    """A share, which exists from here until remove(), which is called when its processes have ended."""

    def __init__(self, name, of_one_processor):
        self.version2 = "cpu" in _words(V2 / "cgroup.controllers")
        self.folder = (V2 if self.version2 else V1) / f"cyclorama-{os.getpid()}-{name}"
        quota = max(1000, int(PERIOD_US * of_one_processor))
        self.folder.mkdir()
        if self.version2:
            (self.folder / "cpu.max").write_text(f"{quota} {PERIOD_US}")
        else:
            (self.folder / "cpu.cfs_period_us").write_text(str(PERIOD_US))
            (self.folder / "cpu.cfs_quota_us").write_text(str(quota))

    @staticmethod
    def is_possible():
        return os.geteuid() == 0 and ("cpu" in _words(V2 / "cgroup.controllers") or (V1 / "cgroup.procs").exists())

    def add(self, process):
        (self.folder / "cgroup.procs").write_text(str(process.pid))

    def remove(self):
        self.folder.rmdir()


def _words(file):
    try:
        return file.read_text().split()
    except OSError:
        return []
