# SPDX-License-Identifier: Apache-2.0
"""Tests on a Debug image that keys, foreign devices and programs, and failing parts change nothing that the wall shows.

It tries keys, USB devices, an unsigned module, outgoing connections, a crash, a read-only /var, a missing TPM, and the
boot menu's factory reset.
"""
import collections
import pathlib
import re
import struct
import subprocess
import time

from appliance import Appliance
from appliance_boot import attract_pictures, computer, image_of, is_as, wait_for_pictures
from appliance_day import look
from disk_image import stick

START_S = 900
KEYS = ("ctrl alt delete", "ctrl alt f2", "alt f2", "alt sysrq b", "alt sysrq c", "alt sysrq e")
FOREIGN_DEVICES = ("usb-net", "usb-ccid")
# A module for computers without a watchdog, which is not needed here.
MODULE = "softdog"
WATCHDOG = ("-device", "i6300esb", "-action", "watchdog=reset")


def press(machine, keys):
    machine.ask("send-key", keys=[{"type": "qcode", "data": key} for key in keys.split()])


def check_keys(machine, reference, figures):
    """Presses keys as fast as possible: systemd reacts to seven times within two seconds."""
    began = machine.run("cat /proc/sys/kernel/random/boot_id; systemctl show -P MainPID cyclorama-display")[1]
    for keys in KEYS:
        for _ in range(8):
            press(machine, keys)
            time.sleep(0.15)
    time.sleep(20)
    after = machine.run("cat /proc/sys/kernel/random/boot_id; systemctl show -P MainPID cyclorama-display")[1]
    jobs = machine.run("systemctl list-jobs --no-legend")[1]
    figures["keys"] = len(KEYS)
    if began != after or "No jobs" not in jobs and jobs:
        figures["failed"].append(f"keys had an effect: {began!r}, then {after!r}; jobs: {jobs}")
    if not is_as(machine.picture(0), reference[0]):
        figures["failed"].append("keys changed the picture")


def check_usb(machine, figures):
    interfaces = "for i in /sys/bus/usb/devices/*:*; do echo $(cat $i/bInterfaceClass $i/authorized) $(basename $(readlink $i/driver || echo none)); done"
    before = machine.run(interfaces)[1].splitlines()
    for number, device in enumerate(FOREIGN_DEVICES):
        machine.ask("device_add", driver=device, id=f"foreign{number}", bus="usb.0")
    time.sleep(20)
    came = sorted((collections.Counter(machine.run(interfaces)[1].splitlines()) - collections.Counter(before)).elements())
    figures["strange_usb_interfaces"] = came
    for number, _ in enumerate(FOREIGN_DEVICES):
        machine.ask("device_del", id=f"foreign{number}")
    # The data interface of a serial adapter (0a) may be authorized: without its other interface no driver uses it.
    if len(came) < len(FOREIGN_DEVICES) or any(not re.match("0a . none|.. 0 none", line) for line in came):
        figures["failed"].append(f"foreign USB devices are used, or did not appear: {came}")


def without_signature(module):
    """Returns a module without its appended signature, the signature's kind and length in twelve bytes, and the
    marker."""
    end = module.rindex(b"~Module signature appended~\n")
    return module[:end - 12 - struct.unpack(">I", module[end - 4:end])[0]]


def check_modules(machine, options, folder, figures):
    """The kernel loads a module that Debian signed, but not the same one without its signature."""
    _, where = machine.run(f"modinfo -n {MODULE}")
    root = folder / "root"
    subprocess.run(["fsck.erofs", f"--extract={root}",
                    str(next(image_of(options, True).parent.glob("update/*.root.raw")))], check=True,
                   capture_output=True)
    signed = subprocess.run(["xz", "-dc", str(root / where.lstrip("/"))], check=True, capture_output=True).stdout
    (folder / "signed.ko").write_bytes(signed)
    (folder / "unsigned.ko").write_bytes(without_signature(signed))
    stick(folder / "modules.img", 40, {name: folder / name for name in ("signed.ko", "unsigned.ko")})
    machine.attach_stick(folder / "modules.img", "modules")
    machine.run("for i in $(seq 60); do [ -e /dev/disk/by-label/CYCLORAMA ] && break; sleep 1; done; mkdir -p /run/modules; mount -o ro /dev/disk/by-label/CYCLORAMA /run/modules", 120)
    figures["module"] = {name: machine.run(f"insmod /run/modules/{name}.ko; s=$?; rmmod {MODULE} 2>/dev/null; exit $s")
                         for name in ("unsigned", "signed")}
    machine.run("umount /run/modules")
    machine.ask("device_del", id="modules")
    figures["lockdown"] = machine.run("cat /sys/kernel/security/lockdown")[1]
    status, output = figures["module"]["unsigned"]
    if status == 0 or not re.search("rejected|not permitted",
                                    output) or figures["module"]["signed"][0] != 0 or "[integrity]" not in figures["lockdown"]:
        figures["failed"].append(f"modules: {figures['module']}; lockdown: {figures['lockdown']}")


