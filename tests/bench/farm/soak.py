#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures memory, files and threads of a coordinator and its nodes during minutes of walks, rests, joins and leaves.

Run: soak.py BUILD_FOLDER MINUTES
"""
import json
import pathlib
import random
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scenario"))
from farm.farm import Farm  # noqa: E402
from farm.museum import now  # noqa: E402
from farm.processes import wait_until  # noqa: E402

PERIOD_S = 2.0   # Between two measurements.
CHANGE_S = 10.0  # Between two joins or leaves.
WARM = 0.33      # The first part of the time, in which caches fill.
GOVERNED = ("--budget-ms", 100, "--reference-samples", 32)


def slope(points):
    """Returns the slope of the least-squares line through the points."""
    n = len(points)
    mean_x, mean_y = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


class Guests:
    """A node and two museums that join and leave, one change at a time."""

    def __init__(self, farm, random_numbers):
        self.farm, self.random, self.node, self.changes = farm, random_numbers, None, 0

    def change(self):
        self.changes += 1
        what = self.random.choice(["node", "guest-1", "guest-2"])
        if what == "node":
            if self.node is None:
                self.node = self.farm.add_node()
            else:
                self.farm.drop_node(self.node)
                self.node = None
        elif what in self.farm.museums:
            self.farm.forget_museum(what)
        else:
            self.farm.add_museum(what, *(GOVERNED if what == "guest-1" else ()))


def run(farm, minutes):
    farm.ready()
    stays = {"coordinator": farm.coordinators[0].process} | {node.name: node.process for node in farm.nodes}
    museum = farm.add_museum("museum", *GOVERNED, "--walk-s", 6, "--rest-s", 4)
    wait_until(museum.whole_frames, 60, "the first picture")
    guests, began, looks = Guests(farm, random.Random(1)), now(), {name: [] for name in stays}
    next_change = began + CHANGE_S
    while now() < began + 60.0 * minutes:
        time.sleep(PERIOD_S)
        for name, process in stays.items():
            looks[name].append(((now() - began) / 60.0, process.usage()))
        if now() >= next_change:
            guests.change()
            next_change += CHANGE_S
    return looks, guests.changes


def summary_of(looks, minutes):
    out = {}
    for name, of_process in looks.items():
        warm = [look for look in of_process if look[0] >= WARM * minutes]
        out[name] = {"rss_slope_kib_per_min": round(slope([(t, use["rss_kib"]) for t, use in warm]), 1),
                     "rss_kib": warm[-1][1]["rss_kib"],
                     **{f"{what}_{word}": of(use[what] for _, use in warm) for what in ("fds", "threads")
                        for word, of in (("min", min), ("max", max))}}
    return out


def main(build, minutes):
    minutes = float(minutes)
    with tempfile.TemporaryDirectory() as folder, Farm(build, folder, nodes=2) as farm:
        looks, changes = run(farm, minutes)
    holes, breaches = farm.wrong()
    each = summary_of(looks, minutes)
    print(f"{'process':<12}{'KiB/min':>10}{'KiB':>10}{'fds':>10}{'threads':>10}")
    for name, found in each.items():
        print(f"{name:<12}{found['rss_slope_kib_per_min']:>10.1f}{found['rss_kib']:>10}"
              f"{found['fds_min']:>5}-{found['fds_max']:<4}{found['threads_min']:>5}-{found['threads_max']:<4}")
    frames = sum(len(m.events("frame")) for m in [*farm.past, *farm.museums.values()])
    print(json.dumps({"benchmark": "farm-soak", "minutes": minutes, "changes": changes, "frames": frames, "holes": holes,
                      "breaches": breaches, "stuck_processes": farm.stuck,
                      "rss_slope_kib_per_min": {name: found["rss_slope_kib_per_min"] for name, found in each.items()},
                      "processes": each}))
    return 1 if holes or breaches or farm.stuck else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
