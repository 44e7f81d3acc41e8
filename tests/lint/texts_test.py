#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests scripts/texts: it finds what it must find in a copy of the tree's texts.

Run: texts_test.py SOURCE_ROOT
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile


def check(root):
    done = subprocess.run([sys.executable, root / "scripts/texts", "--check"], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def changed(path, old, new):
    text = path.read_text()
    assert old in text, f"{path} has no {old!r}"
    path.write_text(text.replace(old, new, 1))


def main(source):
    source = pathlib.Path(source)
    with tempfile.TemporaryDirectory() as name:
        tree = pathlib.Path(name)
        for folder in ("appliance", "common", "drivers/output", "kiosk", "renderfarm/watch", "scripts"):
            shutil.copytree(source / folder, tree / folder)
        well = check(tree)
        assert well[0] == 0, well
        page, german = tree / "kiosk/operator/page/care.js", tree / "common/language/de.po"
        faults = (
            (page, 'tr("Open now.")', '"Open now."', "is shown without tr()"),
            (page, 'tr("Open now.")', 'tr("Open as of now.")', "run scripts/texts"),
            (tree / "kiosk/operator/page/index.html", ">Care<", ">Care of it<", "run scripts/texts"),
            (tree / "kiosk/operator/checks.cpp", '"Disk"', '"Hard disk"', "run scripts/texts"),
            (german, 'msgstr "Datenträger"', 'msgstr ""', "untranslated"),
            (german, 'msgid "Disk"', '#, fuzzy\nmsgid "Disk"', "fuzzy"),
            (german, "Version {} läuft.", "Version läuft.", "other places for arguments"),
            (german, "Version {version}.", "Version {versoin}.", "other places for arguments"),
        )
        for path, old, new, words in faults:
            before = path.read_text()
            # In a .po file the text stands twice; the translation is the second.
            changed(path, old, new) if path is not german or old.startswith("msg") else path.write_text(
                before.replace(f'msgstr "{old}', f'msgstr "{new}', 1))
            code, said = check(tree)
            assert code == 1 and words in said, (path, new, code, said[:2000])
            path.write_text(before)
        assert check(tree)[0] == 0
    print("texts: found every fault")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
