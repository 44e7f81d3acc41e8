#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the whole visit with real processes: ./demo.sh at a small size must show moving pictures and end cleanly.

Run: visit_test.py SOURCE_ROOT BUILD_FOLDER
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

STAGES = ["capture", "detect", "pose", "steer", "farm_round_trip", "farm", "plan", "render", "encode", "decode", "wait",
          "draw", "heading_to_photon", "shutter_to_photon"]  # All stages of docs/reference/frame-timing.md.


def main(root, build):
    problems = []
    with tempfile.TemporaryDirectory() as out:
        run = subprocess.run(
            [f"{root}/demo.sh", "--headless", "--seconds", "8", "--triangles", "60000", "--size", "480x240",
             "--out", out],
            env={**os.environ, "CYCLORAMA_BUILD": build}, timeout=150, capture_output=True, text=True)
        if run.returncode != 0:
            problems.append(f"demo.sh ended with {run.returncode}:\n{run.stdout}\n{run.stderr}")
        summary_file = pathlib.Path(out) / "summary.json"
        summary = json.loads(summary_file.read_text()) if summary_file.exists() else {}
        for key in ("fps", "frames", "bytes_per_frame", "triangles", "nodes"):
            if not summary.get(key, 0) > 0:
                problems.append(f"summary.json: {key} is {summary.get(key)}")
        for stage in STAGES:
            if not summary.get("stages", {}).get(stage, {}).get("count", 0) > 0:
                problems.append(f"summary.json: no measurement of the stage '{stage}'")
        for name in ("panorama", "wall", "wall-over-time", "projector-left", "projector-middle", "projector-right"):
            if not (pathlib.Path(out) / f"{name}.png").exists():
                problems.append(f"no picture {name}.png")
        print(json.dumps({k: summary.get(k) for k in ("fps", "frames", "drops", "problems")}))
    print("\n".join(problems) or "visit: ok")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
