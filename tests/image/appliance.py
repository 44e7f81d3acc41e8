# SPDX-License-Identifier: Apache-2.0
"""A museum's computer for tests: QEMU without KVM, UEFI with Secure Boot, a TPM, three heads and a flashed disk."""
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import threading
import time

from heads_test import Machine

OVMF = pathlib.Path("/usr/share/OVMF")
HEADS = 3
WIDTH, HEIGHT = 640, 480
DISK_GB = 6


class Disk:
    """The parts that keep their state without power: the disk (a layer over the image), the firmware's variables, the
    TPM."""

    def __init__(self, folder, image, size_gb=DISK_GB):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.file = self.folder / "disk.qcow2"
        subprocess.run(["qemu-img", "create", "-q", "-f", "qcow2", "-b", str(pathlib.Path(image).resolve()), "-F",
                        "raw", str(self.file), f"{size_gb}G"], check=True)
        shutil.copy(OVMF / "OVMF_VARS_4M.fd", self.folder / "vars.fd")
        (self.folder / "tpm").mkdir()

    @classmethod
    def kept(cls, folder):
        """Returns the disk that an earlier test left in this folder, or None."""
        if not (pathlib.Path(folder) / "disk.qcow2").exists():
            return None
        disk = object.__new__(cls)
        disk.folder = pathlib.Path(folder)
        disk.file = disk.folder / "disk.qcow2"
        return disk

    def copy(self, folder):
        """Returns another computer in the same state."""
        other = object.__new__(Disk)
        other.folder = pathlib.Path(folder)
        shutil.copytree(self.folder, other.folder,
                        ignore=shutil.ignore_patterns("*.log", "qmp", "vnc*", "serial", "tpm.sock", "*.ppm"))
        other.file = other.folder / "disk.qcow2"
        return other


