#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests a farm with museums that request more than it can render: each gets its share by its weight in museums.toml,
and a slow one takes nothing from the others.

Run: fairness_test.py SOURCE_ROOT BUILD_FOLDER
"""
import json
import pathlib
import sys
import tempfile

from farm.authority import TLS, Authority
from farm.farm import Farm, make_scene
from farm.museum import now
from farm.processes import wait_until

GREEDY_HZ = 200  # A frame rate that no machine reaches.
SLOW = ("--tile-delay-ms", 300)
CREDIT = 150  # Frames after which a museum that just came has caught up with the second of its share that it may.
ENOUGH = 15   # Frames of each museum, so many that other work on the machine matters little.
UNFAIR = 1.8  # Maximum ratio of frames at equal weights; 1 is fair.
WEIGHTS = {"hall-2": 2.0, "hall-1": 1.0}
WEIGHED = (1.5, 2.7)  # Bounds of the ratio of frames at weights 2 and 1.
SLOWED = 0.4  # Minimum share of the frame rate that is left beside a slow museum.


def start(farm, name, *options):
    museum = farm.add_museum(name, *options, rate_hz=GREEDY_HZ)
    wait_until(museum.whole_frames, 60, f"{name} sees something")
    return museum


def rates(counted, others=()):
    """Returns each museum's frames per second in the time that the first ones took for enough frames."""
    began = now()
    wait_until(lambda: all(len(m.whole_frames(began)) >= ENOUGH for m in counted), 90, "frames enough for all", period=0.2)
    until = now()
    return [len(museum.whole_frames(began, until)) / (until - began) for museum in [*counted, *others]]


def check_weights(farm):
    farm.ready()
    museums = [start(farm, name, "--bundle", farm.folder / name) for name in WEIGHTS]
    rate, other = rates(museums)
    least, most = WEIGHED
    assert least <= rate / other <= most, f"{rate} frames/s with weight 2, {other} with weight 1"
    return {"weight_2_per_s": rate, "weight_1_per_s": other}


def trusting_farm(build, folder):
    """Makes certificates for all museums and a file of weights."""
    folder, scene = pathlib.Path(folder), make_scene(build, folder)
    authority = Authority(build, folder)
    authority.bundle("coordinator", "farm", "--address", "::1")
    authority.bundle("node", "nodes")
    for name in WEIGHTS:
        authority.bundle("museum", name)
    (folder / "museums.toml").write_text("".join(
        f'[[museum]]\nname = "{name}"\nscenes = ["*"]\nweight = {weight}\nfree_eye = true\n' for name, weight in WEIGHTS.items()))
    # The command line overrides ports and scenes.
    (folder / "farm.toml").write_text(f'museums = "[::1]:1"\nnodes = "[::1]:2"\nmuseums_file = "museums.toml"\n[[scene]]\n'
                                      f'name = "visit"\npath = "{scene}"\n[tls]\n' + TLS.format("farm"))
    (folder / "node.toml").write_text("[tls]\n" + TLS.format("nodes"))
    return Farm(build, folder, nodes=2, scene=scene, coordinator_options=("--config", folder / "farm.toml"),
                node_options=("--config", folder / "node.toml"))


def check_equals(farm):
    farm.ready()
    fast = start(farm, "fast")
    slow = start(farm, "slow", *SLOW)
    beside_slow, slow_rate = rates([fast], [slow])
    farm.forget_museum("slow")
    [alone] = rates([fast])
    assert slow.whole_frames(), "a slow museum gets nothing at all"
    assert slow_rate < beside_slow, "the slow museum is not slow, so this proves nothing"
    assert beside_slow >= SLOWED * alone, f"{alone} frames/s alone, {beside_slow} beside a slow museum"
    others = [start(farm, f"other-{i}") for i in (1, 2)]
    wait_until(lambda: all(len(m.whole_frames()) >= CREDIT for m in others), 180, "they have caught up", period=0.2)
    equal = rates([fast, *others])
    assert max(equal) <= UNFAIR * min(equal), f"frames/s of three museums of the same weight: {equal}"
    return {"alone_per_s": alone, "beside_a_slow_one_per_s": beside_slow, "slow_per_s": slow_rate, "three_equal_per_s": equal}


def is_fair(make, build, check):
    with tempfile.TemporaryDirectory() as folder:
        with make(build, folder) as farm:
            try:
                print(json.dumps(check(farm)))
            except AssertionError as error:
                print(farm.coordinators[0].process.output()[-1500:])
                print(error)
                return False
        holes, breaches = farm.wrong()
        if holes or breaches or farm.stuck:
            print(f"{holes} frames with holes, {breaches}, {farm.stuck} processes did not stop")
            return False
    return True


def main(_, build):
    if not is_fair(lambda *where: Farm(*where, nodes=2), build, check_equals) or not is_fair(trusting_farm, build, check_weights):
        return 1
    print("fairness: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
