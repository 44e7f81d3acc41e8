#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the V4L2 camera on a kernel video device: a virtual machine loads vivid, whose HDMI output is connected to its
input; test-camera sends a rendered hand with a tag through it, compares every bit, makes the driver fail in every way
that it offers, and unplugs and replugs the camera under a running cyclorama-tracker, which must find the tag before and
after. It needs QEMU and some minutes: ctest runs it only with CYCLORAMA_IMAGE_TESTS=1. The kernel is Debian's, fetched
with apt-get.

With libcamera 0.4 or later, a second machine tests our libcamera camera with libcamera's virtual camera.

Run: CYCLORAMA_IMAGE_TESTS=1 camera_test.py SOURCE_ROOT BUILD_FOLDER [KEPT], where KEPT is a folder that keeps the
kernel.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

from heads_test import cpio, fetch_kernel, module_bytes, needed_libraries

ENDS_WITHIN_S = 600
TRACKER = "bin/cyclorama-tracker"
LIBCAMERA_CONFIG = """"Virtual0":
  supported_formats:
  - width: 640
    height: 480
    frame_rates:
    - 30
    - 60
  test_pattern: "lines"
  location: "CameraLocationFront"
  model: "Virtual"
"""


def with_dependencies(modules, name, ordered):
    """Appends (name, bytes) of the module and its dependencies to `ordered`, dependencies first."""
    if any(known == name for known, _ in ordered):
        return
    data = module_bytes(modules, name) or module_bytes(modules, name.replace("_", "-"))
    if data is None:
        return  # The module is built into the kernel.
    needed = re.search(rb"\0depends=([^\0]*)\0", data)
    for dependency in filter(None, needed[1].decode().split(",") if needed else []):
        with_dependencies(modules, dependency, ordered)
    ordered.append((name, data))


def guest_files(build, modules):
    """Returns {path in the guest: bytes}."""
    files = {"init": (build / "tests/test-camera").read_bytes(), TRACKER: (build / TRACKER).read_bytes()}
    ordered = []
    with_dependencies(modules, "vivid", ordered)
    for number, (name, data) in enumerate(ordered):
        files[f"modules/{number:02}-{name}.ko"] = data
    wanted = set()
    for program in (build / "tests/test-camera", build / TRACKER):
        wanted |= needed_libraries(program)
    for path in wanted:
        files[path.lstrip("/")] = pathlib.Path(path).read_bytes()
    return files


def libcamera_files(program):
    """Returns the files of the machine with libcamera's virtual camera, or None where libcamera has none (before
    0.4)."""
    libraries = needed_libraries(program)
    found = next((re.search(r"libcamera\.so\.(\d+)\.(\d+)$", path) for path in libraries if "libcamera.so" in path),
                 None)
    if not found or (int(found[1]), int(found[2])) < (0, 4):
        return None
    files = {"init": program.read_bytes()}
    files |= {path.lstrip("/"): pathlib.Path(path).read_bytes() for path in libraries}
    for module in pathlib.Path("/usr/lib/x86_64-linux-gnu/libcamera").glob("ipa_soft*"):
        files[str(module).lstrip("/")] = module.read_bytes()
    files["usr/share/libcamera/pipeline/virtual/virtual.yaml"] = LIBCAMERA_CONFIG.encode()
    return files


def run_machine(kernel, initrd, log):
    """Returns the guest's output."""
    machine = subprocess.Popen(
        ["qemu-system-x86_64", "-machine", "q35", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m",
         "2048", "-nodefaults", "-no-reboot", "-display", "none", "-kernel", kernel, "-initrd", initrd,
         "-append", "console=ttyS0 panic=-1 loglevel=4 no_timer_check", "-serial", f"file:{log}"],
         stdin=subprocess.DEVNULL)
    deadline = time.monotonic() + ENDS_WITHIN_S
    try:
        while machine.poll() is None and time.monotonic() < deadline:
            time.sleep(0.5)
    finally:
        machine.kill()
        machine.wait()
    return log.read_text(errors="replace")


def check(text):
    """Returns the failures as sentences."""
    bad = []
    if "camera: ok" not in text:
        failed = re.search(r"camera: failed.*", text)
        bad.append(failed[0] if failed else "the guest did not finish")
    for kind in ("mapped", r"\?memory=dma_buf"):
        if not re.search(rf"camera: pictures {kind}: (\d+) of \1 bit for bit, tag found in (\d+) of \2,", text):
            bad.append(f"{kind}: a picture differs from the one that was sent, or lacks the tag")
    if not re.search(r"camera: fault 'Inject Fatal Streaming Error': (?!not noticed)", text):
        bad.append("a broken stream was not noticed")
    parts = re.split(r"camera: (?:tracker starts|unplugged|plugged in again|tracker ends)", text)
    if len(parts) != 5:
        return bad + ["the tracker's part did not run"]
    _, before, without, after, _ = parts
    if "Follows tag 0" not in before:
        bad.append("the tracker did not find the tag")
    if "No pictures: " not in without:
        bad.append("the tracker did not report the loss of its camera")
    if "Follows tag 0" not in after:
        bad.append("the tracker did not find the tag again once its camera was back")
    return bad


def check_libcamera(kernel, program, folder):
    """Returns the failures of libcamera's pictures, none where it has no virtual camera."""
    files = libcamera_files(program)
    if files is None:
        print("camera: libcamera before 0.4 has no virtual camera; not tested")
        return []
    initrd = folder / "initrd-libcamera"
    initrd.write_bytes(cpio(files))
    text = run_machine(kernel, initrd, folder / "serial-libcamera.log")
    print("\n".join(line for line in text.splitlines() if "libcamera: " in line))
    if "libcamera: ok" in text:
        return []
    print(text[-6000:])
    return ["libcamera's virtual camera gives no pictures"]


def main(source, build, kept=None):
    if os.environ.get("CYCLORAMA_IMAGE_TESTS") != "1":
        print("camera: skipped, takes minutes; CYCLORAMA_IMAGE_TESTS=1 runs it")
        return 77
    if not shutil.which("qemu-system-x86_64"):
        print("camera: skipped, needs QEMU; scripts/install-packages image installs it")
        return 77
    subprocess.run(["cmake", "--build", build, "--target", "test-camera", "test-libcamera", "cyclorama-tracker"],
                   check=True, stdout=subprocess.DEVNULL)
    with tempfile.TemporaryDirectory(dir="/var/tmp") as name:
        folder = pathlib.Path(name)
        kernel_folder = pathlib.Path(kept or folder / "kernel")
        kernel_folder.mkdir(parents=True, exist_ok=True)
        kernel, modules = fetch_kernel(kernel_folder)
        initrd = folder / "initrd"
        initrd.write_bytes(cpio(guest_files(pathlib.Path(build), modules)))
        text = run_machine(kernel, initrd, folder / "serial.log")
        bad = check_libcamera(kernel, pathlib.Path(build) / "tests/test-libcamera", folder)
        if kept:
            (kernel_folder / "serial.log").write_text(text)
    print("\n".join(line for line in text.splitlines() if "camera: " in line or "Follows" in line
                    or "No pictures" in line))
    bad += check(text)
    if "camera: ok" not in text:
        print(text[-6000:])
    print("\n".join(bad) or "camera: ok")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
