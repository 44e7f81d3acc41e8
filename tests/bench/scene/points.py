#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Points of a scanner: seconds and memory to load a LAS file that this program writes.

The points lie on a rolling ground, as after a flight. Run: points.py BUILD [--points N] [--quick]
"""
import argparse
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile


def write_las(path, count):
    side = max(2, math.isqrt(count))
    header = bytearray(227)
    header[0:4] = b"LASF"
    header[24:26] = bytes((1, 2))
    struct.pack_into("<H", header, 94, 227)
    struct.pack_into("<I", header, 96, 227)
    struct.pack_into("<BHI", header, 104, 2, 26, side * side)
    struct.pack_into("<3d", header, 131, 0.001, 0.001, 0.001)
    with open(path, "wb") as out:
        out.write(header)
        for row in range(side):
            line = bytearray()
            for column in range(side):
                height = int(2000 * math.sin(0.01 * row) * math.cos(0.013 * column))
                line += struct.pack("<3iH6x3H2x", 50 * column, 50 * row, height, 100, 40000, 30000, column % 65536)[:26]
            out.write(line)
    return side * side


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("--points", type=int, default=2_000_000)
    options.add_argument("--quick", action="store_true", help="200,000 points")
    said = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        las = pathlib.Path(folder) / "ground.las"
        count = write_las(las, 200_000 if said.quick else said.points)
        figures = pathlib.Path(folder) / "figures.json"
        done = subprocess.run([said.build / "bin/cyclorama-render", "load", las, "--json", figures], check=False)
        if done.returncode != 0:
            return done.returncode
        loaded = json.loads(figures.read_text(encoding="utf-8"))
    gib = loaded["peak_rss_bytes"] / 2**30
    print(f"{count} points: loaded in {loaded['load_s']:.1f} s, BVH in {loaded['bvh_s']:.1f} s, {gib:.2f} GiB at most")
    print(json.dumps({"benchmark": "points", "points": count, "load_s": round(loaded["load_s"], 2),
                      "bvh_s": round(loaded["bvh_s"], 2), "gib": round(gib, 3),
                      "bytes_per_point": round(2 * loaded["bytes_per_triangle"], 1)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
