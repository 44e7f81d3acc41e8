# SPDX-License-Identifier: Apache-2.0
"""Runs the checks of boot, security, provision and farm on one computer in one start (and one more after the factory
reset), since emulated starts take minutes."""
import time

import appliance_farm
import appliance_provision
import appliance_security
from appliance import HEADS, Appliance
from appliance_boot import attract_pictures, computer, difference, stages, wait_for_pictures

STEPS_S = 900


def look(name, figures, check, *arguments):
    """Runs one part and keeps its figures; a failure does not end the other parts."""
    figures[name] = {"failed": []}
    began = time.monotonic()
    try:
        check(*arguments, figures[name])
    except (RuntimeError, OSError) as error:
        figures[name]["failed"].append(f"broke off: {error}"[-1500:])
    figures[name]["seconds"] = round(time.monotonic() - began)
    figures["failed"] += [f"{name}: {what}" for what in figures[name]["failed"]]
    print(f"== {name}: {figures[name]}", flush=True)


def start(machine, reference, figures):
    machine.wait_for_shell(STEPS_S)
    figures["shell_s"] = round(machine.seconds(), 1)
    figures["first_picture_s"] = wait_for_pictures(machine, reference, 2 * STEPS_S)
    figures["difference"] = [difference(a, b) for a, b in zip(machine.heads(), reference)]
    machine.run("systemctl is-system-running --wait", STEPS_S)
    figures["stages"] = stages(machine.run("systemd-analyze --no-pager", 60)[1])
    figures["display_starts"] = machine.run("systemctl show -P NRestarts cyclorama-display")[1]
    figures["var"] = machine.run("cat /run/cyclorama/var")[1]
    if len(figures["first_picture_s"]) < HEADS:
        figures["failed"].append(f"no picture on every head: {figures['first_picture_s']}")


def reset(machine, reference, figures):
    machine.run("touch /var/lib/cyclorama/factory-reset")
    began = time.monotonic()
    machine.restart(STEPS_S)
    appliance_provision.check_reset(machine, figures)
    figures["first_picture_s"] = wait_for_pictures(machine, reference, 2 * STEPS_S)
    figures["since_reset_s"] = round(time.monotonic() - began)
    figures["display_starts"] = machine.run("systemctl show -P NRestarts cyclorama-display")[1]
    if len(figures["first_picture_s"]) < HEADS:
        figures["failed"].append(f"no picture on every head: {figures['first_picture_s']}")


def run(options, folder):
    figures = {"failed": []}
    reference = attract_pictures(options, folder)
    machine = Appliance(computer(options, folder), network="ipv4=on,ipv6=on",
                        extra=appliance_farm.wand_disk(options.programs, folder))
    try:
        look("start", figures, start, machine, reference)
        look("security", figures, appliance_security.look_at_running, machine)
        look("provision", figures, appliance_provision.check_sticks, machine, folder)
        look("farm", figures, appliance_farm.check, machine, options, folder)
        look("reset", figures, reset, machine, reference)
    finally:
        machine.power_off()
    return figures
