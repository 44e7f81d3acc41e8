#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the DRM output on a kernel's KMS: a virtual machine with a virtio graphics card of three heads runs test-wall,
and each head's picture is compared pixel by pixel (QEMU's screen dumps). It needs QEMU and a minute or more: ctest runs
it only with CYCLORAMA_IMAGE_TESTS=1. The kernel is Debian's, fetched with apt-get.

Run: CYCLORAMA_IMAGE_TESTS=1 heads_test.py SOURCE_ROOT BUILD_FOLDER [KEPT], where KEPT is a folder that keeps the
kernel.
"""
import json
import lzma
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

WIDTH, HEIGHT, HEADS = 640, 480, 3
MODULES = ["virtio_ring", "virtio", "virtio_pci_legacy_dev", "virtio_pci_modern_dev", "virtio_pci", "virtio_dma_buf",
           "drm", "drm_kms_helper", "drm_shmem_helper", "drm_client_lib", "virtio-gpu"]
LIBRARIES = pathlib.Path("/usr/lib/x86_64-linux-gnu")
STARTS_WITHIN_S = 300


def fetch_kernel(folder):
    """Returns (image, folder of modules) of Debian's newest kernel."""
    if not list(folder.glob("boot/vmlinuz-*")):
        depends = subprocess.run(["apt-cache", "depends", "linux-image-amd64"], check=True, capture_output=True,
                                 text=True).stdout
        package = re.search(r"Depends: (linux-image-\S+)", depends)[1]
        subprocess.run(["apt-get", "download", "-q", package], check=True, cwd=folder, stdout=subprocess.DEVNULL)
        (deb,) = folder.glob(f"{package}_*.deb")
        subprocess.run(["dpkg-deb", "-x", deb, folder], check=True)
    (image,) = folder.glob("boot/vmlinuz-*")
    return image, next(path for path in folder.glob("**/lib/modules/*") if path.is_dir())


def module_bytes(modules, name):
    for found in modules.rglob(f"{name}.ko*"):
        return lzma.decompress(found.read_bytes()) if found.suffix == ".xz" else found.read_bytes()
    return None  # The module is built in, or missing in this version.


def needed_libraries(program):
    listed = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    return set(re.findall(r"(/\S+) \(0x", listed))


def guest_files(build, modules):
    """Returns {path in the guest: bytes}."""
    files = {"init": (build / "tests/test-wall").read_bytes()}
    for number, name in enumerate(MODULES):
        data = module_bytes(modules, name)
        if data is not None:
            files[f"modules/{number:02}-{name}.ko"] = data
    mesa = [LIBRARIES / "libEGL_mesa.so.0", LIBRARIES / "libGLESv2.so.2", LIBRARIES / "libgbm.so.1"]
    mesa += [path for path in (LIBRARIES / "dri").glob("*")
             if re.match(r"(kms_swrast|swrast|virtio_gpu|libdril)_dri", path.name)]
    mesa += list((LIBRARIES / "gbm").glob("*.so"))
    wanted = {str(path) for path in mesa}
    for program in [build / "tests/test-wall", *mesa]:
        wanted |= needed_libraries(program)
    for path in wanted:
        files[path.lstrip("/")] = pathlib.Path(path).read_bytes()
    vendor = "usr/share/glvnd/egl_vendor.d/50_mesa.json"
    files[vendor] = pathlib.Path("/", vendor).read_bytes()
    return files


def cpio(files):
    """Returns a newc archive (Documentation/driver-api/early-userspace/buffer-format.rst)."""
    folders = {str(parent) for path in files for parent in pathlib.PurePath(path).parents if str(parent) != "."}
    entries = [(name, 0o040755, b"") for name in sorted(folders)] + [(name, 0o100755, data)
                                                                     for name, data in files.items()]
    out = bytearray()
    for number, (name, mode, data) in enumerate(entries + [("TRAILER!!!", 0, b"")]):
        fields = [number + 1, mode, 0, 0, 1, 0, len(data), 0, 0, 0, 0, len(name) + 1, 0]
        out += b"070701" + "".join(f"{field:08X}" for field in fields).encode() + name.encode() + b"\0"
        out += bytes(-len(out) % 4) + data
        out += bytes(-len(out) % 4)
    return bytes(out)