def check_out(machine, figures):
    """Returns which users the packet filter refuses at once and which it lets through to a closed port of the host,
    which gives another error."""
    tries = {"root, a web server": ("root", 80), "root, a farm": ("root", 7401),
             "the display, a farm": ("cyclorama-display", 7401), "the tour, a farm": ("cyclorama-tour", 17401),
             "the tour, a mail server": ("cyclorama-tour", 25),
             "cyclorama-projectors, a projector": ("cyclorama-projectors", 4352)}
    figures["out"] = {}
    for what, (user, port) in tries.items():
        command = f"timeout 20 setpriv --reuid={user} --clear-groups bash -c 'exec 3<>/dev/tcp/10.0.2.2/{port}' 2>&1 | head -n 1"
        figures["out"][what] = machine.run(command)[1].rpartition(": ")[2]
    for what, (user, port) in tries.items():
        is_let_out = user in ("cyclorama-tour", "cyclorama-projectors") and port >= 1024
        # The filter answers "prohibited", which a program gets as no route.
        if figures["out"][what] != ("Connection refused" if is_let_out else "No route to host"):
            figures["failed"].append(f"out: {what}: {figures['out'][what]}")


def check_watchdog(machine, figures):
    figures["watchdog"] = machine.run("cat /sys/class/watchdog/watchdog0/identity /sys/class/watchdog/watchdog0/state; systemctl show -P RuntimeWatchdogUSec")[1].split("\n")
    if "active" not in figures["watchdog"]:
        figures["failed"].append(f"the watchdog is not used: {figures['watchdog']}")


def check_crash(machine, figures):
    """A service that crashes restarts, and its core is kept."""
    machine.run("systemctl kill -s SEGV cyclorama-tour")
    back = "for i in $(seq 90); do [ \"$(systemctl is-active cyclorama-tour)\" = active ] && [ \"$(systemctl show -P NRestarts cyclorama-tour)\" -ge 1 ] && break; sleep 1; done; systemctl is-active cyclorama-tour"
    active = machine.run(back, 300)[1]
    kept = machine.run("for i in $(seq 60); do coredumpctl list --no-legend --no-pager 2>/dev/null | grep -q present && break; sleep 1; done; coredumpctl list --no-legend --no-pager", 200)[1]
    figures["crash"] = {"tour": active, "kept": kept}
    if active != "active" or "/usr/bin/cyclorama-to" not in kept or "present" not in kept:
        figures["failed"].append(f"a crash: {figures['crash']}")


def check_read_only(machine, reference, figures):
    """Simulates a failing disk: ext4 then refuses all writes."""
    machine.run("for error in /sys/fs/ext4/*/trigger_fs_error; do echo tested >$error; done")
    time.sleep(20)
    report = machine.run("touch /var/lib/x; cyclorama doctor 2>&1", 120)[1]
    failed = machine.run("systemctl --failed --no-legend --plain | cut -d' ' -f1")[1].split()
    figures["read_only"] = {"reported": [line for line in report.splitlines() if "written" in line],
                            "failed_units": failed, "picture": is_as(machine.picture(0), reference[0])}
    if "cannot touch" not in report or not figures["read_only"]["reported"] or not figures["read_only"]["picture"]:
        figures["failed"].append(f"a failing disk: {figures['read_only']}; {report[:600]}")


def check_menu_reset(machine, reference, figures):
    """Selects the boot menu's factory reset for the next start, as its keys would."""
    _, listed = machine.run("bootctl list --json=short --no-pager", 60)
    entries = re.findall(r'"id" ?: ?"([^"]+)"', listed)
    resets = [entry for entry in entries if re.search(r"@\d|reset|forget", entry) and "auto" not in entry]
    figures["entries"] = entries
    if not resets:
        figures["failed"].append(f"the boot menu has no factory reset: {listed}")
        return
    machine.run(f"bootctl set-oneshot '{resets[-1]}'")
    machine.restart(START_S)
    left = machine.run("ls /var/lib/cyclorama/was-here; cat /run/cyclorama/var; cat /proc/cmdline")[1]
    figures["after_menu_reset"] = left
    if "No such file" not in left or "encrypted" not in left:
        figures["failed"].append(f"the boot menu's reset: {left}")
    if len(wait_for_pictures(machine, reference)) < 1:
        figures["failed"].append("no picture after the boot menu's reset")


def without_tpm(disk, reference, figures):
    """Removes the TPM and with it the key of /var: the show goes on, and the reason is reported."""
    machine = Appliance(disk, tpm=False)
    try:
        machine.wait_for_shell(START_S)
        figures["var"] = machine.run("cat /run/cyclorama/var")[1]
        figures["first_picture_s"] = wait_for_pictures(machine, reference)
        if "in memory" not in figures["var"] or not figures["first_picture_s"]:
            figures["failed"].append(f"without the TPM: {figures}")
    finally:
        machine.power_off()


def run(options, folder):
    figures = {"failed": []}
    reference = attract_pictures(options, folder)
    disk = computer(options, folder)
    machine = Appliance(disk, network="ipv4=on,ipv6=on", extra=WATCHDOG)
    try:
        machine.wait_for_shell(START_S)
        wait_for_pictures(machine, reference)
        machine.run("systemctl is-system-running --wait", START_S)
        look("keys", figures, check_keys, machine, reference)
        look("usb", figures, check_usb, machine)
        look("modules", figures, check_modules, machine, options, folder)
        look("out", figures, check_out, machine)
        look("watchdog", figures, check_watchdog, machine)
        look("crash", figures, check_crash, machine)
        machine.run("touch /var/lib/cyclorama/was-here; sync")
        look("read_only", figures, check_read_only, machine, reference)
        look("menu_reset", figures, check_menu_reset, machine, reference)
    finally:
        machine.power_off()
    look("without_tpm", figures, without_tpm, disk, reference)
    return figures
