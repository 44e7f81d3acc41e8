# SPDX-License-Identifier: Apache-2.0
"""Runs the tracker and the walk at their limits and adds up the cases: extremes.py BUILD_FOLDER [--quick]."""
import json
import pathlib
import subprocess
import sys
import tempfile


def main(build, *options):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "tracker.json"
        subprocess.run([f"{build}/tests/tracker_bench", "extremes", "--json", file, *options], check=True)
        tracker = json.loads(file.read_text())
    walk_text = subprocess.run([f"{build}/bin/walk_extremes", *options], check=True, text=True,
                               stdout=subprocess.PIPE).stdout
    *table, last = walk_text.splitlines()
    print("\n".join(table))
    walk = json.loads(last)
    print(json.dumps({"benchmark": "visitor-extremes", "cases": tracker["cases"] + walk["cases"],
                      "failures": tracker["failures"] + walk["failures"], "tracker": tracker, "walk": walk}))


if __name__ == "__main__":
    main(*sys.argv[1:])