class Machine:
    """QEMU with three heads, which a VNC display each makes connected."""

    def __init__(self, kernel, initrd, folder):
        self.folder = folder
        self.log = folder / "serial.log"
        vnc = [f"-vnc=unix:{folder}/vnc{head},display=card,head={head}".replace("-vnc=", "-vnc ", 1).split(" ", 1)
               for head in range(HEADS)]
        self.process = subprocess.Popen(
            ["qemu-system-x86_64", "-machine", "q35", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m",
             "2048", "-nodefaults", "-no-reboot",
             "-kernel", kernel, "-initrd", initrd, "-append", "console=ttyS0 panic=-1 quiet no_timer_check", "-serial",
             f"file:{self.log}", "-device", f"virtio-gpu-pci,id=card,max_outputs={HEADS},xres={WIDTH},yres={HEIGHT}",
             "-qmp", f"unix:{folder}/qmp,server=on,wait=off", *[word for pair in vnc for word in pair]],
            stdin=subprocess.DEVNULL, stderr=open(folder / "qemu.log", "w"))
        self.clients = []

    def connect(self):
        self.qmp = socket.socket(socket.AF_UNIX)
        self.qmp.settimeout(60)
        self.qmp.connect(str(self.folder / "qmp"))
        self.answers = self.qmp.makefile("r")
        self.answers.readline()
        self.ask("qmp_capabilities")

    def ask(self, command, **arguments):
        self.qmp.sendall(json.dumps({"execute": command, "arguments": arguments}).encode() + b"\n")
        while True:
            answer = json.loads(self.answers.readline())
            if "error" in answer:
                raise RuntimeError(answer["error"]["desc"])
            if "return" in answer:
                return answer["return"]

    def resize(self, head, width, height):
        """Requests another size as a VNC client: the card reports to the guest that a screen of that size was plugged
        in. (RFB 3.8 without security; pseudo-encoding -308 is ExtendedDesktopSize, message 251 SetDesktopSize.)"""
        client = socket.socket(socket.AF_UNIX)
        client.settimeout(60)
        client.connect(str(self.folder / f"vnc{head}"))
        client.recv(12)
        client.sendall(b"RFB 003.008\n")
        client.recv(2)
        client.sendall(b"\x01")
        client.recv(4)
        client.sendall(b"\x01")
        client.recv(1024)
        client.sendall(b"\x02\x00\x00\x01" + (-308).to_bytes(4, "big", signed=True))
        client.sendall(bytes([251, 0]) + width.to_bytes(2, "big") + height.to_bytes(2, "big") + bytes([1, 0]) +
                       (0).to_bytes(4, "big") + bytes(4) + width.to_bytes(2, "big") + height.to_bytes(2, "big")
                       + bytes(4))
        self.clients.append(client)

    def wait_for(self, pattern, seconds):
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            text = self.log.read_text(errors="replace") if self.log.exists() else ""
            if "wall: failed" in text or self.process.poll() is not None:
                raise RuntimeError(f"the guest ended:\n{text[-3000:]}\n{(self.folder / 'qemu.log').read_text()[-1000:]}")
            if found := re.search(pattern, text):
                return found[0]
            time.sleep(0.5)
        raise RuntimeError(f"no {pattern!r} within {seconds} s:\n{text[-3000:]}")

    def picture(self, head):
        """Returns (width, height, rows from the top as bytes of red, green, blue) of a head's scan-out."""
        file = self.folder / f"head{head}.ppm"
        self.ask("screendump", filename=str(file), device="card", head=head)
        magic, size, depth, pixels = file.read_bytes().split(b"\n", 3)
        assert magic == b"P6" and depth == b"255", (magic, depth)
        width, height = map(int, size.split())
        return width, height, pixels

    def stop(self):
        self.process.kill()
        self.process.wait()


def expected(head):
    """Returns the picture that test-wall draws."""
    bars = b"".join(bytes(255 * (bar >> bit & 1) for bit in range(3)) for bar in (8 * x // WIDTH for x in range(WIDTH)))
    squares = b"".join(b"\xff\xff\xff" if x // 32 % 2 == 0 and x // 32 < 2 * (head + 1) else bytes(3)
                       for x in range(WIDTH))
    return bars * (HEIGHT - 32) + squares * 32


def check_heads(machine):
    bad = []
    for head in range(HEADS):
        width, height, pixels = machine.picture(head)
        if (width, height) != (WIDTH, HEIGHT):
            bad.append(f"head {head} shows {width}x{height}")
        elif pixels != expected(head):
            wrong = sum(pixels[i:i + 3] != expected(head)[i:i + 3] for i in range(0, len(pixels), 3))
            bad.append(f"head {head}: {wrong} of {WIDTH * HEIGHT} pixels differ")
    return bad


def main(source, build, kept=None):
    if os.environ.get("CYCLORAMA_IMAGE_TESTS") != "1":
        print("heads: skipped, takes minutes; CYCLORAMA_IMAGE_TESTS=1 runs it")
        return 77
    if not shutil.which("qemu-system-x86_64"):
        print("heads: skipped, needs QEMU; scripts/install-packages image installs it")
        return 77
    with tempfile.TemporaryDirectory(dir="/var/tmp") as name:
        folder = pathlib.Path(name)
        kernel_folder = pathlib.Path(kept or folder / "kernel")
        kernel_folder.mkdir(parents=True, exist_ok=True)
        kernel, modules = fetch_kernel(kernel_folder)
        initrd = folder / "initrd"
        initrd.write_bytes(cpio(guest_files(pathlib.Path(build), modules)))
        machine = Machine(kernel, initrd, folder)
        try:
            print(machine.wait_for(r"wall: .*", STARTS_WITHIN_S))
            machine.connect()
            # Plugs in two projectors while the show runs.
            for head in range(1, HEADS):
                machine.resize(head, WIDTH, HEIGHT)
            print(machine.wait_for(r"wall: (.*Virtual-\d RHT){3}.*", STARTS_WITHIN_S))
            bad = check_heads(machine)
            print(machine.wait_for(rf"(pacing: head \d: .*\s+){{{HEADS}}}", STARTS_WITHIN_S))
        finally:
            machine.stop()
    print("\n".join(bad) or "heads: ok")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
