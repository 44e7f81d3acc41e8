# SPDX-License-Identifier: Apache-2.0
"""Runs the whole visit with ./demo.sh on scenes of several sizes and prints the stages of a frame: visit.py [--quick]."""
import json
import pathlib
import subprocess
import sys
import tempfile


def main(*options):
    seconds, sizes = (10, [200000]) if "--quick" in options else (30, [1000000, 6000000])
    runs = {}
    with tempfile.TemporaryDirectory() as folder:
        for triangles in sizes:
            out = pathlib.Path(folder) / str(triangles)
            subprocess.run(["./demo.sh", "--headless", "--seconds", str(seconds), "--triangles", str(triangles),
                            "--out", out], check=True, stdout=sys.stderr)
            runs[str(triangles)] = json.loads((out / "summary.json").read_text())
    for run in runs.values():
        print(f"{run['triangles']} triangles, {run['nodes']} nodes: {run['fps']:.1f} frames/s, "
              f"{run['bytes_per_frame'] / 1000:.0f} kB/frame, balance {run['balance_efficiency']:.3f}")
        print(f"  {run['shown_hz']:.0f} new poses/s, {100 * run['scale']:.0f} % of the size, {run['samples']:.0f} samples, "
              f"{100 * run['wasted']:.1f} % of the frames for nothing")
        print(f"  {'stage':<20}{'p50 ms':>9}{'p95 ms':>9}{'p99 ms':>9}")
        for name, stage in run["stages"].items():
            print(f"  {name:<20}{stage['p50_ms']:>9.1f}{stage['p95_ms']:>9.1f}{stage['p99_ms']:>9.1f}")
    print(json.dumps({"benchmark": "visit", **runs}))


if __name__ == "__main__":
    main(*sys.argv[1:])
