#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Several museums at one farm that want more than it can make: each gets its share, and a slow one takes nothing from the others.

Run: fairness_test.py SOURCE_ROOT BUILD_FOLDER
"""
import json
import sys
import tempfile
import time

from farm.farm import Farm
from farm.museum import now
from farm.processes import wait_until

GREEDY_HZ = 100  # More than any machine makes of these pictures.
GREEDY = ("--samples", 4)
SECONDS = 4.0
SLOW = ("--tile-delay-ms", 300)
UNFAIR = 1.6  # Frames of one over those of another of the same weight; 1 is fair.
SLOWED = 0.5  # Of the frames without the slow museum, so many are left at least.


def start(farm, name, *options):
    museum = farm.add_museum(name, *GREEDY, *options, rate_hz=GREEDY_HZ)
    wait_until(museum.whole_frames, 60, f"{name} sees something")
    return museum


def frames_in(museums, seconds=SECONDS):
    """How many each gets at the same time."""
    time.sleep(1.0)
    began = now()
    time.sleep(seconds)
    until = now()
    return [len(museum.whole_frames(began, until)) for museum in museums]


def check(farm):
    farm.ready()
    fast = start(farm, "fast")
    slow = start(farm, "slow", *SLOW)
    with_slow, slow_frames = frames_in([fast, slow])
    farm.forget_museum("slow")
    [alone] = frames_in([fast])
    assert slow_frames > 0, "a slow museum gets nothing at all"
    assert slow_frames < with_slow, "the slow museum is not slow: this proves nothing"
    assert with_slow >= SLOWED * alone, f"{alone} frames alone, {with_slow} beside a slow museum"
    others = [start(farm, f"other-{i}") for i in (1, 2)]
    shared = frames_in([fast, *others])
    assert max(shared) <= UNFAIR * min(shared), f"frames of three museums of the same weight: {shared}"
    return {"alone": alone, "beside_a_slow_one": with_slow, "slow": slow_frames, "three_equal": shared}


def main(_, build):
    with tempfile.TemporaryDirectory() as folder:
        with Farm(build, folder, nodes=2) as farm:
            try:
                print(json.dumps(check(farm)))
            except AssertionError as error:
                print(farm.heads[0].process.said()[-1500:])
                print(error)
                return 1
        holes, breaches = farm.wrong()
        if holes or breaches or farm.stuck:
            print(f"{holes} frames with holes, {breaches}, {farm.stuck} processes did not stop")
            return 1
    print("fairness: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
