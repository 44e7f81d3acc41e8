#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Light that two nodes compute together, because the scene's own file is damaged, while a node is killed and the
coordinator restarts: what was finished is not computed again, both nodes get the same light, and nothing is left over.

Run: light_test.py BUILD_FOLDER
"""
import pathlib
import re
import sys
import tempfile

from farm.farm import Farm, make_scene
from farm.processes import wait_until

TRIANGLES = 10000
NODES = 2
TIMEOUT_S = 200
USED = re.compile(r"has its light computed: .* \(version [0-9a-f]+\)")


def pieces(folder):
    """Returns the finished pieces in the caches of all nodes, and when each was written."""
    found = {}
    for path in folder.glob("cache-*/light/.*.unfinished/*/*"):
        try:
            if re.fullmatch(r"\d+-\d+", path.name):
                found[path] = path.stat().st_mtime_ns
        except FileNotFoundError:  # The light was finished meanwhile.
            pass
    return found


def files(folder):
    return [path.read_bytes() for path in folder.glob("cache-*/light/*.store")]


def run(farm, folder):
    coordinator = farm.coordinators[0]
    for i in range(NODES):
        farm.node_options = ("--cache", folder / f"cache-{i}")
        farm.add_node()
    farm.ready()
    assert f"{farm.scene}/light.store: " in coordinator.process.output(), "the damaged file is not named"
    wait_until(lambda: len(pieces(folder)) >= 6, TIMEOUT_S, "pieces of light")
    before = pieces(folder)
    node = farm.nodes[-1]  # The farm starts it with the cache that it had.
    node.process.kill()
    node.start()
    wait_until(lambda: len(pieces(folder)) >= len(before) + 6, TIMEOUT_S, "more pieces after a node was killed")
    coordinator.process.kill()
    kept = pieces(folder)
    assert before.items() <= kept.items(), "pieces were computed again"
    coordinator.start()
    wait_until(lambda: USED.search(coordinator.process.output()), TIMEOUT_S, "light after the coordinator restarted")
    wait_until(lambda: len(files(folder)) == NODES, TIMEOUT_S, "light in all caches")
    assert len(set(files(folder))) == 1, "the nodes have different light"
    wait_until(lambda: not pieces(folder), TIMEOUT_S, "unfinished light is removed")
    print(f"{len(before)} pieces before a node was killed, {len(kept)} before the coordinator was")


def main(build):
    with tempfile.TemporaryDirectory() as name:
        scene = make_scene(build, name, TRIANGLES)
        (scene / "light.store").write_bytes(b"CYCLIGHT of an earlier program")
        with Farm(build, name, nodes=0, scene=scene) as farm:
            run(farm, pathlib.Path(name))


if __name__ == "__main__":
    main(*sys.argv[1:])
