# SPDX-License-Identifier: Apache-2.0
"""Measures the time from the power button to a picture on every head."""
import pathlib
import re
import subprocess
import time

from appliance import HEADS, Appliance, Disk, difference, flashable, reference_pictures, save_png, wait_until

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURE_WITHIN_S = 900
MEAN_TOLERANCE = 1.5   # Code values; two rasterisers differ, and either may have 10 bits per primary.
MAX_TOLERANCE = 40  # At a blend's edge a pixel may belong to the neighbour.
LOOK_EVERY_S = 2
EVERY = 97  # Step in bytes; it is no multiple of three, so that all colours are compared.


def image_of(options, debug):
    folder = options.out / ("cyclorama-museum-debug" if debug else "cyclorama-museum")
    return flashable(folder)


def computer(options, folder):
    """Returns a computer with the Debug image: newly flashed, or with --computer as an earlier `boot --debug` left
    it."""
    before = Disk.kept(options.computer) if options.computer else None
    return before.copy(folder / "computer") if before else Disk(folder / "computer", image_of(options, True))


def attract_pictures(options, folder):
    """Draws the pictures of the image's own settings on each head without a farm, on this machine."""
    return reference_pictures(options.programs, ROOT / "demo/installation.toml", folder / "reference")


def is_as(picture, reference):
    """Returns whether a head shows the reference. The firmware lights heads too, with its logo and text."""
    if picture is None or picture[:2] != reference[:2]:
        return False
    pixels = list(zip(picture[2][::EVERY], reference[2][::EVERY]))
    return sum(abs(a - b) for a, b in pixels) <= MEAN_TOLERANCE * len(pixels)


def wait_for_pictures(machine, reference, seconds=PICTURE_WITHIN_S):
    """Returns {head: seconds after power on} of the attract picture."""
    first = {}
    deadline = time.monotonic() + seconds
    plugged = 1
    while len(first) < HEADS and time.monotonic() < deadline:
        if machine.process.poll() is not None:
            raise RuntimeError("QEMU ended:\n" + machine.console()[-2000:])
        for head, picture in enumerate(machine.heads()):
            if head not in first and is_as(picture, reference[head]):
                first[head] = round(machine.seconds(), 1)
        # Simulates projectors that wake after the computer: the others follow the first.
        if plugged < HEADS and plugged - 1 in first:
            machine.plug_in(plugged)
            plugged += 1
        time.sleep(LOOK_EVERY_S)
    return first


def stages(text):
    """Returns {stage: seconds} from systemd-analyze's line."""
    found = {name: value for value, name in re.findall(r"([\d.]+(?:min [\d.]+)?m?s) \((\w+)\)", text)}

    def seconds(word):
        minutes, _, rest = word.rpartition("min ")
        rest = float(rest[:-2]) / 1000 if rest.endswith("ms") else float(rest[:-1])
        return round(60 * float(minutes or 0) + rest, 2)
    return {name: seconds(value) for name, value in found.items()}


def emulated_slower(machine):
    """Returns how many times slower the emulated computer runs the same shell loop than this machine."""
    steps = 200000
    count = f"i=0; while [ $i -lt {steps} ]; do i=$((i+1)); done"
    began = time.monotonic()
    subprocess.run(["dash", "-c", count], check=True)
    here = time.monotonic() - began
    began = time.monotonic()
    machine.run(f"dash -c '{count}'", 600)
    return round((time.monotonic() - began) / here, 1)


def bare_start(image, folder):
    """Returns the seconds from power on until a Debian with only kernel and systemd prompts for a login."""
    machine = Appliance(Disk(folder, image), heads=1)
    try:
        wait_until(lambda: "login:" in machine.console(), PICTURE_WITHIN_S, "start of the bare Debian")
        return round(machine.seconds(), 1)
    finally:
        machine.power_off()


def run(options, folder):
    debug = options.debug
    disk = Disk(options.computer or folder / "computer", image_of(options, debug))
    reference = attract_pictures(options, folder)
    figures = {"failed": [], "starts": []}
    for start in ("first",) if options.quick else ("first", "second"):
        machine = Appliance(disk)
        try:
            first = wait_for_pictures(machine, reference)
            time.sleep(6)
            shown = machine.heads()
            differences = [difference(a, b) for a, b in zip(shown, reference)]
            for head, picture in enumerate(shown):
                if options.pictures and picture:
                    options.pictures.mkdir(parents=True, exist_ok=True)
                    save_png(picture, options.pictures / f"{start}-head{head}.png")
            account = {"start": start, "first_picture_s": first, "difference": differences}
            for head, found in enumerate(differences):
                if found is None or found[0] > MEAN_TOLERANCE or found[1] > MAX_TOLERANCE:
                    figures["failed"].append(f"{start} start: head {head} differs from the reference: {found}")
            if debug:
                account["security"] = "secure boot on" if "Secure boot enabled" in machine.run("dmesg | grep -i 'secure boot'")[1] else "?"
                machine.run("systemctl is-system-running --wait", PICTURE_WITHIN_S)
                account["stages"] = stages(machine.run("systemd-analyze --no-pager", 60)[1])
                begins = machine.run("systemctl show -P ExecMainStartTimestampMonotonic cyclorama-display")[1]
                # Measured from the kernel's start; the rest is graphics, which is emulated here.
                account["display_begins_s"] = round(int(begins) / 1e6, 1)
                account["emulated_slower"] = emulated_slower(machine)
                account["var"] = machine.run("cat /run/cyclorama/var")[1]
            figures["starts"].append(account)
            print(account, flush=True)
        finally:
            machine.power_off()
    last = figures["starts"][-1]
    figures["heads"] = len(last["first_picture_s"])
    figures["stages"] = last.get("stages", {}) | {f"picture on head {head}": seconds
                                                  for head, seconds in last["first_picture_s"].items()}
    bare = options.out / "bare/bare.raw"
    if bare.exists() and not options.quick:
        figures["bare_start_s"] = bare_start(bare, folder / "bare")
        figures["ratio"] = round(max(figures["starts"][-1]["first_picture_s"].values()) / figures["bare_start_s"], 2)
    return figures
