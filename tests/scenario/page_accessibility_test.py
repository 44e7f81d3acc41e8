#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the operator page's accessibility in headless Chromium, on a desktop and on a phone of 360 px: axe-core has no
serious finding on any page, nothing is wider than the phone, and every control is reached with the Tab key.
CYCLORAMA_SCREENSHOTS=FOLDER keeps pictures of the pages.

Run: page_accessibility_test.py SOURCE_ROOT BUILD_FOLDER      It is skipped (77) without chromedriver or axe-core, which
is sought in BUILD_FOLDER/axe (npm install --prefix BUILD_FOLDER/axe axe-core).
"""
import os
import pathlib
import shutil
import sys
import tempfile

from farm.processes import wait_until
from operator_page_test import DESKTOP, PIN, SKIPPED, Browser, Museum, fits

NARROW = (360, 780)
# axe-core's impacts, from the least to the worst: minor, moderate, serious, critical.
REFUSED = ("serious", "critical")


class Axe:
    def __init__(self, source):
        self.source = source
        self.findings = {}

    def check(self, browser, page):
        """Returns the findings that are refused, each with the elements. All are counted by their impact."""
        browser.run(self.source)
        script = ("const done = arguments[arguments.length - 1];"
                  "axe.run({resultTypes: ['violations']}).then((found) => done(found.violations.map((one) => "
                  "[one.impact, one.id, one.help, one.nodes.map((node) => `${node.target} ${node.failureSummary}`)])))")
        refused = []
        for impact, rule, meaning, nodes in browser.do("POST", "/execute/async", {"script": script, "args": []}):
            self.findings.setdefault(impact, []).append(f"{page}: {rule}: {meaning}: {nodes[0]}")
            if impact in REFUSED:
                refused.append(f"{page}: {impact}: {rule}: {meaning}\n  " + "\n  ".join(nodes[:8]))
        return refused


def tab_stops(browser):
    """Returns the visible controls that the Tab key does not reach, since something keeps the focus or skips them."""
    wanted = browser.run("""document.activeElement.blur(); scrollTo(0, 0);
      window.reached = new Set(); document.addEventListener('focusin', (e) => reached.add(e.target));
      window.controls = [...document.querySelectorAll('a[href], button, input, select, summary')]
        .filter((e) => e.checkVisibility() && !e.disabled);
      return controls.length""")
    keys = [{"type": kind, "value": "\ue004"} for _ in range(wanted + 5) for kind in ("keyDown", "keyUp")]
    browser.do("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": keys}]})
    return browser.run("return controls.filter((e) => e.isConnected && e.checkVisibility() && !e.disabled && "
                       "!reached.has(e)).map((e) => e.id || e.outerHTML.slice(0, 80))")


def check(browser, museum, axe, pictures, name, size):
    bad = []
    browser.open(museum.address)
    wait_until(lambda: "operator.toml:1" in browser.text("#told"), 30, "the reason why nobody can log in")
    fits(browser, size[0])
    browser.picture(pictures / f"axe-door-{name}.png", whole=False)
    bad += axe.check(browser, f"{name}: login without a PIN")
    museum.correct_the_stick()
    browser.open(museum.address + "login.html#sha256=" + "4FA1" * 16)
    wait_until(lambda: browser.run("return document.getElementById('pin').offsetParent !== null"), 30, "the PIN field")
    browser.type("#pin", "000000")
    browser.click("button")
    wait_until(lambda: "not the PIN" in browser.text("#note"), 30, "the refusal")
    assert "4F:A1:" in browser.text("#print"), "the wall's fingerprint"
    fits(browser, size[0])
    browser.picture(pictures / f"axe-login-{name}.png", whole=False)
    bad += axe.check(browser, f"{name}: login")
    browser.type("#pin", PIN)
    browser.click("button")
    wait_until(lambda: browser.text("#title") == "The grotto", 60, "the page behind the PIN")
    wait_until(lambda: "corrected by" in browser.text("#healing-projectors"), 30, "the projectors' corrections")
    wait_until(lambda: browser.run("return document.querySelectorAll('#parts > li').length") == 4, 30, "all parts")
    browser.run("for (const one of document.querySelectorAll('details')) one.open = true")
    fits(browser, size[0])
    browser.picture(pictures / f"axe-page-{name}.png")
    bad += axe.check(browser, f"{name}: page")
    missed = tab_stops(browser)
    assert not missed, f"the Tab key does not reach {missed}"
    return bad


def main(source, build):
    source, build = pathlib.Path(source), pathlib.Path(build)
    library = build / "axe/node_modules/axe-core/axe.min.js"
    if not shutil.which("chromedriver") or not (shutil.which("chromium") or shutil.which("google-chrome")):
        print("page_accessibility: skipped, chromium-driver is not installed; scripts/install-packages test installs it")
        return SKIPPED
    if not library.exists():
        print(f"page_accessibility: skipped, no {library}; npm install --prefix {build}/axe axe-core brings it")
        return SKIPPED
    axe, bad = Axe(library.read_text()), []
    with tempfile.TemporaryDirectory() as folder:
        pictures = pathlib.Path(os.environ.get("CYCLORAMA_SCREENSHOTS", folder))
        pictures.mkdir(parents=True, exist_ok=True)
        for name, size in (("desktop", DESKTOP), ("narrow", NARROW)):
            home = pathlib.Path(folder) / name
            home.mkdir()
            museum = Museum(source, build, home, "--unwell")
            try:
                browser = Browser(home, size, is_phone=name == "narrow")
                try:
                    bad += check(browser, museum, axe, pictures, name, size)
                finally:
                    browser.close()
            finally:
                museum.close()
    for impact, findings in sorted(axe.findings.items()):
        print(f"{impact}: {len(findings)}", *findings, sep="\n  ")
    print("\n".join(bad) if bad else "page accessibility: ok")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
