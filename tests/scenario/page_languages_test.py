#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the operator page in each language in headless Chromium, on a phone of 360 px: no text of the catalogue stays
English, nothing is wider than the phone, numbers and dates are the language's, and the choice outlives a new visit.
CYCLORAMA_SCREENSHOTS=FOLDER keeps pictures of the pages.

Run: page_languages_test.py SOURCE_ROOT BUILD_FOLDER      It is skipped (77) without chromedriver.
"""
import os
import pathlib
import shutil
import sys
import tempfile

from farm.processes import wait_until
from operator_page_test import PHONE, PIN, SKIPPED, Browser, Museum, fits

# What each language writes for 19.8 pictures a second, and its word for the museum's opening.
LANGUAGES = {"de": ("19,8", "Öffnungszeiten"), "es": ("19,8", "Horario de apertura"),
             "fr": ("19,8", "Horaires d’ouverture"), "zh": ("19.8", "开放时间"), "en": ("19.8", "Opening hours")}
# Texts, also those of attributes, that are in the catalogue in English and have another translation.
UNTRANSLATED = """
  const answer = await fetch('/texts?language=' + arguments[0]);
  const {texts} = await answer.json();
  const english = new Map(texts.filter(([one, , form]) => one !== form).map(([one, , form]) => [one, form]));
  const found = [];
  const look = (text, of) => { if (english.has(text.trim().replace(/\\s+/g, ' '))) found.push(of.outerHTML.slice(0, 200)); };
  for (const element of document.body.querySelectorAll('*:not(noscript, #stops-list *)')) {
    for (const name of ['alt', 'title', 'aria-label']) look(element.getAttribute(name) || '', element);
    for (const node of element.childNodes) if (node.nodeType === 3) look(node.textContent, element);
  }
  return found;"""


def choose(browser, language):
    browser.run("""const select = document.querySelector('select.language'); select.value = arguments[0];
      select.dispatchEvent(new Event('change'));""", language)
    wait_until(lambda: browser.run("return document.readyState === 'complete' && document.documentElement.lang") ==
               language, 30, f"the page in '{language}'")


def check(browser, museum, pictures):
    browser.open(museum.address)
    wait_until(lambda: browser.text("h1") == "The operator's page", 30, "the browser's language, before any settings")
    museum.correct_the_stick()
    browser.open(museum.address)
    wait_until(lambda: browser.text("h1") == "Die Bedienseite", 30, "the museum's language")
    wait_until(lambda: browser.run("return document.getElementById('pin').offsetParent !== null"), 30, "the PIN field")
    browser.type("#pin", "000000")
    browser.click("button")
    wait_until(lambda: "nicht die PIN" in browser.text("#note"), 30, "the refusal")
    browser.picture(pictures / "language-login-de.png", whole=False)
    browser.type("#pin", PIN)
    browser.click("button")
    wait_until(lambda: browser.text("#title") == "The grotto", 60, "the page behind the PIN")
    for language, (number, hours) in LANGUAGES.items():
        choose(browser, language)
        wait_until(lambda: browser.text("#title") == "The grotto", 60, "the page")
        wait_until(lambda: browser.run("return document.querySelectorAll('#parts > li').length") == 4, 30, "all parts")
        wait_until(lambda: browser.run("return document.querySelectorAll('#needs > li').length") > 0, 30, "the checks")
        browser.run("for (const one of document.querySelectorAll('details')) one.open = true")
        left = browser.run("return (async () => {" + UNTRANSLATED + "})()", language)
        assert language == "en" or not left, f"{language}: still English: {left}"
        assert number in browser.text("#fps"), (language, browser.text("#fps"))
        assert hours in browser.text("#care"), (language, browser.text("#care")[:300])
        fits(browser, PHONE[0])
        browser.picture(pictures / f"language-{language}.png")
    choose(browser, "fr")
    wait_until(lambda: "maintenant" in browser.text("#hours-state"), 30, "whether the museum is open, in French")

    def is_closed():
        # A question lasts six seconds, in which a busy computer may not come to the second press.
        browser.run("document.getElementById('hours-closed').click()")
        return "Fermé exceptionnellement" in browser.text("#hours-state")

    wait_until(is_closed, 60, "the exception in French")
    days = ("lun.", "mar.", "mer.", "jeu.", "ven.", "sam.", "dim.")
    assert any(day in browser.text("#hours-state") for day in days), browser.text("#hours-state")
    assert "mar.-dim. 10:00-18:00" in browser.text("#hours"), browser.text("#hours")
    browser.open(museum.address)
    wait_until(lambda: browser.run("return document.documentElement.lang") == "fr", 30, "the choice, kept")


def main(source, build):
    if not shutil.which("chromedriver") or not (shutil.which("chromium") or shutil.which("google-chrome")):
        print("page_languages: skipped, chromium-driver is not installed; scripts/install-packages test installs it")
        return SKIPPED
    source, build = pathlib.Path(source), pathlib.Path(build)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        pictures = pathlib.Path(os.environ.get("CYCLORAMA_SCREENSHOTS", name))
        pictures.mkdir(parents=True, exist_ok=True)
        museum = Museum(source, build, folder, "--unwell", care='language = "de"\n')
        try:
            browser = Browser(folder, PHONE, is_phone=True)
            try:
                check(browser, museum, pictures)
                assert not browser.mistakes(), browser.mistakes()
            except Exception:
                browser.picture(pictures / "failed-language.png")
                print(browser.mistakes(), browser.text("body")[:3000])
                raise
            finally:
                browser.close()
        finally:
            museum.close()
    print("page languages: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
