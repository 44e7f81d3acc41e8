#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the V4L2 camera on the kernel's USB video driver, in a virtual machine with an emulated USB camera
(usb_camera.py). Every bit of its pictures must arrive, also when they change. It is unplugged and plugged in again,
first under our driver (test-usb-camera), then under cyclorama-tracker, which must find the wand before and after. It
needs QEMU and minutes: ctest runs it only with CYCLORAMA_IMAGE_TESTS=1. The kernel is Debian's, fetched with apt-get.

Run: CYCLORAMA_IMAGE_TESTS=1 usb_camera_guest_test.py SOURCE_ROOT BUILD_FOLDER [KEPT], where KEPT is a folder that keeps
the kernel.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

from appliance_farm import wand_pictures
from camera_test import TRACKER, with_dependencies
from heads_test import cpio, fetch_kernel, needed_libraries
from usb_camera import UsbCamera

MODULES = ("xhci_pci", "uvcvideo")
WIDTH, HEIGHT = 640, 480
ENDS_WITHIN_S = 600
PROGRAM = "tests/test-usb-camera"


def fingerprint(data):
    """Returns the 64-bit FNV-1a hash."""
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 & 0xffffffffffffffff
    return f"{value:016x}"


class Guest:
    """The machine and its output."""

    def __init__(self, kernel, initrd, folder, camera):
        self._log = folder / "serial.log"
        self._seen = 0
        self.process = subprocess.Popen(
            ["qemu-system-x86_64", "-machine", "q35", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m",
             "1024", "-nodefaults",
             "-no-reboot", "-display", "none", "-kernel", kernel, "-initrd", initrd, "-device", "qemu-xhci,id=usb",
             *camera.options(),
             "-append", "console=ttyS0 panic=-1 loglevel=4 no_timer_check", "-serial", f"file:{self._log}"],
             stdin=subprocess.DEVNULL)
        self._until = time.monotonic() + ENDS_WITHIN_S

    def text(self):
        return self._log.read_text(errors="replace") if self._log.exists() else ""

    def wait_for(self, pattern):
        """Waits for a pattern in the output after the previous match."""
        while time.monotonic() < self._until:
            text = self.text()
            if found := re.compile(pattern).search(text, self._seen):
                self._seen = found.end()
                print(found[0].strip(), flush=True)
                return found
            if self.process.poll() is not None or "usb: failed" in text:
                break
            time.sleep(0.3)
        raise RuntimeError(f"no {pattern!r}:\n{text[-5000:]}")

    def stop(self):
        self.process.kill()
        self.process.wait()


def check(guest, camera, pictures):
    guest.wait_for("usb: waits.*\n")
    for name in ("rest", "right"):
        camera.show(pictures[name])
        camera.plug()
        guest.wait_for(r"usb: listed v4l2:usb-\S+ \(Test camera.*\), sends 640x480 YUYV at 10.*\n" if name == "rest"
                       else "usb: listed.*\n")
        guest.wait_for(rf"usb: picture {fingerprint(pictures[name])} {WIDTH}x{HEIGHT}, 10 the same.*exposure 5.0 ms\s")
        other = "right" if name == "rest" else "rest"
        camera.show(pictures[other])
        guest.wait_for(rf"usb: picture {fingerprint(pictures[other])} {WIDTH}x{HEIGHT}, 0 the same.*\n")
        print(f"{camera.sent()} pictures were sent", flush=True)
        camera.unplug()
        guest.wait_for("usb: gone: .*\n")
    guest.wait_for("usb: tracker starts")
    for _ in range(2):
        guest.wait_for("No pictures: .*\n")
        camera.plug()
        guest.wait_for("Follows tag 0.*\n")
        camera.unplug()


def main(source, build, kept=None):
    if os.environ.get("CYCLORAMA_IMAGE_TESTS") != "1":
        print("usb: skipped, takes minutes; CYCLORAMA_IMAGE_TESTS=1 runs it")
        return 77
    if not shutil.which("qemu-system-x86_64"):
        print("usb: skipped, needs QEMU; scripts/install-packages image installs it")
        return 77
    build = pathlib.Path(build)
    subprocess.run(["cmake", "--build", build, "--target", "test-usb-camera", "test-wand", "cyclorama-tracker"],
                   check=True, stdout=subprocess.DEVNULL)
    with tempfile.TemporaryDirectory(dir="/var/tmp") as name:
        folder = pathlib.Path(name)
        kernel_folder = pathlib.Path(kept or folder / "kernel")
        kernel_folder.mkdir(parents=True, exist_ok=True)
        kernel, modules = fetch_kernel(kernel_folder)
        files = {"init": (build / PROGRAM).read_bytes(), TRACKER: (build / TRACKER).read_bytes()}
        ordered = []
        for module in MODULES:
            with_dependencies(modules, module, ordered)
        files |= {f"modules/{number:02}-{module}.ko": data for number, (module, data) in enumerate(ordered)}
        for library in needed_libraries(build / PROGRAM) | needed_libraries(build / TRACKER):
            files[library.lstrip("/")] = pathlib.Path(library).read_bytes()
        initrd = folder / "initrd"
        initrd.write_bytes(cpio(files))
        camera = UsbCamera(folder / "camera", WIDTH, HEIGHT)
        guest = Guest(kernel, initrd, folder, camera)
        try:
            check(guest, camera, wand_pictures(build / "bin", folder))
        finally:
            guest.stop()
            camera.unplug()
    print("usb: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
