# SPDX-License-Identifier: Apache-2.0
"""Tests updates from a stick on the Debug image: a bad one uses up its attempts, is rolled back and reported; a good
one is tried and stays; a power cut at any moment of the good one leaves a computer that starts. It needs a newer
version under OUT/next (image/build --debug --version V --out OUT/next)."""
import concurrent.futures
import random
import re
import shutil
import subprocess
import time

from appliance import HEADS, Appliance
from appliance_boot import computer
from appliance_cuts import cut_while, what_is_whole
from appliance_tamper import flip_bit
from disk_image import stick

STICK_MB = 700
START_S = 900
BACK_S = 2400  # Three attempts that end in a kernel panic, and the start of the previous version.
UPDATED_S = 900
GOOD_S = 900
AT_A_TIME = 2
REPORT = "cat /var/lib/cyclorama/update.json 2>/dev/null; true"


def signed(folder, keys):
    """Writes the manifest as image/build does."""
    names = sorted(path.name for path in folder.iterdir() if not path.name.startswith("SHA256SUMS"))
    sums = subprocess.run(["sha256sum", *names], cwd=folder, check=True, capture_output=True).stdout
    (folder / "SHA256SUMS").write_bytes(sums)
    subprocess.run(["openssl", "dgst", "-sha256", "-sign", str((keys / "update.key").resolve()), "-out",
                    "SHA256SUMS.sig", "SHA256SUMS"], cwd=folder, check=True)


def stick_of(update, file):
    stick(file, STICK_MB, {f"update/{path.name}": path for path in update.iterdir()})
    return file


def bad_version(update, folder, options):
    """Makes an update with a flipped bit in root, properly signed, as a broken build would be."""
    shutil.copytree(update, folder)
    (kernel,) = folder.glob("*.efi")
    name = re.search(r"_([\d.]+)\.efi", kernel.name)[1]
    bad = name.rpartition(".")[0] + f".{int(name.rpartition('.')[2]) - 1}"
    for file in list(folder.iterdir()):
        file.rename(folder / file.name.replace(f"_{name}", f"_{bad}"))
    (root,) = folder.glob("*.root.raw")
    flip_bit(root, 1024 + 5)
    signed(folder, options.keys)
    return bad


def version(machine):
    return machine.run(". /etc/os-release; echo $IMAGE_VERSION")[1]


def started(disk):
    # Nothing here waits for a picture; two emulated processors that share a real one wait for each other.
    machine = Appliance(disk, processors=1)
    try:
        machine.wait_for_shell(START_S)
    except Exception:
        machine.power_off()
        raise
    return machine


