#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests a museum's operator page in headless Chromium, on a desktop and a phone: PIN, states and remedies, calibration,
network test, support bundle. CYCLORAMA_SCREENSHOTS=FOLDER keeps pictures of the page.

Run: operator_page_test.py SOURCE_ROOT BUILD_FOLDER      It is skipped (77) without chromedriver.
"""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

from farm.processes import free_port, wait_until

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from museum_room import room_on  # noqa: E402

PIN = "401773"
SKIPPED = 77
DESKTOP, PHONE = (1280, 900), (360, 780)


class Browser:
    """The part of WebDriver (W3C) that this test needs."""

    def __init__(self, folder, size, is_phone):
        port = free_port()
        self.driver = subprocess.Popen([shutil.which("chromedriver"), f"--port={port}"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        self.root = f"http://127.0.0.1:{port}"
        wait_until(self.is_ready, 30, "chromedriver")
        options = {"args": ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                            f"--window-size={size[0]},{size[1]}", f"--user-data-dir={folder}/profile-{port}"],
                   "prefs": {"download.default_directory": str(folder)}}
        if is_phone:
            options["mobileEmulation"] = {"deviceMetrics": {"width": size[0], "height": size[1], "pixelRatio": 2,
                                                            "touch": True}}
        capabilities = {"browserName": "chrome", "acceptInsecureCerts": True, "goog:chromeOptions": options,
                        "goog:loggingPrefs": {"browser": "ALL"}}
        self.session = self.ask("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})["sessionId"]

    def is_ready(self):
        try:
            return self.ask("GET", "/status")["ready"]
        except OSError:
            return False

    def ask(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.root + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(f"{method} {path}: {error.read().decode()[:500]}") from None

    def do(self, method, path, body=None):
        return self.ask(method, f"/session/{self.session}{path}", body)

    def open(self, address):
        self.do("POST", "/url", {"url": address})

    def run(self, script, *arguments):
        return self.do("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def element(self, selector):
        return next(iter(self.do("POST", "/element", {"using": "css selector", "value": selector}).values()))

    def click(self, selector):
        self.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center'})", selector)
        self.do("POST", f"/element/{self.element(selector)}/click", {})

    def type(self, selector, text):
        element = self.element(selector)
        self.do("POST", f"/element/{element}/clear", {})
        self.do("POST", f"/element/{element}/value", {"text": text})

    def press_enter(self, selector):
        self.do("POST", f"/element/{self.element(selector)}/value", {"text": "\ue007"})

    def text(self, selector):
        return self.run("const e = document.querySelector(arguments[0]); return e ? e.innerText : ''", selector)

    def mistakes(self):
        """Returns the errors of the page's code, without the browser's notes on answers that are errors by design."""
        return [entry["message"] for entry in self.do("POST", "/se/log", {"type": "browser"})
                if entry["level"] == "SEVERE" and "Failed to load resource" not in entry["message"]]

    def picture(self, path, whole=True):
        if not whole:
            path.write_bytes(base64.b64decode(self.do("GET", "/screenshot")))
            return
        taken = self.do("POST", "/goog/cdp/execute", {"cmd": "Page.captureScreenshot",
                                                      "params": {"captureBeyondViewport": True, "format": "png"}})
        path.write_bytes(base64.b64decode(taken["data"]))

    def close(self):
        try:
            self.ask("DELETE", f"/session/{self.session}")
        finally:
            self.driver.terminate()
            self.driver.wait(30)


class Museum:
    """A museum's parts, provisioned from a stick, and its page."""

    def __init__(self, source, build, folder, *parts_options, care=None):
        self.folder = folder
        stick, self.state, keep = folder / "stick", folder / "state", folder / "keep"
        for path in (stick, keep):
            path.mkdir()
        self.parts = subprocess.Popen([build / "bin/test-parts", *parts_options], stdout=subprocess.PIPE, text=True)
        tour, display, tracker, calibrator, projectors = self.parts.stdout.readline().split()
        # The tour's port stands for a coordinator that answers; the other one is closed.
        (stick / "site.toml").write_text(f'[farm]\ncoordinators = ["{tour}", "[::1]:1"]\nmuseum = "hall-3"\n'
                                         '[hours]\nopen = ["Tue-Sun 10:00-18:00", "Thu 19:00-22:00"]\n')
        (stick / "installation.toml").write_text(room_on(source, "HDMI-A"))
        (stick / "operator.toml").write_text(f'pni = "{PIN}"\n')
        if care is not None:
            (stick / "care.toml").write_text(care)
        self.provision = [build / "bin/cyclorama-provision", "--state", self.state, "install", stick, "--programs", ""]
        assert subprocess.run(self.provision, capture_output=True, timeout=60).returncode == 1
        (self.state / "update.json").write_text('{"state": "current", "version": "0.1.0", "at": "2026-11-22T03:10:00Z"}')
        self.port = free_port()
        self.page = subprocess.Popen([build / "bin/cyclorama-operator", "--listen", f"[::1]:{self.port}",
                                      "--museum", self.state,
                                      "--keep", keep, "--requests", keep, "--calibrator", calibrator,
                                      "--watch", f"tour={tour}",
                                      "--watch", f"display={display}", "--watch", f"tracker={tracker}",
                                      "--watch", f"projectors={projectors}"],
                                     stderr=subprocess.PIPE, text=True)
        while "listens on" not in (line := self.page.stderr.readline()):
            assert line, "the page did not start"
        self.address = f"https://localhost:{self.port}/"

    def correct_the_stick(self):
        (self.folder / "stick/operator.toml").write_text(f'pin = "{PIN}"\n')
        subprocess.run(self.provision, check=True, capture_output=True, timeout=60)

    def refuse_a_stick(self):
        site = self.folder / "stick/site.toml"
        site.write_text(site.read_text().replace("museum =", "musuem ="))
        assert subprocess.run(self.provision, capture_output=True, timeout=60).returncode == 1

    def close(self):
        for process in (self.page, self.parts):
            process.terminate()
            process.wait(30)


