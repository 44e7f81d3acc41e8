# SPDX-License-Identifier: Apache-2.0
"""Tests that a firmware in setup mode takes our keys at the first start although nothing says that the computer is a
virtual one: neither the processor nor SMBIOS (DMTF DSP0134, 7.1)."""
import struct
import time

from appliance import Appliance, Disk
from appliance_boot import image_of

ENROLLED_WITHIN_S = 900
COUNTED = "Enrolling in"
DONE = "successfully enrolled"


def bios_information():
    """Returns an SMBIOS table of type 0 without the bit for virtual machines, which QEMU's own has."""
    uefi = 1 << 3
    table = struct.pack("<BBHBBHBBQBBBBBB", 0, 24, 0, 1, 2, 0xE800, 3, 0xFF, 1 << 3, 0, uefi, 1, 0, 0xFF, 0xFF)
    return table + b"Maker\0" + b"1.0\0" + b"06/15/2026\0" + b"\0"


def run(options, folder):
    figures = {"failed": []}
    tables = folder / "bios"
    tables.write_bytes(bios_information())
    machine = Appliance(Disk(folder / "computer", image_of(options, options.debug)), heads=0, processors=1,
                        extra=("-cpu", "max,hypervisor=off", "-smbios", f"file={tables}"))
    try:
        deadline = time.monotonic() + ENROLLED_WITHIN_S
        while DONE not in machine.console() and time.monotonic() < deadline and machine.process.poll() is None:
            time.sleep(1)
        figures["counted"] = COUNTED in machine.console()
        figures["enrolled"] = DONE in machine.console()
        figures["seconds"] = round(machine.seconds())
    finally:
        machine.power_off()
    if not figures["counted"] or not figures["enrolled"]:
        figures["failed"].append(f"the keys are not taken: {machine.console()[-800:]}")
    return figures
