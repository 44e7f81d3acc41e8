#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Walks the installer's way in headless Chromium, from a computer without a PIN to a running visit: on a phone of 360 px,
with a second person at a computer who changes the same step. The projectors, the camera and systemd are simulated; the page,
the check of settings, cyclorama-network, the farm, the tour, the display and the tracker are real. axe-core looks at every
step. CYCLORAMA_SCREENSHOTS=FOLDER keeps a picture of each step.

Run: install_test.py SOURCE_ROOT BUILD_FOLDER [--json FILE]       It is skipped (77) without chromedriver.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time

from farm.processes import Process, free_port, wait_until
from operator_page_test import DESKTOP, PHONE, SKIPPED, Browser, fits
from page_accessibility_test import Axe, tab_stops

PIN = "86420975"
TRIANGLES = 20000
# What the page cannot do: somebody at a computer with a shell has to.
NEEDS_SHELL = ["the camera's lens: cyclorama calibrate-camera, from pictures of the board"]


def edid(number):
    """A projector of 640 x 480 pixels, so that three of them can be drawn without a card; VESA E-EDID 1.3."""
    timing = bytes([0xD5, 0x09, 0x80, 0xA0, 0x20, 0xE0, 0x2D, 0x10, 0x10, 0x60, 0xA2, 0, 0, 0, 0, 0, 0, 0x18])
    name = b"\0\0\0\xfc\0" + f"TEST {number}".encode().ljust(13, b"\n")
    data = (bytes([0, 255, 255, 255, 255, 255, 255, 0, 0x16, 0x13, 1, 0]) + number.to_bytes(4, "little") +
            bytes([1, 30, 1, 3, 0x80, 0, 0, 0, 0x0A]) + bytes(10) + bytes(3) + b"\1\1" * 8 + timing + name +
            2 * (b"\0\0\0\x10" + bytes(14)) + b"\0")
    return data + bytes([-sum(data) % 256])


