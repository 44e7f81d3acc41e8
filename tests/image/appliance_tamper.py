# SPDX-License-Identifier: Apache-2.0
"""Tests that nothing that was changed after signing starts: no picture, and firmware, loader or kernel report the
reason."""
import concurrent.futures
import re
import shutil
import subprocess
import time

from appliance import Appliance, Disk
from appliance_boot import attract_pictures, image_of, is_as, wait_for_pictures
from disk_image import BootPartition, place_of, partitions

TIMEOUT_FACTOR = 3.0  # No picture after so many times the duration of an untouched start means that it does not start.
MIN_S = 120
AT_A_TIME = 2
UNTOUCHED_S = 300  # Used if no start was measured: --computer has its keys from an earlier start.
AFTERWARDS_S = 30  # Seconds after the first report.


def flip_bit(image, offset, bit=3):
    with open(image, "r+b") as file:
        file.seek(offset)
        byte = file.read(1)[0]
        file.seek(offset)
        file.write(bytes([byte ^ 1 << bit]))


def root_of(image):
    return next(label for _, label, _, _ in partitions(image) if label.startswith("root_"))


def change_kernel(image, folder, change):
    """Rewrites the unified kernel image by change(bytes) -> bytes."""
    esp = BootPartition(image)
    (name,) = [name for name in esp.names("/EFI/Linux") if name.endswith(".efi")]
    file = folder / "kernel.efi"
    esp.read(f"/EFI/Linux/{name}", file)
    changed = change(file.read_bytes())
    file.write_bytes(changed)
    esp.write(file, f"/EFI/Linux/{name}")


def without_signature(kernel):
    """Removes the signature of a PE32+ file: its certificate table is the fifth data directory."""
    pe = int.from_bytes(kernel[0x3C:0x40], "little")
    entry = pe + 24 + 112 + 4 * 8
    at = int.from_bytes(kernel[entry:entry + 4], "little")
    return kernel[:entry] + bytes(8) + kernel[entry + 8:at]


def other_command_line(kernel):
    assert kernel.count(b"lockdown=integrity") >= 1
    return kernel.replace(b"lockdown=integrity", b"lockdown=________y")


def replaced_root_hash(kernel):
    found = re.search(rb"roothash=([0-9a-f]{64})", kernel)
    other = found[1][::-1]
    return kernel.replace(found[1], other)


CASES = {
    "a bit of root's first block": lambda image, folder: flip_bit(image, place_of(image, root_of(image))[0] + 1024 + 5),
    "a bit of root's hashes": lambda image,
    folder: flip_bit(image, place_of(image, root_of(image).replace("root_", "verity_"))[0] + 4096 + 7),
    "a kernel image without its signature": lambda image, folder: change_kernel(image, folder, without_signature),
    "another command line": lambda image, folder: change_kernel(image, folder, other_command_line),
    "another root hash": lambda image, folder: change_kernel(image, folder, replaced_root_hash),
}
# Messages that a good start never prints; it does print "failed" and "error" now and then.
REASON = re.compile(r"device-mapper: verity: [^\r\n]*corrupt\w*|Kernel panic[^\r\n]*|Security Violation|Access [Dd]enied|Bad [Ss]ignature|"
                    r"Error (?:loading|preparing|starting)[^\r\n]{0,80}|Image verification failed")


def watch(machine, reference, seconds):
    """Returns (the reported reason, whether the show started nevertheless)."""
    end = time.monotonic() + seconds
    is_shown = False
    is_said = False
    while time.monotonic() < end and not is_shown:
        is_shown = is_as(machine.heads()[0], reference)
        if not is_said and REASON.search(machine.console()):
            is_said = True
            end = min(end, time.monotonic() + AFTERWARDS_S)
        time.sleep(2)
    return sorted({found[0].strip() for found in REASON.finditer(machine.console())})[:4], is_shown


def run(options, folder):
    image = image_of(options, options.debug)
    reference = attract_pictures(options, folder)
    untouched_s = UNTOUCHED_S
    disk = Disk.kept(options.computer) if options.computer else None
    if disk is None:
        disk = Disk(folder / "untouched", image)
        machine = Appliance(disk)
        try:
            # The firmware has the keys from now on.
            first = wait_for_pictures(machine, reference)
        finally:
            machine.power_off()
        untouched_s = min(first.values())
        print(f"untouched: a picture after {untouched_s} s, including the enrolment of the keys")
    cases = dict(list(CASES.items())[:2] if options.quick else CASES)
    figures = {"cases": len(cases), "refused": 0, "untouched_s": untouched_s, "reasons": {}, "failed": []}

    def look(name):
        """Yields (case, the reported reason, whether the show started nevertheless)."""
        case = folder / f"case-{list(cases).index(name)}"
        case.mkdir()
        changed = case / "image.raw"
        # The file is sparse: most of it is holes.
        subprocess.run(["cp", "--sparse=always", image, changed], check=True)
        cases[name](changed, case)
        other = Disk(case / "computer", changed)
        shutil.copy(disk.folder / "vars.fd", other.folder / "vars.fd")
        machine = Appliance(other)
        try:
            reason, is_shown = watch(machine, reference[0], max(MIN_S, TIMEOUT_FACTOR * untouched_s))
        finally:
            machine.power_off()
        print(f"{name}: {reason if reason and not is_shown else 'NOT REFUSED'} ({machine.seconds():.0f} s)", flush=True)
        shutil.rmtree(case)
        return name, reason, is_shown

    with concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
        for name, reason, is_shown in pool.map(look, cases):
            refused = bool(reason) and not is_shown
            figures["refused"] += refused
            figures["reasons"][name] = reason
            if not refused:
                figures["failed"].append(f"{name}: {'the show started' if is_shown else 'no reason was reported'}; {reason}")
    return figures