def fits(browser, width):
    """Checks that nothing is wider than the window."""
    found = browser.run("return [document.documentElement.scrollWidth, [...document.querySelectorAll('body *')]"
                        ".filter((e) => e.getBoundingClientRect().right > arguments[0] + 1).map((e) => e.tagName + '.' + "
                        "e.className).slice(0, 5)]", width)
    assert found[0] <= width, f"the page is {found[0]} px wide in a window of {width}: {found[1]}"


def enter(browser, museum, pictures, name):
    browser.open(museum.address)
    wait_until(lambda: browser.text("h1") == "The operator's page", 30, "the login page")
    wait_until(lambda: "operator.toml:1" in browser.text("#told"), 30, "the reason why nobody can log in")
    assert "plug it in again" in browser.text("#told") and PIN not in browser.text("body"), browser.text("body")
    assert browser.run("return document.getElementById('pin').offsetParent === null"), "it requests a PIN although there is none"
    fits(browser, browser.run("return innerWidth"))
    browser.picture(pictures / f"door-{name}.png", whole=False)
    museum.correct_the_stick()
    wait_until(lambda: browser.run("return document.getElementById('pin').offsetParent !== null"), 30, "the PIN field")
    assert browser.text("#told") == "", browser.text("#told")
    browser.type("#pin", "000000")
    browser.click("button")
    wait_until(lambda: "not the PIN" in browser.text("#note"), 30, "the refusal")
    browser.picture(pictures / f"login-{name}.png", whole=False)
    browser.type("#pin", "40 17 73")
    browser.click("button")
    wait_until(lambda: browser.text("#title") == "The grotto", 60, "the page behind the PIN")
    cookie = browser.do("GET", "/cookie")
    assert [(c["httpOnly"], c["secure"], c["sameSite"]) for c in cookie] == 2 * [(True, True, "Strict")], cookie


