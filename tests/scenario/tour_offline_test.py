#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests a visit whose farm is killed: the kept pictures of the stops take its place, and it comes back live.

Run: tour_offline_test.py SOURCE_ROOT BUILD_FOLDER [--losses N] [--triangles N] [--size WxH] [--samples N] [--pictures FOLDER]
It prints one line that is a JSON object; `cyclorama status` is asked in a loop, which limits the precision of times.
"""
import argparse
import json
import pathlib
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import time

from farm.processes import Process, free_port, wait_until

TOUR = """
version = 1
languages = ["en"]
[title]
en = "Cave 158"
[[stop]]
name = "nirvana"
position_m = [0.0, 2.9]
heading_deg = 0
[[stop]]
name = "face"
position_m = [-3.0, 0.9]
heading_deg = -18
[[stop]]
name = "niche"
position_m = [5.2, 1.2]
heading_deg = 90
[[stop]]
name = "store-room"
position_m = [-7.0, 2.0]
heading_deg = 180
keep = false
"""
SITE = """
[walk]
guide_after_s = 0
[tour]
folder = "tour"
fetch_after_min = 0
[picture]
frame_budget_ms = 100
reference_samples = {samples}
"""


class Visit:
    def __init__(self, root, build, folder, options):
        self.bin, self.folder = pathlib.Path(build) / "bin", pathlib.Path(folder)
        self.at = {name: f"[::1]:{free_port()}" for name in ("museums", "nodes", "tour", "display", "hand")}
        self.osc_port = free_port()
        self.scene, self.count = self.folder / "grotto", 0
        (self.folder / "tour").mkdir()
        (self.folder / "tour/tour.toml").write_text(TOUR)
        (self.folder / "site.toml").write_text(SITE.format(samples=options.samples))
        subprocess.run([self.bin / "cyclorama-grotto", "--triangles", str(options.triangles), "--out", self.scene],
                       check=True, capture_output=True)
        width, height = options.size.split("x")
        self.start_farm()
        self.node = self.start("node", "--coordinator", self.at["nodes"], "--threads", 2)
        self.tour = self.start_tour()
        self.display = self.start("display", "--config", self.folder / "site.toml", "--installation", f"{root}/demo/installation.toml",
                                  "--tour", self.at["tour"], "--listen", self.at["display"], "--run-dir", folder, "--width", width,
                                  "--height", height, "--refresh-hz", 20)
        self.hand = self.start("hand", "--tour", self.at["tour"], "--listen", self.at["hand"], "--devices", "", "--osc",
                               f"[::1]:{self.osc_port}")

    def start(self, name, *words):
        self.count += 1
        return Process(f"{name}-{self.count}", [self.bin / f"cyclorama-{name}", *words], self.folder)

    def start_farm(self):
        self.farm = self.start("farm", "--scene", f"visit={self.scene}", "--museums", self.at["museums"], "--nodes", self.at["nodes"])

    def start_tour(self):
        return self.start("tour", "--config", self.folder / "site.toml", "--listen", self.at["tour"], "--farm", self.at["museums"],
                          "--pictures", self.folder / "pictures")

    def stop(self):
        for process in (self.hand, self.display, self.tour, self.node, self.farm):
            process.end()

    def status(self):
        """Returns the gauges of tour and display, and the tour's state."""
        file = self.folder / "status.json"
        subprocess.run([self.bin / "cyclorama", "status", "--watch", f"tour={self.at['tour']}", "--watch", f"display={self.at['display']}",
                        "--json", file], capture_output=True)
        processes = {p["name"]: p for p in json.loads(file.read_text())["processes"]}
        return processes["tour"], processes["display"]

    def gauge(self, name, process=0):
        return self.status()[process].get("gauges", {}).get(name, 0)

    def shown(self):
        return self.gauge("frames_presented", 1)

    def command(self, *words):
        return subprocess.run([self.bin / "cyclorama", "tour", "--tour", self.at["tour"], *words], capture_output=True, text=True)

    def osc(self, address, types, *values):
        """Sends an OSC message, as another program in the hall does."""
        def padded(text):
            return text.encode() + bytes(4 - len(text) % 4)
        packet = padded(address) + padded("," + types) + struct.pack(">" + types, *values)
        with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as sender:
            sender.sendto(packet, ("::1", self.osc_port))

    def picture(self, path):
        subprocess.run([self.bin / "cyclorama", "picture", "display", "panorama", "--watch", f"display={self.at['display']}", "--out", path],
                       check=True, capture_output=True)


