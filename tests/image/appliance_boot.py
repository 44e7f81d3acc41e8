# SPDX-License-Identifier: Apache-2.0
"""From the power button to a picture on every head."""
import re
import time

from appliance import HEADS, Appliance, Disk, brightness, difference, flashable, reference_pictures, save_png

PICTURE_WITHIN_S = 900
MEAN_TOLERANCE = 1.5   # Code values: two rasterisers, and 10 bits per primary here or there.
GREATEST_TOLERANCE = 40  # At a blend's edge a pixel may fall to the neighbour.
LOOK_EVERY_S = 2


def image_of(options, debug):
    folder = options.out / ("cyclorama-museum-debug" if debug else "cyclorama-museum")
    return flashable(folder)


def is_lit(picture):
    return picture is not None and brightness(picture) > 2


def wait_for_pictures(machine, seconds=PICTURE_WITHIN_S):
    """{head: seconds after power on} of the first picture on each."""
    first = {}
    deadline = time.monotonic() + seconds
    plugged = False
    while len(first) < HEADS and time.monotonic() < deadline:
        if machine.process.poll() is not None:
            raise RuntimeError("QEMU ended:\n" + machine.console()[-2000:])
        for head, picture in enumerate(machine.heads()):
            if head not in first and is_lit(picture):
                first[head] = round(machine.seconds(), 1)
        # A projector that wakes after the computer: the others follow the first.
        if first and not plugged:
            machine.plug_in()
            plugged = True
        time.sleep(LOOK_EVERY_S)
    return first


def stages(text):
    """{stage: seconds} from systemd-analyze's line."""
    found = {name: value for value, name in re.findall(r"([\d.]+(?:min [\d.]+)?m?s) \((\w+)\)", text)}

    def seconds(word):
        minutes, _, rest = word.rpartition("min ")
        rest = float(rest[:-2]) / 1000 if rest.endswith("ms") else float(rest[:-1])
        return round(60 * float(minutes or 0) + rest, 2)
    return {name: seconds(value) for name, value in found.items()}


def run(options, folder):
    debug = options.debug
    disk = Disk(folder / "computer", image_of(options, debug))
    reference = reference_pictures(options.programs, options.out.parent / "source/demo/installation.toml"
                                   if (options.out.parent / "source/demo").exists() else "demo/installation.toml", folder / "reference")
    figures = {"failed": [], "starts": []}
    for start in ("first",) if options.quick else ("first", "second"):
        machine = Appliance(disk)
        try:
            first = wait_for_pictures(machine)
            time.sleep(6)
            shown = machine.heads()
            differences = [difference(a, b) for a, b in zip(shown, reference)]
            for head, picture in enumerate(shown):
                if options.pictures and picture:
                    options.pictures.mkdir(parents=True, exist_ok=True)
                    save_png(picture, options.pictures / f"{start}-head{head}.png")
            account = {"start": start, "first_picture_s": first, "difference": differences}
            for head, found in enumerate(differences):
                if found is None or found[0] > MEAN_TOLERANCE or found[1] > GREATEST_TOLERANCE:
                    figures["failed"].append(f"{start} start: head {head} is not as drawn here: {found}")
            if debug:
                account["security"] = "secure boot on" if "Secure boot enabled" in machine.run("dmesg | grep -i 'secure boot'")[1] else "?"
                account["stages"] = stages(machine.run("systemd-analyze --no-pager", 60)[1])
                account["var"] = machine.run("cat /run/cyclorama/var")[1]
            figures["starts"].append(account)
            print(account, flush=True)
        finally:
            machine.power_off()
    return figures