def check_page(browser, museum, pictures, name, size):
    enter(browser, museum, pictures, name)
    # Panorama, three projectors, camera: each picture is loaded while it is visible.
    for number in range(5):
        frame = f"[...document.querySelectorAll('figure:not([hidden]) .frame')][{number}]"
        browser.run(f"{frame}.scrollIntoView({{block: 'center'}})")
        wait_until(lambda: browser.run(f"return {frame}.classList.contains('live')"), 60, f"live picture {number}")
    browser.run("scrollTo(0, 0)")
    hidden = browser.run("return document.getElementById('calibrate-cancel').offsetParent === null")
    assert hidden, "nothing runs, but it can be cancelled"
    wait_until(lambda: browser.run("return document.querySelectorAll('#parts > li').length") == 4, 30, "all parts")
    wait_until(lambda: "Tue-Sun" in browser.text("#hours"), 30, "the opening hours")
    wait_until(lambda: ":" in browser.text("#page-state .print"), 30, "the fingerprint")
    wait_until(lambda: "corrected by 23.4 px" in browser.text("#healing-projectors"), 30, "the projectors' corrections")
    assert browser.run("return document.querySelectorAll('#healing-plot polyline').length") == 4, "three lines, one with a gap"
    fits(browser, size[0])
    browser.picture(pictures / f"page-{name}.png")
    small = browser.run("return [...document.querySelectorAll('button, a.button')].filter((b) => b.offsetParent && "
                        "b.getBoundingClientRect().height < 40).map((b) => b.id || b.innerText)")
    assert not small, f"too small for a finger: {small}"


def check_lamps(browser, is_unwell):
    """Checks that every lamp is listed, and that one that is off while the museum is open needs attention."""
    wait_until(lambda: browser.run("return document.getElementById('checks').textContent").count("Its lamp is") == 3,
               30, "the lamps")
    needs = browser.text("#needs") if is_unwell else ""
    assert ("Projector 'right'" in needs and "remote control" in needs) == is_unwell, needs


def check_hours(browser, museum, pictures, name):
    """Sets exceptions from the hours: closing is confirmed, opening replaces it, and a button removes it."""
    browser.run("document.getElementById('hours').scrollIntoView({block: 'center'})")
    browser.click("#hours-closed")
    browser.click("#hours-closed")
    wait_until(lambda: "Closed until" in browser.text("#hours-state"), 30, "the museum that closes")
    assert (museum.state / "hours/override").read_text().startswith("closed from "), "it is not kept"
    browser.run("document.getElementById('hours').scrollIntoView({block: 'center'})")
    browser.picture(pictures / f"hours-{name}.png", whole=False)
    soon = time.strftime("%H:%M", time.localtime(time.time() + 7200))
    browser.run("document.getElementById('hours-until').value = arguments[0]", soon)
    browser.click("#hours-open")
    wait_until(lambda: "Open until" in browser.text("#hours-state"), 30, "the museum that stays open")
    (museum.state / "hours/override").write_text("open for ever\n")
    wait_until(lambda: "damaged" in browser.text("#hours-problem"), 30, "the report on the broken file")
    browser.click("#hours-settings")
    wait_until(lambda: "of the settings apply again" in browser.text("#care-note"), 30, "the hours of the settings")
    assert not (museum.state / "hours/override").exists()