def wait_for_report(machine, word, seconds):
    """Waits until the updater's report contains `word` and returns it."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if word in (report := machine.run(REPORT)[1]):
            return report
        time.sleep(2)
    return f"no '{word}' within {seconds} s, but {report!r}"


def after_cut(disk, folder):
    """Starts a computer after a power cut and returns its report."""
    account = {}
    began = time.monotonic()
    try:
        machine = started(disk.copy(folder))
        try:
            account |= {"version": version(machine), "var": machine.run("cat /run/cyclorama/var")[1]}
        finally:
            machine.power_off()
    except RuntimeError as error:
        account["failed"] = str(error)[-800:]
    account["start_s"] = round(time.monotonic() - began)
    shutil.rmtree(folder)
    print(account, flush=True)
    return account


def check_bad(machine, image, old, bad, figures):
    machine.attach_stick(image, "bad")
    print(wait_for_report(machine, "ready", UPDATED_S), flush=True)
    machine.ask("device_del", id="bad")
    before = machine.console().count("Kernel panic")
    machine.restart(BACK_S)
    figures["boots"] += 1
    figures["tries_of_the_bad_one"] = machine.console().count("Kernel panic") - before
    report = wait_for_report(machine, "rolled-back", GOOD_S)
    print(report, flush=True)
    if version(machine) == old and figures["tries_of_the_bad_one"] > 0 and bad in report and "rolled-back" in report:
        figures["rollbacks"] += 1
    else:
        figures["failed"].append(f"the bad update: {version(machine)} runs after {figures['tries_of_the_bad_one']} panics; {report}")


def check_good(machine, image, old, folder, options, figures, ret_states):
    """Installs the good update. `ret_states` receives the states after power cuts."""
    machine.attach_stick(image, "good")
    ret_states += cut_while(lambda: "ready" not in machine.run(REPORT)[1], machine, folder, options.cuts,
                            random.Random(8))
    print(machine.run(REPORT)[1], f"{len(ret_states)} cuts", flush=True)
    machine.ask("device_del", id="good")
    machine.restart(START_S)
    figures["boots"] += 1
    now = version(machine)
    for head in range(1, HEADS):
        machine.plug_in(head)
        time.sleep(5)
    # The health check gives it all its attempts back.
    stays = "at=$(bootctl -p)/EFI/Linux; for i in $(seq 60); do ls $at | grep -q '%s+3\\.efi' && break; sleep 10; done; ls $at; cat /run/cyclorama/health" % now.replace(".", "\\.")
    _, kernels = machine.run(stays, GOOD_S)
    print(kernels, flush=True)
    if now != old and re.search(rf"_{re.escape(now)}\+3\.efi", kernels):
        figures["updates"] += 1
    else:
        figures["failed"].append(f"the good update: {now} runs; {kernels}")


def check_cuts(states, updates, old, folder, options, figures):
    """Checks that after each cut the running version is intact, and the other one too if the loader would start it.
    Starts all or some of them."""
    figures["power_cuts"], figures["cuts"], figures["started_after_cut"] = len(states), [], 0
    for after_s, disk in states:
        figures["cuts"].append({"after_s": after_s, "whole": what_is_whole(disk, updates, folder)})
        print(figures["cuts"][-1], flush=True)
    count = len(states) if options.starts is None else min(len(states), options.starts)
    chosen = [int((number + 0.5) * len(states) / count) for number in range(count)]
    with concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
        for number, account in zip(chosen, pool.map(lambda at: after_cut(states[at][1], folder / f"start-{at}"),
                                                    chosen)):
            figures["cuts"][number] |= account
            figures["boots"] += account.get("version") in updates
            figures["started_after_cut"] += account.get("version") in updates
    for cut in figures["cuts"]:
        if not cut["whole"].get(old) or not all(cut["whole"].values()) or ("start_s" in cut and cut.get("version") not in updates):
            figures["failed"].append(f"power cut after {cut['after_s']} s of an update: {cut}")


def run(options, folder):
    figures = {"updates": 0, "power_cuts": 0, "boots": 0, "rollbacks": 0, "failed": []}
    update = options.out / "next/cyclorama-museum-debug/update"
    bad = bad_version(update, folder / "bad", options)
    bad_stick = stick_of(folder / "bad", folder / "bad.img")
    shutil.rmtree(folder / "bad")
    good_stick = stick_of(update, folder / "good.img")
    old = machine = None

    def whole(what, check):
        """Runs one update; if it fails, the other one is still tested, on a computer in the original state."""
        nonlocal machine, old
        try:
            if machine is None:
                machine = started(computer(options, folder / what))
                figures["boots"] += 1
                old = version(machine)
            check()
        except (RuntimeError, OSError) as error:
            figures["failed"].append(f"{what} update failed: {error}"[-1500:])
            print(figures["failed"][-1], flush=True)
            if machine is not None:
                machine.power_off()
            machine = None

    whole("bad", lambda: check_bad(machine, bad_stick, old, bad, figures))
    states = []
    whole("good", lambda: check_good(machine, good_stick, old, folder, options, figures, states))
    new = re.search(r"_([\d.]+)\.efi", next(update.glob("*.efi")).name)[1]
    if machine is not None:
        machine.power_off()
    check_cuts(states, {old: options.out / "cyclorama-museum-debug/update", new: update}, old, folder, options, figures)
    return figures
