# SPDX-License-Identifier: Apache-2.0
"""Tests an update from the farm on the Debug image: a coordinator on the host offers the version under OUT/next (see
appliance_update.py); the museum's computer checks on request, fetches it over IPv6 and TLS, writes it beside the
running one, and starts it."""
import re
import time

from appliance import Appliance
from appliance_boot import computer
from appliance_farm import stick_of_farm
from appliance_update import START_S, version
from host_farm import HostFarm

FETCHED_S = 3600
ATTEMPTS = 8
IMAGE = "cyclorama-museum-debug"


def run(options, folder):
    figures = {"failed": []}
    update = options.out / "next" / IMAGE / "update"
    (folder / "store").mkdir()
    (folder / "store" / IMAGE).symlink_to(update.resolve())
    wanted = re.search(r"_([\d.]+)\.efi", next(update.glob("*.efi")).name)[1]
    farm = HostFarm(options.programs, folder / "farm", more=f'updates.folder = "{folder}/store"\n')
    farm.start()
    machine = Appliance(computer(options, folder), network="ipv4=on,ipv6=on", processors=1)
    try:
        machine.wait_for_shell(START_S)
        machine.run("systemctl is-system-running --wait", START_S)  # A first start reports on settings of its own.
        old = version(machine)
        if not machine.plug_stick(stick_of_farm(folder, farm), "farm"):
            figures["failed"].append("the stick was not checked")
        # The page restarts with new settings.
        machine.run("for i in $(seq 300); do [ -d /run/cyclorama-requests ] && break; sleep 1; done; sleep 5", 400)
        began = time.monotonic()
        # Repeated as in each hour of a night: a busy emulated computer misses the farm's pings and resumes where it
        # was.
        for figures["attempts"] in range(1, ATTEMPTS + 1):
            status, output = machine.run(f"cyclorama update --wait {FETCHED_S}", FETCHED_S + 60)
            print(output, flush=True)
            if status == 0 and f"{wanted} is installed" in output:
                break
        else:
            figures["failed"].append(f"cyclorama update: {status}, {output}; " + machine.run("journalctl -b -o cat --no-pager -u 'cyclorama-*update*' | tail -n 30")[1])
        figures["fetched_and_written_s"] = round(time.monotonic() - began)
        # Waits until the dark heads were recorded for the trial.
        _, left = machine.run("cd /var/lib/cyclorama-update; for i in $(seq 120); do [ -e offer ] || break; sleep 1; done; ls", 240)
        if "offer" in left:
            figures["failed"].append(f"the fetched files are still there: {left}")
        machine.restart(START_S)
        figures["version"], figures["before"] = version(machine), old
        if figures["version"] != wanted:
            figures["failed"].append(f"{figures['version']} runs instead of {wanted}")
        print(figures, flush=True)
    finally:
        machine.power_off()
        farm.stop()
    return figures
