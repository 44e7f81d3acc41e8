#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests power cuts as disks know them: settings from a stick, going back to the previous ones, a certificate that is
renewed, and a calibration that is replaced, each by the real program on a file system of its own. QEMU logs the disk's
writes; at every flush and at random moments the disk has what was flushed and some of the other writes. The file system
must mount, and have the old or the new, whole.

Run, as root: powerloss_test.py SOURCE_ROOT BUILD_FOLDER [--points N] [--json FILE]
"""
import argparse
import hashlib
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/tools"))
from museum_room import room_on  # noqa: E402
from write_log import LoggedFolder, Replay, points_of  # noqa: E402

MEGABYTES = 48
TOOLS = ("qemu-storage-daemon", "mkfs.ext4", "fsck.ext4", "losetup")
DATES = ("2026-01-01T00-00-00Z", "2026-01-02T00-00-00Z")


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise RuntimeError(f"{words}: {done.stdout}{done.stderr}")
    return done.stdout


def tree(folder):
    """Returns {path: (mode, group, content's hash)} of all files below a folder."""
    return {str(path.relative_to(folder)): (path.stat().st_mode, path.stat().st_gid,
                                            hashlib.sha256(path.read_bytes()).hexdigest())
            for path in sorted(folder.rglob("*")) if path.is_file()}


class Museum:
    """The programs, and two sticks for them."""

    def __init__(self, build, folder):
        self.bin, self.tests, self.folder = build / "bin", build / "tests", folder
        self.authority = [self.bin / "cyclorama-authority", "--folder", folder / "ca"]
        run(*self.authority, "init")
        run(*self.authority, "museum", "hall-3", "--output", folder / "museum.tar")
        run(*self.authority, "renew", "hall-3", "--days", "900", "--output", folder / "next.tar")
        (folder / "renewed").mkdir()
        run("tar", "-xf", folder / "next.tar", "-C", folder / "renewed", "certificate.crt", "key.pem")
        # Noise does not shrink, so the picture has many blocks on the disk.
        run("convert", "-size", "480x480", "-seed", "7", "xc:gray", "+noise", "Random", folder / "evening.png")
        for name in ("a", "b"):
            stick = folder / name
            (stick / "tls").mkdir(parents=True)
            run("tar", "-xf", folder / "museum.tar", "-C", stick / "tls", "authority.crt", "certificate.crt", "key.pem")
            shutil.copy(folder / "evening.png", stick)
            (stick / "installation.toml").write_text(room_on(ROOT, "HDMI-A"))
            (stick / "operator.toml").write_text('pin = "401773"\n')
            (stick / "site.toml").write_text(
                f'[farm]\ncoordinators = ["[2001:db8::1]:7401"]\nmuseum = "hall-{name}"\nauthority = "tls/authority.crt"\n'
                'certificate = "tls/certificate.crt"\nkey = "tls/key.pem"\n[display]\nattract_picture = "evening.png"\n')

    def provision(self, at, *words):
        """Runs cyclorama-provision; the programs of the show are not here to check their own tables."""
        programs = [] if words[0] == "restore" else ["--programs", ""]
        run(self.bin / "cyclorama-provision", "--state", at / "cyclorama", *words, *programs)

    def settings(self, at):
        """Returns the settings in use, whole; None: none."""
        settings = at / "cyclorama/settings"
        return tree(settings.resolve(strict=True)) if settings.is_symlink() else None

    def calibrate(self, at, date):
        run(self.tests / "test-calibration", "write", at / "calibration", date)

    def calibration(self, at):
        """Returns the date of the calibration in use after reading all of it."""
        return run(self.tests / "test-calibration", "read", at / "calibration").strip()


def cases(museum):
    """Returns {name: (what was before, what is done, what is read)}."""
    a, b = museum.folder / "a", museum.folder / "b"

    def install(stick):
        return lambda at: museum.provision(at, "install", stick)

    def both(at):
        museum.provision(at, "install", a)
        museum.provision(at, "install", b)
    return {
        "first settings": (lambda at: (at / "cyclorama").mkdir(), install(a), museum.settings),
        "settings": (install(a), install(b), museum.settings),
        "previous settings": (both, lambda at: museum.provision(at, "restore"), museum.settings),
        "certificate": (both, lambda at: museum.provision(at, "renew", museum.folder / "renewed"), museum.settings),
        "calibration": (lambda at: museum.calibrate(at, DATES[0]), lambda at: museum.calibrate(at, DATES[1]),
                        museum.calibration),
    }


def check(name, case, folder, count, figures):
    before, work, read = case
    disk = LoggedFolder(folder, MEGABYTES)
    with disk.mounted() as at:
        before(at)
        old = read(at)
    log, first, ended = disk.logged(lambda: work(disk.at))
    with disk.mounted() as at:
        new = read(at)
    assert old != new, name
    chance = random.Random(25)
    account = {"points": 0, "old": 0, "new": 0, "half": 0, "lost_after_the_end": 0}
    cut = folder / "cut.raw"
    replay = Replay(log, first)
    for point in points_of(log, count, chance):
        account["points"] += 1
        with replay.after(point, chance) as state:
            shutil.copy(state, cut)
        try:
            with disk.mounted(cut) as at:
                found = read(at)
        except (OSError, RuntimeError, subprocess.CalledProcessError) as error:
            found = f"{type(error).__name__}: {error}"
        which = "new" if found == new else "old" if found == old else "half"
        account[which] += 1
        if which == "old" and point >= ended:
            account["lost_after_the_end"] += 1
        if which == "half":
            figures["failed"].append(f"{name}, after {point} of {len(log.entries)} writes: {str(found)[:300]}")
    account["writes"], account["flushes"] = len(log.entries), len(log.flushes())
    print(f"{name}: {account}", flush=True)
    for key in ("points", "half"):
        figures[key] += account[key]
    figures["started"] += account["old"] + account["new"]
    figures["cases"][name] = account
    if not account["old"] or not account["new"]:
        figures["failed"].append(f"{name}: no moment shows {'the old' if not account['old'] else 'the new'}")
    if account["lost_after_the_end"] and name != "calibration":
        figures["failed"].append(f"{name}: what was reported as done is lost at {account['lost_after_the_end']} moments")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--points", type=int, default=40, help="random moments of each case, besides all flushes")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    missing = [tool for tool in TOOLS if not shutil.which(tool, path=f"{os.environ['PATH']}:/usr/sbin:/sbin")]
    if missing or os.geteuid() != 0 or not os.path.exists("/dev/fuse"):
        print(f"powerloss: skipped; it needs root, /dev/fuse and {', '.join(TOOLS)} (scripts/install-packages image)")
        return 77
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    figures = {"points": 0, "started": 0, "half": 0, "cases": {}, "failed": []}
    with tempfile.TemporaryDirectory(dir="/var/tmp") as folder:
        museum = Museum(options.build, pathlib.Path(folder))
        for name, case in cases(museum).items():
            check(name, case, pathlib.Path(folder) / name.replace(" ", "-"), options.points, figures)
            shutil.rmtree(pathlib.Path(folder) / name.replace(" ", "-"))
    line = json.dumps({"benchmark": "image-powerloss", **figures})
    if options.json:
        options.json.write_text(line + "\n")
    print(line)
    return 1 if figures["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
