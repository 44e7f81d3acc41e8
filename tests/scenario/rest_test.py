#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests a governed visit with real processes: a visitor who stands still gets the reference picture, then nothing is
sent until the visitor turns.

Run: rest_test.py SOURCE_ROOT BUILD_FOLDER
"""
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import time
import urllib.request

REFERENCE = 32
SITE = f"""
[picture]
frame_budget_ms = 50
reference_samples = {REFERENCE}
[walk]
guide_after_s = 0
"""


class Visit:
    def __init__(self, root, build, folder):
        self.bin, self.folder, self.running = pathlib.Path(build) / "bin", pathlib.Path(folder), {}
        port = random.randrange(20000, 31000)
        at = [f"[::1]:{port + i}" for i in range(6)]
        self.page = f"http://{at[5]}"
        (self.folder / "site.toml").write_text(SITE)
        scene = self.folder / "grotto"
        subprocess.run([self.bin / "cyclorama-grotto", "--triangles", "10000", "--out", scene], check=True, capture_output=True)
        self.start("farm", "--scene", f"visit={scene}", "--museums", at[0], "--nodes", at[1], "--inspect", at[4])
        for _ in range(2):
            self.start("node", "--coordinator", at[1], "--threads", "1")
        self.start("tour", "--config", self.folder / "site.toml", "--listen", at[2], "--farm", at[0])
        self.start("display", "--installation", f"{root}/demo/installation.toml", "--tour", at[2], "--listen", at[3],
                   "--run-dir", folder, "--width", "256", "--height", "96", "--refresh-hz", "20")
        self.start("operator", "--no-pin", "--listen", at[5], "--watch", f"tour={at[2]}", "--watch", f"display={at[3]}", "--watch",
                   f"coordinator={at[4]}")

    def start(self, name, *arguments):
        log = open(self.folder / f"{name}-{len(self.running)}.log", "w")
        self.running[log.name] = subprocess.Popen([self.bin / f"cyclorama-{name}", *arguments], stdout=log, stderr=log)

    def stop(self):
        for process in self.running.values():
            process.terminate()
        for process in self.running.values():
            process.wait(20)

    def status(self):
        """Returns the state and the gauges of each process."""
        try:
            with urllib.request.urlopen(self.page + "/status", timeout=5) as answer:
                return {p["name"]: p for p in json.load(answer)["processes"]}
        except OSError:
            return {}

    def wait(self, what, is_so, seconds=60):
        until = time.monotonic() + seconds
        status = {}
        while time.monotonic() < until:
            status = self.status()
            try:
                if is_so(status):
                    return status
            except KeyError:  # Not known yet.
                pass
            time.sleep(0.1)
        raise AssertionError(f"{what}: not within {seconds} s; " + "; ".join(p["state"] for p in status.values()))

    def turn(self):
        request = urllib.request.Request(self.page + "/steer", b'{"turn": 0.5}', {"Content-Type": "application/json"})
        urllib.request.urlopen(request, timeout=5).close()


def rests(status):
    return f"at rest with {REFERENCE} samples" in status["coordinator"]["state"] and \
        status["tour"]["gauges"]["samples_per_pixel"] == REFERENCE


def counted(status):
    """Returns the counters that grow when anything is sent."""
    return [status["tour"]["gauges"]["frames"], status["tour"]["gauges"]["refined_frames"],
            status["coordinator"]["gauges"]["frames"], status["coordinator"]["gauges"]["refined_frames"],
            status["display"]["gauges"]["frames_presented"]]


def check(visit):
    visit.wait("the first reference", rests)
    time.sleep(0.5)  # Waits until the display shows the last picture.
    before = counted(visit.status())
    time.sleep(2.5)
    after = counted(visit.status())
    assert before == after, f"something is sent at rest: {before} became {after}"
    visit.turn()
    visit.wait("frames of the turn", lambda s: s["tour"]["gauges"]["frames"] > before[0] + 1)
    again = visit.wait("the second reference", lambda s: rests(s) and counted(s)[1] > before[1])
    print(f"{before} at the first rest, {counted(again)} at the second")


def main(root, build):
    with tempfile.TemporaryDirectory() as folder:
        visit = Visit(root, build, folder)
        try:
            check(visit)
        except AssertionError as error:
            for name in visit.running:
                print(f"{name}:\n{pathlib.Path(name).read_text()[-1000:]}")
            print(error)
            return 1
        finally:
            visit.stop()
    print("rest: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
