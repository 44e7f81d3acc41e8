# SPDX-License-Identifier: Apache-2.0
"""Tests the whole show on the shipped image with only what a museum has: a stick, a USB camera, projectors, a network,
the operator page. Nobody is logged in, since nobody can be.

    farm on the host ◀───IPv6, TLS──┐          ┌──▶ three heads ──▶ screen dumps
                                    the image ─┤
    stick ──USB storage────────────▶│          └──▶ operator page, HTTPS and PIN ──▶ its reports
    rendered wand ──USB video──────▶│
"""
import pathlib
import re
import time

from appliance import HEADS, Appliance, Disk, flashable, reference_pictures
from appliance_boot import attract_pictures, wait_for_pictures
from appliance_farm import PICTURE_PX, SMALL, WANDS, check_farm_away, check_steering, is_live, keep_pictures, stick_of_farm, wait_for, wand_pictures
from host_farm import MUSEUM, HostFarm
from operator_page import OperatorPage
from usb_camera import UsbCamera

PAGE_PORT = 18443  # On the host's loopback; forwarded to the page's port.
PIN = "407319"
TRACKER = '[camera]\nkind = "v4l2"\n[detector]\nthreads = 1\n'
PER_SECOND = 5  # Pictures; an emulated processor finds the wand in fewer of them.
STEP_S = 900
YAW_WITHIN_DEG = 2.0


class Hand:
    """The hand that holds the wand before the camera."""

    def __init__(self, camera, pictures, page):
        self._camera, self._pictures, self._page = camera, pictures, page
        self._wand = None
        self.seen_deg = {}  # The yaw that the tracker reported for each wand.

    def show(self, wand):
        if self._wand:
            self.seen_deg[self._wand] = self._page.process("tracker").get("gauges", {}).get("yaw_deg")
        self._wand = wand
        self._camera.show(self._pictures[wand])


def wait(figures, what, condition, seconds=STEP_S):
    """Records the seconds until the condition holds; None is a failure, which is reported."""
    figures[what] = wait_for(condition, seconds)
    if figures[what] is None:
        figures["failed"].append(f"{what}: not within {seconds} s")
    print(f"{what}: {figures[what]}", flush=True)
    return figures[what] is not None


def plug_stick(machine, image, page, figures):
    """Plugs the stick in until the page can be opened with its PIN, then removes it."""
    machine.attach_stick(image, "stick")
    try:
        if not wait(figures, "page_s", lambda: page.museum().get("provisioning")):
            return False
    finally:
        machine.ask("device_del", id="stick")
    museum = page.museum()
    figures["settings"] = {name: museum["provisioning"].get(name) for name in ("verdict", "museum", "farm", "projectors", "has_pin", "problems")}
    print(figures["settings"], flush=True)
    if (figures["settings"]["verdict"], figures["settings"]["museum"], figures["settings"]["projectors"]) != ("installed", MUSEUM, HEADS):
        figures["failed"].append(f"the stick: {figures['settings']}")
    if museum["page"]["fingerprint"] != page.certificate:
        figures["failed"].append(f"the page's certificate is {page.certificate}, but it shows {museum['page']['fingerprint']}")
    # It may be restarting with its new settings.
    wait_for(lambda: figures.update(without_pin=page.without_pin("/museum")) or figures["without_pin"], STEP_S)
    if figures["without_pin"] != 401:
        figures["failed"].append(f"a client without the PIN gets {figures['without_pin']}")
    return True


def check_camera(camera, page, machine, reference, figures):
    """Unplugs the camera and plugs it in again, observed on the page; the show goes on."""
    camera.unplug()
    if wait(figures, "camera_gone_reported_s", lambda: "No pictures" in page.state("tracker")):
        figures["camera_gone"] = page.check("part-tracker")
        print(figures["camera_gone"], flush=True)
    figures["live_without_camera"] = is_live(machine, reference)
    if not figures["live_without_camera"]:
        figures["failed"].append("no live picture while the camera is away")
    camera.plug()
    wait(figures, "camera_back_s", lambda: page.state("tracker").startswith("Follows"))


