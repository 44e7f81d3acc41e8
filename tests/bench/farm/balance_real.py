#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how evenly real nodes share a picture, next to a simulation of the same frames, and compares the pictures.

Run: balance_real.py BUILD_FOLDER FRAMES NODES...

The measure is each node's cpu time per frame: more nodes than processors lengthen wall time but not cpu time. Stealing
depends on wall time, though: a node that the system keeps waiting loses work to others. As root, each node therefore
gets the same fixed share of a processor, so that all are equally slow at any time; otherwise only strategies without
stealing give meaningful results.
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scenario"))
from farm.farm import Farm, make_scene, render  # noqa: E402
from farm.processor_share import ProcessorShare  # noqa: E402

LEARNT = 5  # Frames before the measurement, in which the balancer learns the costs.
SIZE = ("--width", 1920, "--height", 1080)
POSES = 720  # Half a degree per frame, the speed of a visitor who turns.
TRIANGLES = 200000
USED = 0.8  # Share of this machine's processors that all nodes use together.
ALIKE = 40  # Number of pictures that are compared, over the whole walk.


def walk(build, folder, scene, nodes, frames, options=()):
    """Returns the frames of so many nodes; each frame is requested when the previous one has arrived."""
    views = pathlib.Path(folder) / "walk"
    views.write_text("\n".join(str(number) for number in range(1, frames + 1)) + "\n")
    shares = []
    with Farm(build, folder, nodes=nodes, scene=scene, coordinator_options=options) as farm:
        farm.ready()
        if ProcessorShare.is_possible():
            for node in farm.nodes:
                shares.append(ProcessorShare(node.name, min(1.0, USED * os.cpu_count() / nodes)))
                shares[-1].add(node.process)
        museum = farm.add_museum("walker", "--views", views, size=SIZE, poses=POSES)
        if museum.process.popen.wait(1800) != 0:
            raise SystemExit(f"the walk with {nodes} nodes failed")
        museum.reader.join()
    for share in shares:
        share.remove()
    return museum.whole_frames(), museum.wrong()


def simulated(build, record, nodes, strategy):
    """Returns cyclorama-bench-balance's mean efficiency for the recorded frames."""
    out = record.parent / "replay.json"
    subprocess.run([f"{build}/tests/cyclorama-bench-balance", "replay", *sorted(record.iterdir()), "--nodes", str(nodes), "--strategy",
                    strategy, "--json", out], check=True, capture_output=True)
    return json.loads(out.read_text())[0]["mean"]


def measure(build, folder, scene, nodes, frames, strategy):
    record = pathlib.Path(folder) / f"record-{nodes}"
    record.mkdir()
    seen, (holes, breaches) = walk(build, folder, scene, nodes, frames, ["--balance", strategy, "--record", record])
    efficiencies = [frame["efficiency"] for frame in seen[LEARNT:]]
    return seen, {"nodes": nodes, "strategy": strategy, "frames": len(efficiencies), "holes": holes, "breaches": breaches,
                  "efficiency": round(statistics.mean(efficiencies), 4),
                  "efficiency_p5": round(sorted(efficiencies)[len(efficiencies) // 20], 4),
                  "nodes_used": round(statistics.mean(frame["nodes"] for frame in seen[LEARNT:]), 2),
                  "simulated": round(simulated(build, record, nodes, strategy), 4)}


def differing(build, folder, scene, seen):
    alone = render(build, folder, scene, seen[::max(1, len(seen) // ALIKE)])
    return sum(alone[frame["view_hex"]] != frame["digest"] for frame in seen if frame["view_hex"] in alone), len(alone)


def main(build, frames, *counts):
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        scene = make_scene(build, folder, TRIANGLES)
        for nodes in map(int, counts):
            for strategy in ("cost-map", "cost-map-stealing"):
                inside = pathlib.Path(folder) / f"{nodes}-{strategy}"
                inside.mkdir()
                seen, row = measure(build, inside, scene, nodes, int(frames), strategy)
                row["pictures_that_differ"], row["pictures_compared"] = differing(build, inside, scene, seen)
                rows.append(row)
    print(f"{'nodes':>6} {'strategy':<20}{'used':>6}{'efficiency':>12}{'p5':>8}{'simulated':>11}{'pictures that differ':>22}")
    for row in rows:
        print(f"{row['nodes']:>6} {row['strategy']:<20}{row['nodes_used']:>6.1f}{row['efficiency']:>12.3f}{row['efficiency_p5']:>8.3f}"
              f"{row['simulated']:>11.3f}{row['pictures_that_differ']:>15} of {row['pictures_compared']}")
    print(json.dumps({"benchmark": "balance-real", "fixed_shares": ProcessorShare.is_possible(), "rows": rows}))
    return 1 if any(row["holes"] or row["breaches"] or row["pictures_that_differ"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
