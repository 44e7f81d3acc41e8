#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures what the farm adds to the rays, with real processes on loopback and a scene whose rays are nearly free.

The coordinator has the first core to itself; the two nodes and the museum share the second one, if there is one.

Run: overhead.py BUILD_FOLDER FRAMES
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "scenario"))
from farm.farm import Farm  # noqa: E402

SIZE = ("--width", 1920, "--height", 1080)
TRIANGLE = "v -1 0 -5\nv 1 0 -5\nv 0 2 -5\nf 1 2 3\n"
STAGES = ("queue", "plan", "fan_out", "render", "encode", "relay", "overhead", "farm")
# Niceness of the nodes: encoder and museum, which share the core here, shall not wait for rays.
RAYS_GIVE_WAY = 10


def settle(process, core, nice=0):
    """Binds all threads of a process, and those that they start later, to a core."""
    for task in os.listdir(f"/proc/{process.pid}/task"):
        os.sched_setaffinity(int(task), {core})
        os.setpriority(os.PRIO_PROCESS, int(task), os.getpriority(os.PRIO_PROCESS, int(task)) + nice)


def main(build, frames):
    cores = sorted(os.sched_getaffinity(0))
    coordinator_core, others_core = cores[0], cores[-1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "triangle.obj").write_text(TRIANGLE)
        (folder / "views").write_text("".join(f"{n}\n" for n in range(1, int(frames) + 1)))
        inspect = f"unix:{folder}/inspect.sock"
        with Farm(build, folder, nodes=2, scene=folder / "triangle.obj", coordinator_options=("--inspect", inspect)) as farm:
            farm.ready()
            settle(farm.coordinators[0].process, coordinator_core)
            for node in farm.nodes:
                settle(node.process, others_core, RAYS_GIVE_WAY)
            used_before = farm.coordinators[0].process.cpu_seconds()
            museum = farm.add_museum("bench", "--views", folder / "views", "--blind", size=SIZE)
            settle(museum.process, others_core)
            assert museum.process.popen.wait(600) == 0, "the museum did not get its frames"
            coordinator_ms = 1e3 * (farm.coordinators[0].process.cpu_seconds() - used_before)
            museum.reader.join()
            tiles = sum(frame["tiles"] for frame in museum.whole_frames())
            command = [f"{build}/bin/cyclorama-farm", "top", "--inspect", inspect, "--json"]
            stages = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["stages"]
    print(f"1920x1080, one triangle, 1 sample per pixel, {frames} frames one after the other, 2 nodes of 1 thread each")
    print(f"the coordinator on core {coordinator_core}; nodes and museum on core {others_core}")
    print(f"  {'step of a frame':<18}{'p50 ms':>9}{'p95 ms':>9}{'p99 ms':>9}{'count':>9}")
    for stage in STAGES:
        row = stages[stage]
        print(f"  {stage:<18}{row['p50_ms']:>9.2f}{row['p95_ms']:>9.2f}{row['p99_ms']:>9.2f}{row['count']:>9}")
    print(f"the coordinator's cpu time: {coordinator_ms / int(frames):.2f} ms per frame, {coordinator_ms / tiles:.3f} ms per tile")
    print(json.dumps({"benchmark": "farm-overhead", "frames": int(frames), "plan_ms_p99": stages["plan"]["p99_ms"],
                      "fan_out_ms_p99": stages["fan_out"]["p99_ms"], "relay_ms_p99": stages["relay"]["p99_ms"],
                      "total_ms_p99": stages["overhead"]["p99_ms"], "coordinator_cpu_ms_per_tile": round(coordinator_ms / tiles, 4)}))


if __name__ == "__main__":
    main(*sys.argv[1:])
