# SPDX-License-Identifier: Apache-2.0
"""The scenes of benchmarks by name: two that are generated, and those of other people, where the data are there."""
import pathlib
import sys

OTHERS = {"cave": "cave_scan_draco.glb", "hotel": "hotel_room.glb", "buddhas": "grotto_thousand_buddhas.glb"}
NAMES = ("grotto", "hall", *OTHERS)


def paths(names, grotto, hall, shared):
    """Returns {name: path} of the scenes in `names` that are there, and names those that are not."""
    of_name = {"grotto": pathlib.Path(grotto), "hall": pathlib.Path(hall)}
    of_name |= {name: pathlib.Path(shared) / "data/scenes" / file for name, file in OTHERS.items()}
    found = {}
    for name in names:
        if name not in of_name:
            sys.exit(f"'{name}' is no scene; there are {', '.join(NAMES)}")
        if of_name[name].exists():
            found[name] = of_name[name]
        else:
            print(f"left out: {name}, for {of_name[name]} is not there", file=sys.stderr)
    return found