class Computer:
    """A museum's computer as its image leaves it, and what systemd does when the page requests something."""

    def __init__(self, source, build, folder):
        self.source, self.build, self.folder = source, build, folder
        self.state, self.keep, self.requests, self.run = (folder / name for name in ("state", "keep", "requests", "run"))
        for path in (self.keep, self.requests, self.run, folder / "defaults"):
            path.mkdir()
        defaults = folder / "defaults"
        shutil.copy(source / "demo/installation.toml", defaults)
        self.ports = {name: free_port() for name in ("tour", "display", "tracker", "museums", "nodes", "page", "room")}
        (defaults / "site.toml").write_text('# The settings until a museum\'s own arrive.\n[farm]\ncoordinators = ["[::1]:7401"]\n')
        self.provision("install", defaults, "--for-any-computer")
        self.make_devices(folder / "sys")
        self.log = open(folder / "page.log", "w", encoding="utf-8")
        self.page = subprocess.Popen(
            [build / "bin/cyclorama-operator", "--listen", f"[::1]:{self.ports['page']}", "--museum", self.state, "--keep",
             self.keep, "--requests", self.requests, "--run", self.run, "--devices", folder / "sys", "--reach",
             folder / "reach.json", "--watch", f"tour={self.at('tour')}", "--watch", f"display={self.at('display')}",
             "--watch", f"tracker={self.at('tracker')}"], stderr=self.log, stdout=self.log)
        self.address = f"https://localhost:{self.ports['page']}/"
        self.parts = []
        self.stopping = threading.Event()
        self.trial_s = 4
        self.systemd = threading.Thread(target=self.carry_out)
        self.systemd.start()

    def at(self, name):
        return f"[::1]:{self.ports[name]}"

    def make_devices(self, root):
        """Three projectors, two network sockets and a USB camera."""
        for number in (1, 2, 3):
            socket = root / f"drm/card0-HDMI-A-{number}"
            socket.mkdir(parents=True)
            (socket / "status").write_text("connected\n")
            (socket / "edid").write_bytes(edid(number))
        (root / "drm/card0-DP-1").mkdir()
        (root / "drm/card0-DP-1/status").write_text("disconnected\n")
        for name, kind in (("eno1", 1), ("eno2", 1), ("lo", 772)):
            (root / "net" / name).mkdir(parents=True)
            (root / "net" / name / "type").write_text(f"{kind}\n")
        camera = self.folder / "devices/pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0"
        camera.mkdir(parents=True)
        (root / "video4linux/video0").mkdir(parents=True)
        (root / "video4linux/video0/device").symlink_to(camera)

    def provision(self, *words):
        return subprocess.run([self.build / "bin/cyclorama-provision", "--state", self.state, *words, "--programs", ""],
                              capture_output=True, text=True, timeout=120)

    def carry_out(self):
        """What the units do: cyclorama-request@.path, cyclorama-offer, cyclorama-network-try@."""
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "reload").write_text("#!/bin/sh\nexit 0\n")
        (tools / "systemctl").write_text(f"#!/bin/sh\nexec {self.build}/bin/cyclorama-provision --state {self.state} install "
                                         f"{self.keep}/offer --over --programs ''\n")
        for tool in tools.iterdir():
            tool.chmod(0o755)
        while not self.stopping.wait(0.1):
            offer, trial = self.requests / "offer", self.requests / "network-try"
            if offer.exists():
                offer.unlink()
                self.provision("install", self.keep / "offer", "--over")
            if trial.exists():
                code = trial.read_text().strip()
                trial.unlink()
                subprocess.run([self.build / "bin/cyclorama-network", "--run", self.run, "--settings",
                                self.state / "settings", "--reload", tools / "reload", "try", code, "--offer",
                                self.keep / "offer", "--keep", self.requests / "network-keep", "--seconds",
                                str(self.trial_s)], env={**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"},
                               capture_output=True, timeout=120)

    def site(self):
        return (self.state / "settings/site.toml").read_text()

    def start_visit(self):
        """The services that systemd starts, with the settings that the page has made."""
        settings, bin_ = self.state / "settings", self.build / "bin"
        scene = self.folder / "grotto"
        subprocess.run([bin_ / "cyclorama-grotto", "--triangles", str(TRIANGLES), "--seed", "1", "--out", scene], check=True,
                       capture_output=True, timeout=120)
        for name, command in (
                ("farm", ["cyclorama-farm", "--scene", f"grotto={scene}", "--museums", self.at("museums"), "--nodes",
                          self.at("nodes")]),
                ("node", ["cyclorama-node", "--coordinator", self.at("nodes"), "--threads", 1, "--name", "node-1"]),
                ("tour", ["cyclorama-tour", "--config", settings / "site.toml", "--listen", self.at("tour")]),
                ("display", ["cyclorama-display", "--config", settings / "site.toml", "--installation",
                             settings / "installation.toml", "--tour", self.at("tour"), "--listen", self.at("display"),
                             "--run-dir", self.run, "--width", 240, "--height", 120, "--refresh-hz", 10]),
                ("tracker", ["cyclorama-tracker", "--camera", "simulated", "--tour", self.at("tour"), "--listen",
                             self.at("tracker")])):
            self.parts.append(Process(name, [bin_ / command[0], *command[1:]], self.folder))

    def close(self):
        self.stopping.set()
        self.systemd.join(150)
        for part in self.parts:
            part.end()
        self.page.terminate()
        self.page.wait(30)


class Installer:
    """A person with a browser. Counts what is touched."""

    def __init__(self, browser, computer, pictures, axe, width):
        self.browser, self.computer, self.pictures, self.axe, self.width = browser, computer, pictures, axe, width
        self.touches, self.shots, self.findings, self.steps = 0, 0, [], {"name"}

    def press(self, selector):
        self.touches += 1
        self.browser.click(selector)

    def type(self, field, text):
        self.touches += 1
        self.browser.type(f'[name="{field}"]', text)

    def choose(self, field, value):
        self.touches += 1
        self.browser.run("const e = document.querySelector(`[name='${arguments[0]}']`); e.value = arguments[1];"
                         "e.dispatchEvent(new Event('input', {bubbles: true}))", field, value)

    def go(self, step):
        self.steps.add(step)
        self.press(f'[data-step="{step}"]')
        wait_until(lambda: self.browser.run("return location.hash") == f"#{step}", 30, f"the step {step}")

    def picture(self, name):
        self.shots += 1
        fits(self.browser, self.width)
        self.browser.run("scrollTo(0, 0)")
        self.browser.picture(self.pictures / f"install-{self.shots:02}-{name}.png")
        if self.axe:
            self.findings += self.axe.check(self.browser, name)

    def sees(self, selector, words, seconds=40):
        wait_until(lambda: words in self.browser.text(selector), seconds,
                   f"{words!r} in {selector}, which says {self.browser.text(selector)!r}")

    def wrong(self, field):
        return self.browser.text(f'[data-field="{field}"] .wrong')

    def use(self, said="They are in use."):
        wait_until(lambda: not self.browser.run("return document.getElementById('use').disabled"), 40,
                   f"the button of a step that says {self.browser.text('#step-missing')!r}")
        self.press("#use")
        if said:
            self.sees("#care-note", said, 60)


def first_pin(one):
    computer, browser = one.computer, one.browser
    wait_until(lambda: (computer.folder / "reach.json").exists(), 40, "what the wall shows")
    browser.open(computer.address)
    one.sees("#told", "have no PIN")
    assert browser.run("return document.getElementById('first').offsetParent === null"), "anybody may choose the first PIN"
    code = json.loads((computer.folder / "reach.json").read_text())["wall_code"]
    browser.open(f"{computer.address}login.html#wall={code}")
    wait_until(lambda: browser.run("return document.getElementById('first').offsetParent !== null"), 40, "the first PIN's form")
    for first, again, word in (("86420975", "86420976", "not the same"), ("111111", "111111", "anybody tries first")):
        browser.type("#first-pin", first)
        browser.type("#first-again", again)
        browser.click("#first button")
        one.sees("#first-note", word)
    one.picture("first-pin")
    one.touches += 2
    browser.type("#first-pin", PIN)
    browser.type("#first-again", PIN)
    one.press("#first button")
    wait_until(lambda: browser.text("h1") == "Installation", 60, "the installer's way")
    wait_until(lambda: browser.text("#step-title") == "Name and PIN", 40, "the first step")
    assert (computer.state / "settings/operator-pin").exists()


def name_and_conflict(one, other):
    one.type("museum", 'Hall "3"')
    wait_until(lambda: "without quotation marks" in one.wrong("museum"), 40, "the mistake, while it is typed")
    one.picture("name-wrong")
    one.type("museum", "Hall 3")
    wait_until(lambda: one.wrong("museum") == "", 40, "no mistake any more")
    one.sees("#step-missing", "Complete, but not in use")
    # A second person, at a computer, has the same step open.
    other.browser.open(f"{one.computer.address}login.html#next=install")
    wait_until(lambda: other.browser.run("return document.getElementById('pin').offsetParent !== null"), 40, "the PIN field")
    other.browser.type("#pin", PIN)
    other.browser.click("#form button")
    wait_until(lambda: other.browser.run("return document.querySelector('[name=museum]')?.value") == "Hall 3", 60,
               "what the first person typed, at the computer")
    other.browser.run("window.fetch = ((fetch) => (path, ...rest) => path === '/setup' ? new Promise(() => {}) : "
                      "fetch(path, ...rest))(window.fetch)")  # This computer hears nothing more.
    time.sleep(1.5)
    one.type("museum", "Hall 4")
    wait_until(lambda: "Hall 4" in (one.computer.keep / "setup.json").read_text(), 40, "the saved name")
    other.type("museum", "Hall 5")
    other.sees("#conflict-words", "has changed this step meanwhile")
    other.sees("#conflict-fields", "theirs is “Hall 4”, yours is “Hall 5”")
    other.picture("two-people")
    assert "Hall 5" not in (one.computer.keep / "setup.json").read_text(), "silently overwritten"
    other.press("#keep-mine")
    wait_until(lambda: one.browser.run("return document.querySelector('[name=museum]').value") == "Hall 5", 40,
               "the computer's name on the phone")
    one.use()
    assert 'museum = "Hall 5"' in one.computer.site() and one.computer.site().startswith("# The settings until")
    one.picture("name")


def network(one):
    one.go("network")
    one.choose("ipv4", "static")
    one.type("ipv4_address", "192.0.2.7")
    wait_until(lambda: "no such address with the network's length" in one.wrong("ipv4_address"), 40, "the mistake")
    wait_until(lambda: "belongs to one cable" in one.wrong("interface"), 40, "the missing cable")
    one.picture("network-wrong")
    one.choose("interface", "eno1")
    one.type("ipv4_address", "192.0.2.7/24")
    one.type("ipv4_gateway", "192.0.2.1")
    one.use(said="")
    one.sees("#trial-words", "is being tried")
    one.sees("#trial-links", "192.0.2.7")
    one.picture("network-tried")
    one.sees("#trial-end", "taken back: nobody confirmed them", 60)
    assert "network" not in one.computer.site(), "settings that nobody confirmed are in use"
    one.picture("network-taken-back")
    one.computer.trial_s = 60
    one.use(said="")
    wait_until(lambda: one.browser.run("return document.getElementById('network-keep')?.offsetParent !== null"), 40,
               "the confirmation")
    one.press("#network-keep")
    one.sees("#step-missing", "These settings are in use", 60)
    assert 'ipv4_address = "192.0.2.7/24"' in one.computer.site()
    one.picture("network-kept")


def projectors_and_wall(one):
    one.go("projectors")
    assert one.browser.run("return document.querySelectorAll('fieldset').length") == 3, "three projectors are plugged in"
    one.choose("2.name", "left")
    one.type("2.name", "left")
    wait_until(lambda: "Two projectors are called left" in one.wrong("2.name"), 40, "the mistake")
    one.type("2.name", "middle")
    wait_until(lambda: one.wrong("2.name") == "", 40, "no mistake any more")
    one.picture("projectors")
    one.use()
    # Left and resumed: the page is closed, and the next step is where it was.
    one.go("wall")
    one.type("radius_m", "3,0")
    wait_until(lambda: "3,0" in (one.computer.keep / "setup.json").read_text(), 40, "the saved radius")
    one.browser.open(one.computer.address + "install.html#wall")
    wait_until(lambda: one.browser.run("return document.querySelector('[name=radius_m]')?.value") == "3,0", 60,
               "the step as it was left")
    for field, value in (("arc_deg", "125"), ("bottom_m", "0.4"), ("top_m", "2.9"), ("eye_m", "1.65"),
                         ("lens_height_m", "2.75"), ("lens_distance_m", "3.4")):
        one.type(field, value)
    one.type("picture_width_m", "3.0")
    one.sees("#wall-hints", "stays dark")
    one.picture("wall-dark")
    one.type("picture_width_m", "4.8")
    wait_until(lambda: one.browser.text("#wall-hints") == "" and "100 % of the wall" in one.browser.text("#wall-words"), 40,
               f"a lit wall: {one.browser.text('#wall-words')}")
    one.picture("wall")
    one.use()
    assert 'connector = "HDMI-A-2"' in (one.computer.state / "settings/installation.toml").read_text()


def cameras_farm_tour(one):
    one.go("cameras")
    one.choose("calibration", "usb-0000:00:14.0-2")
    one.picture("camera")
    one.use()
    one.go("farm")
    one.type("coordinators", "farm")
    wait_until(lambda: "no address with a port" in one.wrong("coordinators"), 40, "the mistake")
    one.type("coordinators", one.computer.at("museums"))
    one.picture("farm")
    one.use()
    one.go("tour")
    one.type("scene", "grotto")
    one.use()
    one.picture("tour")


def visit(one):
    one.computer.start_visit()
    one.go("calibration")
    one.picture("calibration")
    one.go("done")
    one.picture("done")
    sheet = one.browser.do("POST", "/execute/async", {"script": """
      const done = arguments[0];
      fetch('/setup/sheet.pdf').then((a) => a.text()).then((text) => done([text.slice(0, 8), text.includes('Hall 5')]))""",
                                                      "args": []})
    assert sheet[0].startswith("%PDF-1"), sheet
    assert sheet[1], "the sheet does not name the museum"
    missed = tab_stops(one.browser)
    assert not missed, f"the Tab key does not reach {missed}"
    one.browser.open(one.computer.address)
    wait_until(lambda: one.browser.text("#fps") not in ("", "–") and float(one.browser.text("#fps")) > 0, 120,
               f"a running visit: {one.browser.text('#state')}")
    one.picture("visit")


def main():
    options = argparse.ArgumentParser()
    options.add_argument("source", type=pathlib.Path)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("--json", type=pathlib.Path)
    options = options.parse_args()
    if not shutil.which("chromedriver") or not (shutil.which("chromium") or shutil.which("google-chrome")):
        print("install: skipped, chromium-driver is not installed; scripts/install-packages test installs it")
        return SKIPPED
    library = options.build / "axe/node_modules/axe-core/axe.min.js"
    axe = Axe(library.read_text()) if library.exists() else None
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        pictures = pathlib.Path(os.environ.get("CYCLORAMA_SCREENSHOTS", name))
        pictures.mkdir(parents=True, exist_ok=True)
        computer = Computer(options.source, options.build, folder)
        phone = second = None
        try:
            phone = Browser(folder, PHONE, is_phone=True)
            one = Installer(phone, computer, pictures, axe, PHONE[0])
            first_pin(one)
            second = Browser(folder, DESKTOP, is_phone=False)
            other = Installer(second, computer, pictures, axe, DESKTOP[0])
            name_and_conflict(one, other)
            network(one)
            projectors_and_wall(one)
            cameras_farm_tour(one)
            visit(one)
            bad = one.findings + other.findings
            bad += phone.mistakes() + second.mistakes()
        except Exception:
            phone.picture(pictures / "install-failed.png")
            print(phone.mistakes(), (folder / "page.log").read_text()[-1500:])
            print((computer.state / "provisioning.json").read_text()[-1500:])
            for log in folder.glob("*.log"):
                print(f"{log.name}:\n{log.read_text(errors='replace')[-600:]}")
            raise
        finally:
            for browser in (phone, second):
                if browser:
                    browser.close()
            computer.close()
    record = {"steps": len(one.steps), "touches": one.touches, "seconds": round(time.monotonic() - begun, 1), "needs_shell": len(NEEDS_SHELL),
              "pictures": one.shots + other.shots, "axe_serious": len(one.findings + other.findings) if axe else None}
    if options.json:
        options.json.write_text(json.dumps(record) + "\n")
    print(json.dumps(record))
    print("\n".join(map(str, bad)) if bad else "install: ok")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