def seconds_until(is_so, limit, what):
    began = time.monotonic()
    wait_until(is_so, limit, what, period=0.01)
    return time.monotonic() - began


def look_around(visit):
    """Turns farther than any guard band reaches; the display has to show what is there."""
    before, past = visit.gauge("heading_deg"), visit.gauge("refreshes_past_guard_band", 1)
    until = time.monotonic() + 6
    while time.monotonic() < until:
        visit.osc("/cyclorama/steer", "fff", 0.0, 0.0, 1.0)
        time.sleep(0.05)
    turned = (visit.gauge("heading_deg") - before) % 360
    assert turned > 60, f"turned by {turned}"
    assert visit.gauge("refreshes_past_guard_band", 1) == past, "the picture ends before the visitor's turn"


def lose(visit):
    """Kills the farm and starts it again. Returns the seconds until the kept picture was shown, and until a live one was."""
    shown = visit.shown()
    visit.farm.kill()
    away_s = seconds_until(lambda: visit.shown() > shown, 60, "a kept picture")
    assert "The visit goes on" in visit.status()[0]["state"], visit.status()[0]["state"]
    look_around(visit)
    before = visit.gauge("eye_x_m")
    visit.osc("/cyclorama/stop", "i", 1)
    wait_until(lambda: visit.gauge("eye_x_m") != before, 20, "the next stop")
    refused = visit.command("go", "store-room")
    assert "no picture of the stop is kept" in refused.stderr, refused.stderr
    time.sleep(1.0)
    shown = visit.shown()
    visit.start_farm()
    back_s = seconds_until(lambda: visit.shown() > shown, 60, "a live picture")
    wait_until(lambda: "The visit goes on" not in visit.status()[0]["state"], 20, "a live visit")
    return away_s, back_s


def run(visit, options):
    wait_until(lambda: visit.shown() > 0, 120, "a first picture")
    stops_s = seconds_until(lambda: visit.gauge("kept_stops") == 3, 600, "the pictures of all stops but one")
    kept_mib = visit.gauge("kept_mib")
    listed = visit.command("show").stdout
    assert listed.count("[kept]") == 3 and "Cave 158" in listed, listed
    times = []
    for _ in range(options.losses):
        wait_until(lambda: "Visiting" in visit.status()[0]["state"], 60, "a visit")
        time.sleep(1.0)
        times.append(lose(visit))
    if options.pictures:
        pathlib.Path(options.pictures).mkdir(parents=True, exist_ok=True)
    # A museum whose farm is away when it opens.
    visit.farm.kill()
    visit.tour.end()
    shown = visit.shown()
    visit.tour = visit.start_tour()
    alone_s = seconds_until(lambda: visit.shown() > shown, 60, "a visit without a farm")
    for stop in ("nirvana", "face", "niche"):
        assert visit.command("go", stop).returncode == 0
        time.sleep(1.5)
        if options.pictures:
            visit.picture(pathlib.Path(options.pictures) / f"{stop}.png")
    return {"benchmark": "tour-offline", "stops": 3, "mb_per_stop": round(kept_mib * 1.048576 / 3, 3), "fetched_s": round(stops_s, 1),
            "away_s": round(statistics.median(t[0] for t in times), 2), "away_s_max": round(max(t[0] for t in times), 2),
            "back_s": round(statistics.median(t[1] for t in times), 2), "back_s_max": round(max(t[1] for t in times), 2),
            "alone_s": round(alone_s, 2), "losses": options.losses}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root")
    parser.add_argument("build")
    parser.add_argument("--losses", type=int, default=1)
    parser.add_argument("--triangles", type=int, default=10000)
    parser.add_argument("--size", default="256x96")
    parser.add_argument("--samples", type=int, default=8)
    parser.add_argument("--pictures", help="writes the display's picture at each stop to this folder")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        visit = Visit(options.root, options.build, folder, options)
        try:
            summary = run(visit, options)
        except AssertionError as error:
            print(visit.tour.output()[-2000:])
            print(error)
            return 1
        finally:
            visit.stop()
    print("tour offline: ok")
    print(json.dumps(summary))
    return 0


if __name__ == "__main__":
    sys.exit(main())