class Appliance(Machine):
    """A running computer."""

    def __init__(self, disk, tpm=True, secure=True, heads=HEADS, memory_mb=2048, network="restrict=on", extra=(),
                 processors=2, log=None):
        self.folder = disk.folder
        self.disk = disk
        self.log = self.folder / "serial.log"
        self.clients = []
        self.began = time.monotonic()
        self.tpm = None
        for name in ("serial", "qmp", "tpm.sock", *(f"vnc{head}" for head in range(heads))):
            (self.folder / name).unlink(missing_ok=True)
        self.log.unlink(missing_ok=True)
        tpm_options = []
        if tpm:
            # Started for each run of the computer, since it ends with QEMU.
            self.tpm = subprocess.Popen(["swtpm", "socket", "--tpm2", "--tpmstate", f"dir={self.folder}/tpm", "--ctrl",
                                         f"type=unixio,path={self.folder}/tpm.sock", "--terminate"],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            tpm_options = ["-chardev", f"socket,id=tpm,path={self.folder}/tpm.sock", "-tpmdev",
                           "emulator,id=tpm0,chardev=tpm", "-device", "tpm-crb,tpmdev=tpm0"]
            wait_until(lambda: (self.folder / "tpm.sock").exists(), 20, "swtpm")
        code = "OVMF_CODE_4M.secboot.fd" if secure else "OVMF_CODE_4M.fd"
        command = ["qemu-system-x86_64", "-machine", "q35,smm=on", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp",
                   str(processors), "-m", str(memory_mb),
                   "-nodefaults", "-global", "driver=cfi.pflash01,property=secure,value=on", "-global",
                   "ICH9-LPC.disable_s3=1", "-drive", f"if=pflash,unit=0,format=raw,readonly=on,file={OVMF / code}",
                   "-drive", f"if=pflash,unit=1,format=raw,file={self.folder}/vars.fd",
                   *self._drive(disk, log), "-device", "virtio-blk-pci,drive=disk,bootindex=1",
                   "-netdev", f"user,id=net,{network}", "-device", "virtio-net-pci,netdev=net,romfile=",
                   "-device", "qemu-xhci,id=usb",
                   "-chardev", f"socket,id=serial,path={self.folder}/serial,server=on,wait=off,logfile={self.log}",
                   "-serial", "chardev:serial",
                   "-qmp", f"unix:{self.folder}/qmp,server=on,wait=off", *tpm_options, *extra]
        if heads:
            command += ["-device", f"virtio-gpu-pci,id=card,max_outputs={heads},xres={WIDTH},yres={HEIGHT}"]
        for head in range(heads):
            command += ["-vnc", f"unix:{self.folder}/vnc{head},display=card,head={head}"]
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=open(self.folder / "qemu.log", "w"))
        wait_until(lambda: (self.folder / "qmp").exists() or self.process.poll() is not None, 30, "QEMU")
        if self.process.poll() is not None:
            raise RuntimeError((self.folder / "qemu.log").read_text()[-2000:])
        self.connect()
        self.shell = None
        self.heard = b""
        self.seen = 0  # Position in the console after the output of earlier starts.

    @staticmethod
    def _drive(disk, log):
        """Returns QEMU's options for the disk. With `log`, a file for write_log.WriteLog, its writes are kept there."""
        if log is None:
            return ["-drive", f"if=none,id=disk,format=qcow2,file={disk.file},cache=writeback"]
        pathlib.Path(log).write_bytes(b"")
        return ["-blockdev", f"driver=qcow2,node-name=content,file.driver=file,file.filename={disk.file}", "-blockdev",
                f"driver=file,node-name=log,filename={log}", "-blockdev",
                "driver=blklogwrites,node-name=disk,file=content,log=log,log-super-update-interval=1"]

    def seconds(self):
        return time.monotonic() - self.began

    def plug_in(self, head, width=WIDTH, height=HEIGHT):
        """Plugs a projector into a head by a VNC client that requests a size; the first head has one from the start.
        Plug in one after the other: the guest's driver may miss the second of two at once."""
        self.resize(head, width, height)

    def attach_stick(self, image, name):
        self.ask("blockdev-add", driver="raw", **{"node-name": name, "read-only": True},
                 file={"driver": "file", "filename": str(image)})
        self.ask("device_add", driver="usb-storage", id=name, bus="usb.0", drive=name, removable=True)

    def plug_stick(self, image, name, seconds=180):
        """Plugs a stick in until its settings were checked. Returns True if the report was updated."""
        report = "stat -c %y /var/lib/cyclorama/provisioning.json 2>/dev/null || echo none"
        before = self.run(report)[1]
        self.attach_stick(image, name)
        deadline = time.monotonic() + seconds
        while (has_come := self.run(report)[1] != before) is False and time.monotonic() < deadline:
            time.sleep(1)
        self.ask("device_del", id=name)
        # A person takes seconds to change sticks.
        self.run("for i in $(seq 60); do [ -e /dev/disk/by-label/CYCLORAMA ] || break; sleep 1; done; sleep 5", 120)
        return has_come

    def hmp(self, command):
        """Returns the answer of QEMU's monitor."""
        return self.ask("human-monitor-command", **{"command-line": command})

    def heads(self):
        """Returns [(width, height, pixels) or None]: the current picture of each head."""
        shown = []
        for head in range(HEADS):
            try:
                shown.append(self.picture(head))
            except (RuntimeError, FileNotFoundError):
                shown.append(None)
        return shown

    def _listen(self):
        """Reads the serial port all the time: if nobody reads it, the kernel's messages block the computer."""
        try:
            while data := self.shell.recv(65536):
                self.heard += data
        except OSError:
            pass

    def run(self, command, seconds=60):
        """Returns (exit status, output) of a command in the Debug image's shell on the serial port."""
        if self.shell is None:
            self.shell = socket.socket(socket.AF_UNIX)
            self.shell.connect(str(self.folder / "serial"))
            threading.Thread(target=self._listen, daemon=True).start()
        self.commands = getattr(self, "commands", 0) + 1
        # The echo of the input must not look like the end of the output.
        begin, end = f"<<{self.commands}", f"{self.commands}>>"
        self.heard = b""
        typed = f"printf '<%s\\n' '<{self.commands}'; ( {command} ) 2>&1; printf '\\n%s>> %d\\n' {self.commands} $?\n"
        self.shell.sendall(typed.encode())
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            time.sleep(0.05)
            text = self.heard.decode(errors="replace")
            if found := re.search(rf"{begin}\r?\n(.*?)\r?\n{end} (\d+)", text, re.S):
                return int(found[2]), found[1].replace("\r", "").strip("\n")
            if self.process.poll() is not None:
                break
        raise RuntimeError(f"'{command}' did not end within {seconds} s:\n{text[-2000:]}")

    def restart(self, seconds):
        """Restarts the computer by its own command and waits for the shell."""
        self.run("sync")
        self.seen = len(self.console())
        self.shell.sendall(b"systemctl reboot\n")
        return self.wait_for_shell(seconds)

    def wait_for_shell(self, seconds):
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            # Only the output since the firmware's newest start; the line also carried that of earlier ones.
            _, began, data = self.console()[self.seen:].rpartition("BdsDxe: starting")
            if began and "debug#" in data:
                try:
                    # Silences the kernel's and systemd's messages, which would mix with a command's output on this
                    # line.
                    return self.run("kill -s RTMIN+21 1; dmesg -n 1", 60)
                except RuntimeError:
                    continue
            time.sleep(1)
        raise RuntimeError(f"no shell within {seconds} s:\n{self.console()[-3000:]}")

    def console(self):
        return self.log.read_text(errors="replace") if self.log.exists() else ""

    def power_off(self):
        """Switches the computer off as if its power cable were pulled."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        if self.tpm:
            try:
                self.tpm.wait(10)
            except subprocess.TimeoutExpired:
                self.tpm.kill()
                self.tpm.wait()
        for client in self.clients:
            client.close()

    stop = power_off


def flashable(folder):
    """Returns the disk image in a result of image/build, beside which is an image of only the boot partition."""
    (raw,) = (path for path in folder.glob("*.raw") if not path.name.endswith(".esp.raw"))
    return raw


def wait_until(condition, seconds, what):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.1)
    raise RuntimeError(f"no {what} within {seconds} s")


def shared_picture(file):
    """Returns (width, height, pixels) of a picture that a display published (drivers/output/shared_picture.cpp), or
    None."""
    data = file.read_bytes()
    magic, version, width, height, _, _, published = struct.unpack_from("<8sIIIIQQ", data)
    if magic != b"CYCPICT1" or version != 1 or published == 0:
        return None
    words = (width * height * 3 + 7) // 8
    start = 40 + 32 + published % 2 * 8 * words
    return width, height, data[start:start + width * height * 3]


def reference_pictures(programs, installation, folder, names=("left", "middle", "right"), seconds=60):
    """Returns the pictures of the same settings without a farm, drawn by this machine's EGL."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    display = subprocess.Popen([str(pathlib.Path(programs) / "cyclorama-display"), "--output", "headless",
                                "--installation", str(installation),
                                "--tour", "[::1]:1", "--listen", "[::1]:0", "--run-dir", str(folder)],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        files = [folder / f"head-{name}.picture" for name in names]
        wait_until(lambda: all(file.exists() and shared_picture(file) for file in files), seconds, "reference picture")
        time.sleep(3)
        return [shared_picture(file) for file in files]
    finally:
        display.terminate()
        display.wait(10)


def difference(one, other):
    """Returns the (mean, largest) difference of two pictures in code values, or None if their sizes differ."""
    if one is None or other is None or one[:2] != other[:2]:
        return None
    differences = [abs(a - b) for a, b in zip(one[2], other[2])]
    return sum(differences) / len(differences), max(differences)


def save_png(picture, file):
    """Converts a PPM with ImageMagick."""
    ppm = file.with_suffix(".ppm")
    ppm.write_bytes(b"P6 %d %d 255\n" % picture[:2] + picture[2])
    subprocess.run(["convert", str(ppm), str(file)], check=True)
    os.unlink(ppm)