def read_bundle(page, figures):
    """Checks the journal of this start in the page's support bundle, the only access to a computer without a shell."""
    bundle = page.support_bundle()
    journal = bundle.get("journal.txt", "")

    def first(pattern):
        found = re.search(pattern, journal)
        return found[0] if found else None
    figures["bundle"] = {"files": len(bundle), "secure_boot": first("Secure boot enabled"), "camera": first(r"Found UVC [\d.]+ device.*"),
                         "display_starts": len(re.findall("Started cyclorama-display.service", journal)),
                         "tracker_starts": len(re.findall("Started cyclorama-tracker.service", journal))}
    figures["version"] = next((line.split("=")[1] for line in bundle.get("versions.txt", "").splitlines() if line.startswith("IMAGE_VERSION")), None)
    print(figures["bundle"], figures["version"], flush=True)
    # One start by itself, one with the stick's settings.
    if figures["bundle"]["secure_boot"] is None or figures["bundle"]["display_starts"] != 2:
        figures["failed"].append(f"the journal of this start: {figures['bundle']}")


def check(machine, camera, page, options, folder, figures):
    """Tests a computer that shows the attract picture on three heads."""
    farm = HostFarm(options.programs, folder / "farm")
    farm.start()
    try:
        for head in range(HEADS):
            machine.plug_in(head, *SMALL)
            time.sleep(5)  # The guest's driver may miss the second of two at once.
        image = stick_of_farm(folder, farm, site=farm.site() + f"picture_width_px = {PICTURE_PX}\n", tracker=TRACKER, operator=f'pin = "{PIN}"\n')
        hand = Hand(camera, wand_pictures(options.programs, folder), page)
        hand.show("rest")
        if not plug_stick(machine, image, page, figures):
            return
        reference = reference_pictures(options.programs, folder / "installation.toml", folder / "small")
        wait(figures, "follows_s", lambda: page.state("tracker").startswith("Follows"))
        if not wait(figures, "live_s", lambda: is_live(machine, reference)):
            print(page.museum(), farm_logs(farm), flush=True)
            return
        keep_pictures(machine, options, "mission-live")
        check_steering(machine, hand.show, options, figures)
        check_camera(camera, page, machine, reference, figures)
        check_farm_away(machine, hand.show, farm, reference, figures)
        figures["yaw_deg"] = hand.seen_deg
        if any(seen is None or abs(seen - WANDS[wand][0]) > YAW_WITHIN_DEG for wand, seen in hand.seen_deg.items()):
            figures["failed"].append(f"the tracker reports other angles of the wand: {hand.seen_deg}")
        figures["page"] = {line["id"]: line["level"] for line in page.museum().get("checks", [])}
        print(figures["page"], figures["yaw_deg"], flush=True)
    finally:
        farm.stop()
        read_bundle(page, figures)


def farm_logs(farm):
    return "".join(path.read_text()[-1500:] for path in farm.folder.glob("*.log"))


def run(options, folder):
    figures = {"failed": []}
    folder = pathlib.Path(folder)
    reference = attract_pictures(options, folder)
    camera = UsbCamera(folder / "camera", 640, 480, PER_SECOND)
    page = OperatorPage(PAGE_PORT, PIN)
    machine = Appliance(Disk(folder / "computer", flashable(options.out / "cyclorama-museum")), extra=camera.options(),
                        network=f"ipv4=on,ipv6=on,hostfwd=tcp:127.0.0.1:{PAGE_PORT}-:8443")
    try:
        camera.plug()
        figures["first_picture_s"] = wait_for_pictures(machine, reference, 2 * STEP_S)
        print(figures["first_picture_s"], flush=True)
        keep_pictures(machine, options, "mission-attract")
        if wait(figures, "page_answers_s", lambda: page.without_pin("/museum") == 401) and page.museum():
            figures["failed"].append("the page is open before there is a PIN")
        if len(figures["first_picture_s"]) < HEADS:
            figures["failed"].append(f"no attract picture on every head: {figures['first_picture_s']}")
        else:
            check(machine, camera, page, options, folder, figures)
    finally:
        machine.power_off()
        camera.unplug()
    return figures