def check_work(browser, museum, pictures, name):
    browser.run("document.getElementById('healing-card').scrollIntoView({block: 'center'})")
    browser.picture(pictures / f"healing-{name}.png", whole=False)
    browser.click("#realign")
    wait_until(lambda: "measured anew" in browser.text("#care-note"), 30, "the realignment")
    browser.click("#calibrate")
    wait_until(lambda: "Turn the turntable to 30.0 degrees" in browser.text("#calibration-question"), 30, "the question")
    browser.type("#calibration-answer", "30.5")
    browser.picture(pictures / f"question-{name}.png", whole=False)
    browser.press_enter("#calibration-answer")
    wait_until(lambda: "shows pattern 2" in browser.text("#calibration-state"), 30, "the calibration's progress")
    assert browser.run("return document.getElementById('calibration-question').offsetParent === null"), "the answered question stays"
    wait_until(lambda: browser.run("return document.getElementById('calibration-picture').naturalWidth") == 640, 30,
               "its picture")
    browser.click("#network-test")
    wait_until(lambda: "its program does not run" in browser.text("#network"), 60, "the network test")
    browser.run("document.getElementById('care').scrollIntoView()")
    browser.picture(pictures / f"calibrating-{name}.png", whole=False)
    browser.click("#calibrate-cancel")
    wait_until(lambda: "Cancelled" in browser.text("#calibration-state"), 30, "the cancellation")
    browser.picture(pictures / f"cancelled-{name}.png", whole=False)
    browser.click("#calibrate-resume")
    wait_until(lambda: "Turn the turntable" in browser.text("#calibration-question"), 30, "the resumed calibration")
    browser.click("#calibrate-cancel")
    wait_until(lambda: "Cancelled" in browser.text("#calibration-state"), 30, "the cancellation")
    wait_until(lambda: browser.run("return document.getElementById('place-cameras').offsetParent !== null"), 30,
               "the button place-cameras")
    browser.click("#place-cameras")
    wait_until(lambda: "saw 2814 places" in browser.text("#calibration-remarks"), 30, "the fixed cameras' positions")
    quick = browser.run("return [...document.getElementById('quick-projector').options].map((option) => option.value)")
    assert quick == ["left", "middle", "right"], quick
    browser.run("document.getElementById('calibration-card').scrollIntoView({block: 'center'})")
    browser.picture(pictures / f"placed-{name}.png", whole=False)
    wait_until(lambda: browser.run("return document.getElementById('calibrate-quick').offsetParent !== null"), 30,
               "the button calibrate-quick")
    browser.click("#calibrate-quick")
    wait_until(lambda: "Turn the turntable" in browser.text("#calibration-question"), 30, "the quick calibration")
    browser.click("#calibrate-cancel")
    wait_until(lambda: "Cancelled" in browser.text("#calibration-state"), 30, "the cancellation")
    browser.click("#calibrate-restore")
    browser.click("#calibrate-restore")
    wait_until(lambda: "2026-10-01" in browser.text("#care-note"), 30, "the previous calibration")
    browser.click("#bundle")
    bundle = museum.folder / "cyclorama-support.zip"
    wait_until(bundle.exists, 60, "the support bundle")
    museum.refuse_a_stick()
    wait_until(lambda: "musuem" in browser.text("#needs"), 30, "why the stick was refused")
    assert "plug it in again" in browser.text("#needs"), browser.text("#needs")
    browser.click("#logout")
    wait_until(lambda: browser.text("h1") == "The operator's page", 30, "the login page again")


def main(source, build):
    if not shutil.which("chromedriver") or not (shutil.which("chromium") or shutil.which("google-chrome")):
        print("operator_page: skipped, chromium-driver is not installed; scripts/install-packages test installs it")
        return SKIPPED
    source, build = pathlib.Path(source), pathlib.Path(build)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        pictures = pathlib.Path(os.environ.get("CYCLORAMA_SCREENSHOTS", name))
        pictures.mkdir(parents=True, exist_ok=True)
        for kind, size, options in (("desktop", DESKTOP, ()), ("phone", PHONE, ("--unwell",))):
            home = folder / kind
            home.mkdir()
            museum = Museum(source, build, home, *options)
            try:
                browser = Browser(home, size, kind == "phone")
                try:
                    check_page(browser, museum, pictures, kind, size)
                    check_lamps(browser, bool(options))
                    check_hours(browser, museum, pictures, kind)
                    check_work(browser, museum, pictures, kind)
                    assert not browser.mistakes(), browser.mistakes()
                except Exception:
                    browser.picture(pictures / f"failed-{kind}.png")
                    print(browser.mistakes())
                    raise
                finally:
                    browser.close()
            finally:
                museum.close()
    print("operator page: ok")
    return 0


if __name__ == "__main__":
    begun = time.monotonic()
    code = main(*sys.argv[1:])
    print(f"{time.monotonic() - begun:.0f} s")
    sys.exit(code)
