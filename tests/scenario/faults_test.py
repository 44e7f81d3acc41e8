#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Injects faults, drawn from a seed, into a working farm: no picture is wrong, no session is lost, nothing leaks.

Run: faults_test.py SOURCE_ROOT BUILD_FOLDER [--faults N] [--seed S] [--coordinators 1|2] [--only KIND] [--keep FOLDER]
It prints a table by kind, then one line that is a JSON object.
"""
import argparse
import json
import pathlib
import random
import sys
import tempfile
import time

from farm import faults
from farm.farm import Farm, render
from farm.processes import wait_until

LATE_AFTER_S = 1.0  # A whole frame that took longer is late too, whatever the coordinator reports.
NEAR_S, FAR = 0.7, 60  # All pictures in this time after a fault are compared, and so many others.
# The governed museum's options: a small budget, which leaves the others enough of two processors.
GOVERNED = ("--budget-ms", 10, "--reference-samples", 2, "--walk-s", 4, "--rest-s", 3)
GOVERNED_RATE_HZ, GOVERNED_SIZE = 4, ("--width", 256, "--height", 128)
# Growth of a coordinator from the first fault to the last; a leak is larger.
GROWN = {"rss_kib": 64 * 1024, "threads": 8, "fds": 16}


def picked(kinds, count, seed):
    """Returns every kind equally often, in an order drawn from the seed."""
    rng = random.Random(seed)
    chosen = []
    while len(chosen) < count:
        chosen += rng.sample(kinds, len(kinds))
    return chosen[:count], rng


def usage(farm):
    return {part.process.name: part.process.usage() for part in farm.coordinators}


def run(farm, kinds, count, seed):
    farm.ready()
    farm.add_museum("museum-1")
    farm.add_museum("museum-2")
    farm.add_museum("governed", *GOVERNED, rate_hz=GOVERNED_RATE_HZ, size=GOVERNED_SIZE)
    for museum in farm.museums.values():
        wait_until(museum.whole_frames, 60, f"{museum.name} sees something")
    chosen, rng = picked(kinds, count, seed)
    before, records = usage(farm), []
    for number, fault in enumerate(chosen, 1):
        record = faults.see_through(fault, farm, rng, LATE_AFTER_S)
        records.append(record)
        print(f"{number}/{count} {record['kind']}: full rate after {record['full_rate_s']:.2f} s, {record['late']} late, "
              f"{record['lost_sessions']} lost, {record['hangs']} hangs{''.join('; ' + r for r in record['reasons'])}", file=sys.stderr, flush=True)
    time.sleep(1.0)
    after = usage(farm)
    grown = {f"{name} {what}": after[name][what] - before[name][what] for name in after for what in GROWN}
    return records, grown


def mixed_frames(farm, records, folder, rng):
    """Returns the number of views whose pixels differ from those of one undisturbed node, and the number of compared
    views. Those next to a fault are compared first, pictures at rest with each other."""
    museums = [*farm.past, *farm.museums.values()]
    frames = {frame["view_hex"]: frame for museum in museums for frame in museum.whole_frames()}
    near = {frame["view_hex"] for museum in museums for record in records
            for frame in museum.whole_frames(record["began_s"], record["began_s"] + NEAR_S)}
    far = sorted(frames.keys() - near)
    chosen = near | set(rng.sample(far, min(len(far), FAR)))
    alone = render(farm.build, folder, farm.scene, [frames[view] for view in chosen])
    assert alone.keys() == chosen
    requested, at_rest = farm.pictures()
    return sum(len(digests) > 1 or alone.get(view, min(digests)) not in digests
               for view, digests in (requested | at_rest).items()), len(chosen)


def table(records):
    print(f"{'fault':<32}{'times':>6}{'late, max':>12}{'s to full rate, mean':>22}{'max':>7}{'joined s, max':>16}")
    for kind in sorted({r["kind"] for r in records}):
        of_kind = [r for r in records if r["kind"] == kind]
        seconds = [r["full_rate_s"] for r in of_kind]
        joined = [r["joined_s"] for r in of_kind if r["joined_s"] is not None]
        print(f"{kind:<32}{len(of_kind):>6}{max(r['late'] for r in of_kind):>12}{sum(seconds) / len(seconds):>22.2f}"
              f"{max(seconds):>7.2f}{max(joined) if joined else float('nan'):>16.2f}")


def summary_of(farm, records, grown):
    holes, breaches = farm.wrong()
    museums = [*farm.past, *farm.museums.values()]
    governed = [museum for museum in museums if museum.rests]
    return {
        "benchmark": "farm-faults", "faults": len(records), "holes": holes, "breaches": breaches,
        "hangs": sum(r["hangs"] for r in records), "lost_sessions": sum(r["lost_sessions"] for r in records),
        "late_frames_max": max((r["late"] for r in records if r["to_node"]), default=0),
        "seconds_to_full_rate_max": round(max(r["full_rate_s"] for r in records), 2),
        "joined_s_max": round(max([r["joined_s"] for r in records if r["joined_s"] is not None], default=0.0), 2),
        "stuck_processes": farm.stuck, "grown": grown,
        "frames": sum(len(m.whole_frames()) for m in museums),
        "governed_frames": sum(len(m.whole_frames()) for m in governed), "frames_at_rest": len(farm.pictures()[1]),
        "qualities": len({(f["samples"], f["width_px"]) for m in governed for f in m.whole_frames()}),
    }


def problems_of(summary):
    for what in ("holes", "mixed_frames", "breaches", "hangs", "lost_sessions", "stuck_processes"):
        if summary[what]:
            yield f"{what}: {summary[what]}"
    for what, more in summary["grown"].items():
        if more > GROWN[what.split()[-1]]:
            yield f"{what} has grown by {more}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root")
    parser.add_argument("build")
    parser.add_argument("--faults", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--coordinators", type=int, default=1)
    parser.add_argument("--only", help="faults whose name contains this")
    parser.add_argument("--keep", help="leaves the logs in this folder")
    arguments = parser.parse_args()
    kinds = [f for f in faults.ALL if f.coordinators <= arguments.coordinators and (arguments.only or "") in f.kind]
    with tempfile.TemporaryDirectory() as folder:
        if arguments.keep:
            folder = arguments.keep
            pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        with Farm(arguments.build, folder, coordinators=arguments.coordinators) as farm:
            try:
                records, grown = run(farm, kinds, arguments.faults, arguments.seed)
            except AssertionError as error:
                for log in sorted(pathlib.Path(folder).glob("*.log")):
                    print(f"{log.name}:\n{log.read_text(errors='replace')[-600:]}")
                print(error)
                return 1
        mixed, compared = mixed_frames(farm, records, folder, random.Random(arguments.seed))
        summary = summary_of(farm, records, grown) | {"mixed_frames": mixed, "pictures_compared": compared}
    table(records)
    problems = list(problems_of(summary))
    print("\n".join(problems) or "faults: ok")
    print(json.dumps(summary))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
